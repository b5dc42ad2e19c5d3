// SPDX-License-Identifier: MIT
//
// off.cpp: Object File Format of Geomview, text and binary, three dimensions: OFF, COFF, NOFF, STOFF and their
// combinations. One vertex and one face per line; what follows the three coordinates or the corners (colours, normals)
// is skipped. Text that is laid out otherwise is read number by number, if every number then has its place.
#include <algorithm>
#include <optional>
#include <utility>

#include "src/base/array.h"
#include "src/base/bytes.h"
#include "src/io/mesh/builder.h"
#include "src/io/mesh/format.h"
#include "src/io/mesh/tokenizer.h"

namespace alcap::detail {
namespace {

/// What a keyword says of vertices: the letters before OFF are ST texture, C colour, N normal, 4 and n dimension.
/// Geomview defines their order, and exporters do not keep it.
struct Keyword {
  std::string_view text;  ///< without what is glued to it: well-known data sets begin with "OFF8 12 0"
  bool texture = false, colour = false, normal = false, four = false, any = false;
};

std::optional<Keyword> find_keyword(std::string_view word) {
  Keyword out;
  std::string_view rest = word;
  const std::pair<std::string_view, bool*> prefixes[] = {
      {"ST", &out.texture}, {"C", &out.colour}, {"N", &out.normal}, {"4", &out.four}, {"n", &out.any}};
  for (bool found = true; found && !rest.starts_with("OFF");) {
    found = false;
    for (const auto& [prefix, flag] : prefixes) {
      if (*flag || !rest.starts_with(prefix)) continue;
      rest.remove_prefix(prefix.size());
      *flag = found = true;
    }
  }
  if (!rest.starts_with("OFF")) return std::nullopt;
  rest.remove_prefix(3);
  if (!std::ranges::all_of(rest, [](char c) { return c >= '0' && c <= '9'; })) return std::nullopt;
  out.text = word.substr(0, word.size() - rest.size());
  return out;
}

bool recognise_off(std::string_view bytes) {
  const Source source{"", bytes};
  Tokenizer in(source);
  return in.next_token() && find_keyword(in.word()).has_value();
}

/// The keyword; leaves the tokenizer behind it, and behind the word BINARY.
Keyword read_keyword(Tokenizer& in, const Source& source, bool& binary) {
  if (!in.next_token()) fail(source, "there is nothing but comments; an OFF file starts with the word OFF");
  const char* const where = in.where();
  const std::string_view word = in.word();
  const std::optional<Keyword> keyword = find_keyword(word);
  if (!keyword)
    fail_at(source, where, "an OFF file starts with the word OFF, this one with " + quoted(word) + "; add it");
  if (keyword->four || keyword->any)
    fail_at(source, where, quoted(word) + " is not three-dimensional; only OFF with x y z can be read");
  in.go(where + keyword->text.size());
  const char* const behind = in.where();
  binary = in.word() == "BINARY";
  if (!binary) in.go(behind);
  return *keyword;
}

/// Text. By lines: what follows three coordinates or the corners on a line (colours, normals) is skipped. Free: line
/// ends mean nothing, and nothing is skipped.
class TextReader {
 public:
  TextReader(const Source& source, const ReadOptions& options, const char* from, bool free)
      : in_(source, from), source_(source), mesh_(source, options), free_(free) {}

  MeshFile run() {
    read_counts();
    mesh_.reserve_vertices(vertices_);
    mesh_.reserve_faces(faces_);
    while (mesh_.vertices() < vertices_) read_vertex();
    while (mesh_.faces() < faces_) read_face();
    if (in_.next_token()) {
      in_.fail(
          "something follows the last face that the header announces; each vertex and each face needs a line of its "
          "own");
    }
    if (free_) mesh_.remark("vertices and faces are not on lines of their own; read number by number");
    return mesh_.finish("off");
  }

 private:
  void read_counts() {
    in_.next_token();
    if (!in_.integer(vertices_)) in_.fail_number("number of vertices");
    if (free_) in_.next_token();
    if (!in_.integer(faces_)) in_.fail_number("number of faces");
    std::int64_t edges = 0;
    if (!in_.at_line_end() && !in_.integer(edges)) in_.fail_number("number of edges");
    if (!in_.at_line_end() && !free_)
      in_.fail("only three counts belong on the line of the counts; put the vertices on their own");
    check_count(source_, in_.where(), vertices_, 6, "vertices");  // "0 0 0\n"
    check_count(source_, in_.where(), faces_, 8, "faces");        // "3 0 0 0\n"
  }

  void read_vertex() {
    in_.next_token();
    const char* const where = in_.where();
    double x[3];
    for (double& value : x) {
      if (free_) in_.next_token();
      if (!in_.real_or_nan(value)) in_.fail_number("coordinate of " + mesh_.next_vertex());
    }
    mesh_.vertex(x, where);
    if (!free_) in_.skip_line();
  }

