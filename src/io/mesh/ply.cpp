// SPDX-License-Identifier: MIT
//
// ply.cpp: Stanford PLY. Reads x y z of "vertex" and the list vertex_indices (or vertex_index) of "face"; any other
// property or element, of any type and in any order, is stepped over.
#include <array>
#include <optional>
#include <utility>

#include "src/base/bytes.h"
#include "src/base/narrow.h"
#include "src/base/numbers.h"
#include "src/io/mesh/builder.h"
#include "src/io/mesh/format.h"
#include "src/io/mesh/ply_body.h"

namespace alcap::detail {
namespace {

// A broken list length must not make us allocate; longer lists of corners do not occur.
constexpr std::int64_t longest_list = 1 << 24;

bool recognise_ply(std::string_view bytes) {
  return bytes.starts_with("ply") && bytes.size() > 3 && (bytes[3] == '\n' || bytes[3] == '\r' || bytes[3] == ' ');
}

template <class Body>
class Reader {
 public:
  Reader(const Source& source, const PlyHeader& header, const ReadOptions& options, bool free = false)
      : source_(source), header_(header), body_(source, header.body, free), mesh_(source, options) {
    free_ = free;
    for (const std::string& remark : header.remarks) mesh_.remark(remark);
    if (free) mesh_.remark("elements are not on lines of their own; read number by number");
  }

  MeshFile run() {
    for (const auto& element : header_.elements) {
      std::int64_t least = 0;
      for (const auto& p : element.properties) least += body_.least_bytes(p.is_list ? p.count_type : p.type);
      if (least > 0) check_count(source_, body_.where(), element.count, least, "elements " + quoted(element.name));
      if (element.name == "vertex") {
        read_vertices(element);
      } else if (element.name == "face") {
        read_faces(element);
      } else {
        read_other(element);
      }
    }
    if (!body_.at_end()) {
      // Less than one more element of the kind that comes last: nothing is missing.
      const std::int64_t behind = source_.end() - body_.where();
      if (source_.binary_from == nullptr || behind >= 4)
        fail_at(source_, body_.where(), "there is more behind the last element that the header announces");
      mesh_.remark(counted(behind, "byte", "bytes") + " behind the data; left out");
    }
    return mesh_.finish("ply");
  }

 private:
  void skip(const PlyProperty& p, const PlyElement& element) {
    std::int64_t count = 1;
    const char* const where = body_.where();
    if (p.is_list && !body_.integer(p.count_type, count)) fail_value(p, element);
    if (count < 0) {
      fail_at(source_, where,
              quoted(p.name) + " of element " + quoted(element.name) + " has " + std::to_string(count) +
                  " values; the file is damaged or cut");
    }
    if (!body_.skip(p.type, count)) fail_value(p, element);
  }

  [[noreturn]] void fail_value(const PlyProperty& p, const PlyElement& element) {
    body_.fail(quoted(p.name) + " of element " + quoted(element.name));
  }

  void read_vertices(const PlyElement& element) {
    std::array<int, 3> at = {element.find("x", "x"), element.find("y", "y"), element.find("z", "z")};
    for (std::size_t c = 0; c < 3; ++c) {
      if (at[c] < 0 || element.properties[static_cast<std::size_t>(at[c])].is_list) {
        fail(source_, std::string("element 'vertex' has no plain property '") + "xyz"[c] + "'");
      }
    }
    std::vector<int> slots(element.properties.size(), -1);  // which coordinate a property is
    for (std::size_t c = 0; c < 3; ++c) slots[static_cast<std::size_t>(at[c])] = static_cast<int>(c);
    mesh_.reserve_vertices(element.count);
    for (std::int64_t v = 0; v < element.count; ++v) {
      double x[3] = {};
      body_.begin();
      const char* const where = body_.where();
      for (std::size_t i = 0; i < slots.size(); ++i) {
        const auto& p = element.properties[i];
        if (slots[i] < 0) {
          skip(p, element);
        } else if (!body_.real(p.type, x[slots[i]])) {
          body_.fail("coordinate " + std::string(p.name) + " of " + mesh_.next_vertex());
        }
      }
      body_.end_of(element);
      mesh_.vertex(x, where);
    }
  }

