// SPDX-License-Identifier: MIT
//
// lengths.cpp: edge lengths of intrinsic surfaces, three numbers a face.
#include <charconv>
#include <cmath>
#include <string>

#include "alcap/mesh_io.h"
#include "src/base/cancel.h"
#include "src/base/input_file.h"

namespace alcap {
namespace {

// How far apart, relative to the larger, the lengths may be that the two faces of an edge give.
constexpr double same_length = 1e-9;

/// The numbers of a text, one after the other.
class Numbers {
 public:
  Numbers(std::string name, std::string_view text)
      : name_(std::move(name)), at_(text.data()), end_(text.data() + text.size()) {}

  /// Whether another number follows.
  bool next(double& value) {
    skip();
    if (at_ == end_) return false;
    const auto [stop, error] = std::from_chars(at_ + (*at_ == '+' ? 1 : 0), end_, value);
    if (error != std::errc() || !(stop == end_ || separates(*stop) || *stop == '#')) fail("not a number");
    if (!(value > 0) || !std::isfinite(value)) fail("a length must be positive and finite");
    at_ = stop;
    return true;
  }
  [[noreturn]] void fail(const std::string& rule) const {
    throw FileError(name_ + ":" + std::to_string(line_) + ": " + rule, name_, line_);
  }

 private:
  static bool separates(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ',' || c == ';'; }
  void skip() {
    for (bool comment = false; at_ != end_; ++at_) {
      if (*at_ == '\n') {
        ++line_;
        comment = false;
      } else if (*at_ == '#') {
        comment = true;
      } else if (!comment && !separates(*at_)) {
        return;
      }
    }
  }

  std::string name_;
  const char* at_;
  const char* end_;
  std::int64_t line_ = 1;
};

VectorX<double> read(Numbers numbers, const Mesh& mesh) {
  VectorX<double> lengths = VectorX<double>::Zero(mesh.edges());
  double value = 0;
  for (Index h = 0; h < mesh.halfedges(); ++h) {
    detail::check_cancelled_at(h);
    if (!numbers.next(value))
      numbers.fail("ends after " + std::to_string(h) + " lengths; the mesh has " + std::to_string(mesh.faces()) +
                   " faces, with three each");
    double& length = lengths[mesh.edge(h)];
    if (length > 0 && std::abs(length - value) > same_length * std::max(length, value))
      numbers.fail("face " + std::to_string(Mesh::face(h)) + " and face " +
                   std::to_string(Mesh::face(mesh.halfedge(mesh.edge(h)))) +
                   " give different lengths of the edge between them");
    if (length == 0) length = value;
  }
  if (numbers.next(value))
    numbers.fail("more than the " + std::to_string(mesh.halfedges()) + " lengths of the mesh, three a face");
  return lengths;
}

}  // namespace

VectorX<double> read_edge_lengths(const std::filesystem::path& file, const Mesh& mesh, const RunControl& control) {
  return controlled(control, [&] {
    const detail::InputFile input(file, {.what = "file of lengths"});
    const auto bytes = input.bytes();
    return read({file.string(), {bytes.data(), bytes.size()}}, mesh);
  });
}

}  // namespace alcap
