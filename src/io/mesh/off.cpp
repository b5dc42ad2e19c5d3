// SPDX-License-Identifier: MIT
//
// off.cpp: Object File Format of Geomview, text, three dimensions: OFF, COFF, NOFF, STOFF and their combinations. One
// vertex and one face per line; what follows the three coordinates or the corners (colours, normals) is skipped.
#include "src/base/array.h"
#include "src/io/mesh/builder.h"
#include "src/io/mesh/format.h"
#include "src/io/mesh/tokenizer.h"

namespace alcap::detail {
namespace {

// The letters before OFF, in the order Geomview defines: ST texture, C colour, N normal, 4 and n dimension.
bool is_keyword(std::string_view word) {
  if (!word.ends_with("OFF")) return false;
  word.remove_suffix(3);
  for (const std::string_view prefix : {"ST", "C", "N", "4", "n"}) {
    if (word.starts_with(prefix)) word.remove_prefix(prefix.size());
  }
  return word.empty();
}

bool recognise_off(std::string_view bytes) {
  const Source source{"", bytes};
  Tokenizer in(source);
  return in.next_token() && is_keyword(in.word());
}

void read_header(Tokenizer& in, const Source& source, std::int64_t& vertices, std::int64_t& faces) {
  if (!in.next_token()) fail(source, "there is nothing but comments; an OFF file starts with the word OFF");
  const char* const where = in.where();
  const std::string_view word = in.word();
  if (!is_keyword(word)) {
    fail_at(source, where, "an OFF file starts with the word OFF, this one with " + quoted(word) + "; add it");
  }
  if (word.find_first_of("4n") != std::string_view::npos) {
    fail_at(source, where, quoted(word) + " is not three-dimensional; only OFF with x y z can be read");
  }
  const char* const behind = in.where();
  if (in.word() == "BINARY") fail_at(source, behind, "binary OFF is not supported; save it as text or as PLY");
  in.go(behind);
  in.next_token();
  if (!in.integer(vertices)) in.fail_number("number of vertices");
  if (!in.integer(faces)) in.fail_number("number of faces");
  std::int64_t edges = 0;
  if (!in.at_line_end() && !in.integer(edges)) in.fail_number("number of edges");
  if (!in.at_line_end()) in.fail("only three counts belong on the line of the counts; put the vertices on their own");
  check_count(source, in.where(), vertices, 6, "vertices");  // "0 0 0\n"
  check_count(source, in.where(), faces, 8, "faces");        // "3 0 0 0\n"
}

MeshFile read_off(const Source& source, const ReadOptions& options) {
  Tokenizer in(source);
  Builder mesh(source, options);
  std::int64_t vertices = 0, faces = 0;
  read_header(in, source, vertices, faces);
  mesh.reserve_vertices(vertices);
  mesh.reserve_faces(faces);
  while (mesh.vertices() < vertices) {
    double x[3];
    in.next_token();
    if (!in.real(x[0]) || !in.real(x[1]) || !in.real(x[2])) in.fail_number("coordinate of " + mesh.next_vertex());
    mesh.vertex(x, in.where());
    in.skip_line();
  }
  std::vector<std::int64_t> corners;
  while (mesh.faces() < faces) {
    in.next_token();
    const char* const where = in.where();
    std::int64_t count = 0;
    if (!in.integer(count)) in.fail_number("number of corners of " + mesh.next_face());
    if (count < 0 || count > in.end() - in.where())
      fail_at(source, where, "a face of " + std::to_string(count) + " corners");
    corners.resize(at(count));
    for (auto& v : corners) {
      if (!in.integer(v)) in.fail_number("corner of " + mesh.next_face());
    }
    mesh.face(corners, where);
    in.skip_line();
  }
  if (in.next_token()) {
    in.fail(
        "something follows the last face that the header announces; each vertex and each face needs a line of its own");
  }
  return mesh.finish("off");
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