  void read_face() {
    in_.next_token();
    const char* const where = in_.where();
    std::int64_t count = 0;
    if (!in_.integer(count)) in_.fail_number("number of corners of " + mesh_.next_face());
    if (count < (free_ ? 3 : 0) || count > in_.end() - in_.where())
      fail_at(source_, where, "a face of " + std::to_string(count) + " corners");
    corners_.resize(at(count));
    for (auto& v : corners_) {
      if (free_) in_.next_token();
      if (!in_.integer(v)) in_.fail_number("corner of " + mesh_.next_face());
    }
    mesh_.face(corners_, where);
    if (!free_) in_.skip_line();
  }

  Tokenizer in_;
  const Source& source_;
  Builder mesh_;
  bool free_;
  std::int64_t vertices_ = 0, faces_ = 0;
  std::vector<std::int64_t> corners_;
};

/// Binary, as Geomview writes it: big endian, 4 bytes a number.
class BinaryReader {
 public:
  BinaryReader(const Source& source, const ReadOptions& options, const char* from)
      : source_(source), mesh_(source, options), p_(from) {}

  MeshFile run(const Keyword& keyword) {
    const std::int64_t vertices = integer("number of vertices"), faces = integer("number of faces");
    (void)integer("number of edges");
    const int behind = (keyword.normal ? 3 : 0) + (keyword.colour ? 4 : 0) + (keyword.texture ? 2 : 0);
    check_count(source_, p_, vertices, 4 * (3 + behind), "vertices");
    check_count(source_, p_, faces, 8, "faces");
    mesh_.reserve_vertices(vertices);
    mesh_.reserve_faces(faces);
    while (mesh_.vertices() < vertices) {
      const char* const where = p_;
      double x[3];
      for (double& value : x) value = double{take<float>("coordinate of ", true)};
      mesh_.vertex(x, where);
      skip(behind, "numbers of ", true);
    }
    std::vector<std::int64_t> corners;
    while (mesh_.faces() < faces) {
      const char* const where = p_;
      const std::int64_t count = integer("number of corners");
      if (count < 0 || count > left() / 4) fail_at(source_, where, "a face of " + std::to_string(count) + " corners");
      corners.resize(at(count));
      for (auto& v : corners) v = integer("corner");
      mesh_.face(corners, where);
      skip(integer("number of colours"), "colours", false);
    }
    if (p_ != source_.end()) fail_at(source_, p_, "there is more behind the last face that the header announces");
    return mesh_.finish("off");
  }

 private:
  [[nodiscard]] std::int64_t left() const { return source_.end() - p_; }
  [[noreturn]] void cut(const std::string& what) const {
    fail_at(source_, p_, "the file ends before " + what + "; it was cut");
  }
  template <class T>
  T take(const char* what, bool vertex) {
    if (left() < 4) cut(what + (vertex ? mesh_.next_vertex() : std::string()));
    const T value = load<T, std::endian::big>(p_);
    p_ += 4;
    return value;
  }
  std::int64_t integer(const char* what) { return take<std::int32_t>(what, false); }
  void skip(std::int64_t numbers, const char* what, bool vertex) {
    if (numbers < 0 || numbers > left() / 4) cut(what + (vertex ? mesh_.next_vertex() : std::string()));
    p_ += 4 * numbers;
  }

  const Source& source_;
  Builder mesh_;
  const char* p_;
};

MeshFile read_off(const Source& given, const ReadOptions& options) {
  Source source = given;  // remembers where the binary part begins
  Tokenizer in(source);
  bool binary = false;
  const Keyword keyword = read_keyword(in, source, binary);
  if (binary) {
    const char* body = in.where();
    if (body != source.end() && *body == '\r') ++body;
    if (body != source.end() && *body == '\n') ++body;
    source.binary_from = body;
    return BinaryReader(source, options, body).run(keyword);
  }
  try {
    return TextReader(source, options, in.where(), false).run();
  } catch (const FileError&) {
    // Perhaps line ends mean nothing. Then every number must have its place, to the last one.
    if (keyword.texture || keyword.colour || keyword.normal) throw;
    std::optional<MeshFile> free;
    try {
      free = TextReader(source, options, in.where(), true).run();
    } catch (const FileError&) {  // no: what was wrong by lines is what is wrong
    }
    if (!free) throw;
    return std::move(*free);
  }
}

void write_off(AtomicFile& file, const Positions<double>& V, const Faces& F) {
  file.write("OFF\n" + std::to_string(V.rows()) + " " + std::to_string(F.rows()) + " 0\n");
  for (Eigen::Index v = 0; v < V.rows(); ++v) {
    for (int c = 0; c < 3; ++c) write_number(file, V(v, c)), file.write(c < 2 ? " " : "\n");
  }
  for (Eigen::Index t = 0; t < F.rows(); ++t) {
    file.write("3");
    for (int c = 0; c < 3; ++c) file.write(" "), write_number(file, std::int64_t{F(t, c)});
    file.write("\n");
  }
}

}  // namespace

const Format off_format = {"off", recognise_off, read_off, write_off};

}  // namespace alcap::detail
