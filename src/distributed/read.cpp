// SPDX-License-Identifier: MIT
//
// read.cpp: slices of files. Of a binary PLY, rank 0 reads the header; then every rank reads the rows of its slice.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "alcap/distributed.h"
#include "solvers/petsc/session.h"
#include "src/base/array.h"
#include "src/base/bytes.h"
#include "src/base/limits.h"
#include "src/distributed/meter.h"
#include "src/distributed/parallel_file.h"
#include "src/distributed/read_off.h"
#include "src/distributed/together.h"
#include "src/io/mesh/ply_header.h"

namespace alcap {
namespace detail::distributed {
namespace {

/// Headers are a few hundred bytes.
constexpr std::int64_t longest_header = 1 << 20;

/// A number of a row: where it lies, and its type.
struct Place {
  std::int64_t offset = 0;
  PlyType type = PlyType::float32;
};

/// A table of rows of one length.
struct Table {
  std::int64_t begin = 0, count = 0, row = 0;
  [[nodiscard]] std::int64_t end() const { return begin + count * row; }
};

struct Layout {
  bool little = true;
  Table vertices, faces;
  Place coordinate[3], count, corner;
  bool is_off = false;  // then the rest has no meaning
  OffHeader off = {};
};

[[noreturn]] void refuse(const std::string& path, const std::string& what) {
  throw FileError(path + ": " + what, path);
}

constexpr const char* remedy =
    "; read it with alcap and save it as binary PLY of triangles (alcap info says what it is)";

void lay_out_vertices(const std::string& path, const PlyElement& element, Layout& layout) {
  std::int64_t row = 0;
  bool found[3] = {};
  for (const PlyProperty& p : element.properties) {
    if (p.is_list)
      refuse(path, "element 'vertex' has a list, so that its rows have no fixed length" + std::string(remedy));
    for (int c = 0; c < 3; ++c)
      if (p.name == std::string_view("xyz").substr(at(c), 1)) {
        layout.coordinate[c] = {row, p.type};
        found[c] = true;
      }
    row += static_cast<std::int64_t>(size_of(p.type));
  }
  for (int c = 0; c < 3; ++c)
    if (!found[c]) refuse(path, std::string("element 'vertex' has no plain property '") + "xyz"[c] + "'");
  layout.vertices.count = element.count;
  layout.vertices.row = row;
}

void lay_out_faces(const std::string& path, const PlyElement& element, Layout& layout) {
  const int corners = element.find("vertex_indices", "vertex_index");
  std::int64_t row = 0;
  for (std::size_t k = 0; k < element.properties.size(); ++k) {
    const PlyProperty& p = element.properties[k];
    const auto size = static_cast<std::int64_t>(size_of(p.type));
    if (!p.is_list) {
      row += size;
      continue;
    }
    if (static_cast<int>(k) != corners)
      refuse(path, "element 'face' has a list besides its corners" + std::string(remedy));
    if (p.type >= PlyType::float32) refuse(path, "vertex_indices must be of a whole-number type" + std::string(remedy));
    const auto count_size = static_cast<std::int64_t>(size_of(p.count_type));
    layout.count = {row, p.count_type};
    layout.corner = {row + count_size, p.type};
    row += count_size + 3 * size;
  }
  if (layout.corner.offset == 0) refuse(path, "element 'face' has no list property 'vertex_indices'");
  layout.faces.count = element.count;
  layout.faces.row = row;
}

std::int64_t fixed_row(const std::string& path, const PlyElement& element) {
  std::int64_t row = 0;
  for (const PlyProperty& p : element.properties) {
    if (p.is_list && element.count > 0)
      refuse(path, "element '" + std::string(element.name) + "' has a list and comes before the faces" + remedy);
    row += static_cast<std::int64_t>(size_of(p.type));
  }
  return row;
}

/// Throws FileError. `bytes`: the beginning of the file.
Layout lay_out(const std::string& path, std::string_view bytes, std::int64_t size) {
  if (size == 0) refuse(path, "the file is empty");
  if (bytes.starts_with("OFF")) {
    Layout text;
    text.is_off = true;
    text.off = read_off_header(path, bytes);
    return text;
  }
  if (!bytes.starts_with("ply")) refuse(path, "this is no PLY or OFF file" + std::string(remedy));
  const Source source{path, bytes};
  const PlyHeader header = read_ply_header(source);
  if (header.encoding == PlyEncoding::ascii)
    refuse(path, "the file is text, in which no rank can jump to its slice" + std::string(remedy));
  Layout layout;
  layout.little = header.encoding == PlyEncoding::little_endian;
  std::int64_t begin = header.body - source.begin();
  bool vertices = false, faces = false;
  for (const PlyElement& element : header.elements) {
    if (vertices && faces) break;
    constexpr std::int64_t longest_row = 100'000;
    if (element.count > std::numeric_limits<std::int64_t>::max() / longest_row) refuse(path, "too many elements");
    if (element.name == "vertex") {
      lay_out_vertices(path, element, layout);
      layout.vertices.begin = begin;
      begin = layout.vertices.end();
      vertices = true;
    } else if (element.name == "face") {
      lay_out_faces(path, element, layout);
      layout.faces.begin = begin;
      begin = layout.faces.end();
      faces = true;
    } else {
      begin += element.count * fixed_row(path, element);
    }
    if (begin < 0) refuse(path, "too many elements");
  }
  if (!vertices) refuse(path, "the file has no element 'vertex'");
  if (!faces) refuse(path, "the file has no element 'face'");
  for (const Table* table : {&layout.vertices, &layout.faces})
    if (table->count > most_numbered)
      refuse(path, "the file has " + std::to_string(table->count) + " vertices or faces, more than the " +
                       std::to_string(most_numbered) + " that can be numbered");
  // A face with more than three corners makes the file longer, one that is cut shorter.
  if (begin > size)
    refuse(path, "the file ends before its last face: it was cut, or has faces of fewer than three corners");
  return layout;
}

template <std::endian order, class Use>
auto with_number(PlyType type, const char* p, Use use) {
  switch (type) {
    case PlyType::int8:
      return use(load<std::int8_t, order>(p));
    case PlyType::uint8:
      return use(load<std::uint8_t, order>(p));
    case PlyType::int16:
      return use(load<std::int16_t, order>(p));
    case PlyType::uint16:
      return use(load<std::uint16_t, order>(p));
    case PlyType::int32:
      return use(load<std::int32_t, order>(p));
    case PlyType::uint32:
      return use(load<std::uint32_t, order>(p));
    case PlyType::float32:
      return use(load<float, order>(p));
    default:
      return use(load<double, order>(p));
  }
}

[[noreturn]] void refuse_index(const std::string& path, std::int64_t v, const MeshSlice& mesh, std::int64_t face) {
  refuse(
      path,
      "face " + std::to_string(face) + " (counted from 0) names vertex " + std::to_string(v) + " (counted from 0), " +
          (v < 0 ? "which is before the first one" : "but there are " + std::to_string(mesh.vertices) + " vertices") +
          "; the file was cut or its indices are off");
}

template <std::endian order>
void parse(const std::string& path, const Layout& layout, const std::vector<char>& vertices,
           const std::vector<char>& faces, MeshSlice& mesh) {
  const auto real = [](auto value) { return static_cast<double>(value); };
  const auto whole = [](auto value) -> std::int64_t {
    if constexpr (std::is_integral_v<decltype(value)>) {
      return value;
    } else {
      return -1;  // lists have whole numbers, which lay_out_faces() has checked
    }
  };
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
    for (int c = 0; c < 3; ++c)
      mesh.V(v, c) = with_number<order>(layout.coordinate[c].type,
                                        vertices.data() + v * layout.vertices.row + layout.coordinate[c].offset, real);
    if (!mesh.V.row(v).allFinite())
      refuse(path, "vertex " + std::to_string(mesh.first_vertex + v) + " (counted from 0) is not finite");
  }
  const auto size = static_cast<std::int64_t>(size_of(layout.corner.type));
  for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
    const char* const row = faces.data() + t * layout.faces.row;
    const std::int64_t corners = with_number<order>(layout.count.type, row + layout.count.offset, whole);
    if (corners != 3)
      throw FileError(path + ": face " + std::to_string(mesh.first_face + t) + " has " + std::to_string(corners) +
                          " corners; all faces must be triangles here" + remedy,
                      path, 0, layout.faces.begin + (mesh.first_face + t) * layout.faces.row);
    for (int c = 0; c < 3; ++c) {
      const std::int64_t v = with_number<order>(layout.corner.type, row + layout.corner.offset + c * size, whole);
      if (v < 0 || v >= mesh.vertices) refuse_index(path, v, mesh, mesh.first_face + t);
      mesh.F(t, c) = static_cast<Index>(v);
    }
  }
}

/// This rank's slice of a PLY file.
MeshSlice read_ply_slice(const std::string& path, const ParallelInput& file, const Layout& layout) {
  const Table &vertices = layout.vertices, &faces = layout.faces;
  MeshSlice mesh;
  mesh.vertices = vertices.count;
  mesh.faces = faces.count;
  mesh.first_vertex = slice_begin(mesh.vertices, rank(), ranks());
  mesh.first_face = slice_begin(mesh.faces, rank(), ranks());
  const std::int64_t vertex_rows = slice_begin(mesh.vertices, rank() + 1, ranks()) - mesh.first_vertex;
  const std::int64_t face_rows = slice_begin(mesh.faces, rank() + 1, ranks()) - mesh.first_face;
  const std::vector<char> v = file.read(vertices.begin + mesh.first_vertex * vertices.row, vertex_rows * vertices.row);
  const std::vector<char> f = file.read(faces.begin + mesh.first_face * faces.row, face_rows * faces.row);
  agreed([&] {
    mesh.V.resize(vertex_rows, 3);
    mesh.F.resize(face_rows, 3);
    if (layout.little)
      parse<std::endian::little>(path, layout, v, f, mesh);
    else
      parse<std::endian::big>(path, layout, v, f, mesh);
  });
  return mesh;
}

}  // namespace
}  // namespace detail::distributed

