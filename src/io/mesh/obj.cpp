// SPDX-License-Identifier: MIT
//
// obj.cpp: Wavefront OBJ. Reads v and f (and fo, its name of old); texture coordinates, normals, groups, materials,
// lines and curves are counted, and so are statements that other programs made up, with a remark. V and F are errors,
// and so is what is no word: a misspelt 'v' would shift every vertex behind it.
#include <algorithm>
#include <array>

#include "src/io/mesh/builder.h"
#include "src/io/mesh/format.h"
#include "src/io/mesh/tokenizer.h"

namespace alcap::detail {
namespace {

constexpr std::array<std::string_view, 43> ignored_words = {
    "vt",       "vn",     "vp",   "l",      "p",      "o",          "g",         "s",     "mg",
    "mtllib",   "usemtl", "lod",  "maplib", "usemap", "shadow_obj", "trace_obj", "bevel", "c_interp",
    "d_interp", "cstype", "deg",  "bmat",   "step",   "curv",       "curv2",     "surf",  "parm",
    "trim",     "hole",   "scrv", "sp",     "end",    "con",        "call",      "csh",   "ctech",
    "stech",    "bsp",    "bzp",  "cdc",    "cdp",    "res",        "vs"};

constexpr std::size_t most_unknown = 16;  // that a remark names

bool is_ignored(std::string_view word) { return std::ranges::find(ignored_words, word) != ignored_words.end(); }

// What a program may have made up: letters, digits and underscores, but not v and f in capitals.
bool is_word(std::string_view word) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  if (word == "V" || word == "F" || !letter(word.front())) return false;
  return std::ranges::all_of(word, [&](char c) { return letter(c) || (c >= '0' && c <= '9'); });
}

bool recognise_obj(std::string_view bytes) {
  const Source source{"", bytes};
  Tokenizer in(source);
  if (!in.next_token()) return false;
  const std::string_view word = in.word();
  return word == "v" || word == "f" || is_ignored(word);
}

void read_face(Tokenizer& in, Builder& mesh, std::vector<std::int64_t>& corners) {
  const char* const where = in.where();
  corners.clear();
  while (!in.at_line_end()) {
    std::int64_t v = 0;
    const char* const token = in.where();
    if (!in.integer(v, '/') || !in.skip_references()) {
      in.go(token);
      in.fail_number("corner of " + mesh.next_face());
    }
    if (v == 0) fail_at(in.source(), token, mesh.next_face() + " names vertex 0; OBJ counts from 1");
    corners.push_back(v > 0 ? v - 1 : mesh.vertices() + v);
  }
  mesh.face(corners, where);
}

// The segments of a line; what is no vertex ends it.
void read_line(Tokenizer& in, Builder& mesh) {
  std::int64_t last = 0;
  for (bool first = true; !in.at_line_end(); first = false) {
    std::int64_t v = 0;
    if (!in.integer(v, '/') || !in.skip_references() || v == 0) {
      in.skip_statement();
      return;
    }
    v = v > 0 ? v - 1 : mesh.vertices() + v;
    if (!first) mesh.edge(last, v);
    last = v;
  }
}

[[noreturn]] void fail_unknown(const Source& source, const char* where, std::string_view word) {
  fail_at(source, where, quoted(word) + " is no OBJ statement; is this an OBJ file? If so, repair or remove the line");
}

MeshFile read_obj(const Source& source, const ReadOptions& options) {
  Tokenizer in(source);
  Builder mesh(source, options);
  std::vector<std::int64_t> corners;
  std::vector<std::string> unknown;
  const char* first_unknown = nullptr;
  for (std::int64_t statement = 0; in.next_token(); ++statement) {
    const char* const where = in.where();
    mesh.tick(statement, where);
    const std::string_view word = in.word();
    if (word == "v") {
      double x[3];
      const char* const numbers = in.where();
      if (!in.real_or_nan(x[0]) || !in.real_or_nan(x[1]) || !in.real_or_nan(x[2]))
        in.fail_number("coordinate of " + mesh.next_vertex());
      mesh.vertex(x, numbers);
      if (!in.at_line_end()) in.skip_statement();  // a weight or a colour
    } else if (word == "f" || word == "fo") {
      read_face(in, mesh, corners);
    } else if (is_ignored(word)) {
      mesh.ignore(word);
      if (word == "l")
        read_line(in, mesh);
      else
        in.skip_statement();
    } else if (is_word(word)) {
      if (unknown.empty()) first_unknown = where;
      if (std::ranges::find(unknown, word) == unknown.end() && unknown.size() < most_unknown)
        unknown.emplace_back(word);
      mesh.ignore(unknown.size() < most_unknown ? word : "other");
      in.skip_statement();
    } else {
      fail_unknown(source, where, word);
    }
  }
  if (mesh.vertices() == 0 && first_unknown != nullptr) fail_unknown(source, first_unknown, unknown.front());
  if (!unknown.empty()) {
    std::string list;
    for (const std::string& word : unknown) list += (list.empty() ? "" : ", ") + word;
    mesh.remark("lines that are no OBJ statements were skipped: " + list);
  }
  return mesh.finish("obj");
}

void write_obj(AtomicFile& file, const Positions<double>& V, const Faces& F) {
  for (Eigen::Index v = 0; v < V.rows(); ++v) {
    file.write("v");
    for (int c = 0; c < 3; ++c) file.write(" "), write_number(file, V(v, c));
    file.write("\n");
  }
  for (Eigen::Index t = 0; t < F.rows(); ++t) {
    file.write("f");
    for (int c = 0; c < 3; ++c) file.write(" "), write_number(file, std::int64_t{F(t, c)} + 1);
    file.write("\n");
  }
}

}  // namespace

const Format obj_format = {"obj", recognise_obj, read_obj, write_obj};

}  // namespace alcap::detail