  void read_faces(const PlyElement& element) {
    const int corners_at = element.find("vertex_indices", "vertex_index");
    if (corners_at < 0 || !element.properties[static_cast<std::size_t>(corners_at)].is_list) {
      fail(source_, "element 'face' has no list property 'vertex_indices'");
    }
    mesh_.reserve_faces(element.count);
    for (std::int64_t f = 0; f < element.count; ++f) {
      body_.begin();
      for (std::size_t i = 0; i < element.properties.size(); ++i) {
        const auto& p = element.properties[i];
        if (static_cast<int>(i) == corners_at) {
          read_corners(p);
        } else {
          skip(p, element);
        }
      }
      body_.end_of(element);
      mesh_.face(corners_, where_);
    }
  }

  void read_corners(const PlyProperty& p) {
    where_ = body_.where();
    std::int64_t count = 0;
    if (!body_.integer(p.count_type, count)) body_.fail("number of corners of " + mesh_.next_face());
    if (count < (free_ ? 3 : 0) || count > longest_list ||
        count > (source_.end() - where_) / body_.least_bytes(p.type)) {
      fail_at(source_, where_,
              mesh_.next_face() + " has " + std::to_string(count) + " corners; the file is damaged or cut");
    }
    corners_.resize(static_cast<std::size_t>(count));
    for (auto& v : corners_) {
      if (!body_.integer(p.type, v)) body_.fail("corner of " + mesh_.next_face());
    }
  }

  void read_other(const PlyElement& element) {
    if (element.count > 0 && element.name == "tristrips") {
      fail(source_, "the surface is stored as triangle strips, which are not read; save it with faces");
    }
    const bool edges = element.name == "edge";
    const std::array<int, 2> ends = {edges ? element.find("vertex1", "v1") : -1,
                                     edges ? element.find("vertex2", "v2") : -1};
    for (std::int64_t e = 0; e < element.count; ++e) {
      mesh_.tick(e, body_.where());
      body_.begin();
      std::array<std::int64_t, 2> vertex = {-1, -1};
      for (std::size_t i = 0; i < element.properties.size(); ++i) {
        const auto& p = element.properties[i];
        const int end = static_cast<int>(i) == ends[0] ? 0 : static_cast<int>(i) == ends[1] ? 1 : -1;
        if (end < 0 || p.is_list) {
          skip(p, element);
        } else if (!body_.integer(p.type, vertex[static_cast<std::size_t>(end)])) {
          fail_value(p, element);
        }
      }
      body_.end_of(element);
      if (ends[0] >= 0 && ends[1] >= 0) mesh_.edge(vertex[0], vertex[1]);
    }
    mesh_.ignore(element.name, element.count);
  }

  const Source& source_;
  const PlyHeader& header_;
  Body body_;
  Builder mesh_;
  bool free_ = false;
  std::vector<std::int64_t> corners_;
  const char* where_ = nullptr;
};

MeshFile read_ply(const Source& given, const ReadOptions& options) {
  Source source = given;  // remembers where the binary part begins
  const PlyHeader header = read_ply_header(source);
  if (header.encoding == PlyEncoding::ascii) {
    try {
      return Reader<PlyText>(source, header, options).run();
    } catch (const FileError&) {
      // Perhaps lists are wrapped. Then every number must have its place, to the last one.
      std::optional<MeshFile> free;
      try {
        free = Reader<PlyText>(source, header, options, true).run();
      } catch (const FileError&) {  // no: what was wrong by lines is what is wrong
      }
      if (!free) throw;
      return std::move(*free);
    }
  }
  source.binary_from = header.body;
  if (header.encoding == PlyEncoding::little_endian) {
    return Reader<PlyBinary<std::endian::little>>(source, header, options).run();
  }
  return Reader<PlyBinary<std::endian::big>>(source, header, options).run();
}

template <class T>
void write_value(AtomicFile& file, T value) {
  const auto bytes = little_endian(value);
  file.write({bytes.data(), bytes.size()});
}

void write_ply(AtomicFile& file, const Positions<double>& V, const Faces& F) {
  check_32_bits(file.target(), V.rows(), "vertices");
  file.write("ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(V.rows()) +
             "\nproperty double x\nproperty double y\nproperty double z\nelement face " + std::to_string(F.rows()) +
             "\nproperty list uchar int vertex_indices\nend_header\n");
  for (Eigen::Index v = 0; v < V.rows(); ++v) {
    for (int c = 0; c < 3; ++c) write_value(file, V(v, c));
  }
  for (Eigen::Index t = 0; t < F.rows(); ++t) {
    write_value(file, std::uint8_t{3});
    for (int c = 0; c < 3; ++c) write_value(file, static_cast<std::int32_t>(F(t, c)));
  }
}

}  // namespace

const Format ply_format = {"ply", recognise_ply, read_ply, write_ply};

}  // namespace alcap::detail