MeshSlice read_mesh_slice(const std::string& path) {
  using namespace detail;
  using namespace detail::distributed;
  const petsc::Session session;
  Meter meter;
  const ParallelInput file(path);
  const std::vector<char> start = file.read(0, rank() == 0 ? std::min(file.size(), longest_header) : 0);
  std::vector<Layout> layout;
  agreed([&] {
    if (rank() == 0) layout.push_back(lay_out(path, {start.data(), start.size()}, file.size()));
  });
  layout = gather_all(layout);
  MeshSlice mesh = layout[0].is_off ? read_off_slice(path, file, layout[0].off) : read_ply_slice(path, file, layout[0]);
  meter.done("read", mesh.phases);
  return mesh;
}

MeshSlice slice_of(const Positions<double>& V, const Faces& F) {
  using namespace detail::distributed;
  const detail::petsc::Session session;
  MeshSlice mesh;
  mesh.vertices = V.rows();
  mesh.faces = F.rows();
  mesh.first_vertex = slice_begin(V.rows(), rank(), ranks());
  mesh.first_face = slice_begin(F.rows(), rank(), ranks());
  mesh.V = V.middleRows(mesh.first_vertex, slice_begin(V.rows(), rank() + 1, ranks()) - mesh.first_vertex);
  mesh.F = F.middleRows(mesh.first_face, slice_begin(F.rows(), rank() + 1, ranks()) - mesh.first_face);
  return mesh;
}

}  // namespace alcap
