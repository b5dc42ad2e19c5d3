// SPDX-License-Identifier: MIT
//
// read_field.cpp: reads back what ply.cpp wrote. The mesh comes through the reader of meshes, with its checks; the
// field from the properties of the same vertices, and n and the connection from the obj_info lines of the header.
#include <array>
#include <charconv>
#include <cmath>

#include "alcap/mesh_io.h"
#include "src/base/bytes.h"
#include "src/base/input_file.h"
#include "src/base/parallel.h"
#include "src/io/field/field_table.h"
#include "src/io/field/format.h"
#include "src/io/mesh/format.h"
#include "src/io/mesh/ply_header.h"

namespace alcap {
namespace detail {
namespace {

// The rest of the header line "obj_info KEY ...".
std::string_view info(const Source& source, std::string_view header, std::string_view key) {
  const std::string start = "\nobj_info " + std::string(key) + " ";
  const std::size_t at = header.find(start);
  if (at == std::string_view::npos) {
    fail(source, "the header has no line 'obj_info " + std::string(key) +
                     "'; only a .ply that write_field wrote holds a field, and other programs drop it on saving");
  }
  const std::string_view rest = header.substr(at + start.size());
  return rest.substr(0, rest.find_first_of("\r\n"));
}

int read_number(const Source& source, std::string_view text, std::string_view key) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 1) {
    fail_at(source, text.data(),
            "obj_info " + std::string(key) + " must be a whole number from 1 on, not " + quoted(text));
  }
  return value;
}

ConnectionKind read_connection(const Source& source, std::string_view text) {
  if (const auto kind = from_name<ConnectionKind>(text)) return *kind;
  fail_at(source, text.data(),
          "obj_info connection is " + quoted(text) + ", not polar, local, global, trivial or metric");
}

double read_real(const Source& source, std::string_view text, std::string_view key) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    fail_at(source, text.data(), "obj_info " + std::string(key) + " must be a number, not " + quoted(text));
  return value;
}

template <class E>
E read_choice(const Source& source, std::string_view text, std::string_view key) {
  if (const auto value = from_name<E>(text)) return *value;
  fail_at(source, text.data(), "obj_info " + std::string(key) + " cannot be " + quoted(text));
}

Cone read_cone(const Source& source, std::string_view text) {
  const std::size_t space = std::min(text.find(' '), text.size());
  Cone cone;
  const auto [end, error] = std::from_chars(text.data(), text.data() + space, cone.vertex);
  if (error != std::errc() || end != text.data() + space || space == text.size() || cone.vertex < 0)
    fail_at(source, text.data(), "obj_info cone must be a vertex and an index, not " + quoted(text));
  cone.index = read_real(source, text.substr(space + 1), "cone");
  return cone;
}

// The lines that say how the connection was made; those that are not there keep their defaults.
void read_how(const Source& source, std::string_view header, FieldFile& out) {
  out.how.kind = out.connection;
  out.how.n = out.field.n;
  bool weights = false, target = false;
  constexpr std::string_view start = "obj_info ";
  for (std::size_t at = 0; at < header.size();) {
    const std::size_t end = std::min(header.find_first_of("\r\n", at), header.size());
    std::string_view line = header.substr(at, end - at);
    at = end + 1;
    if (!line.starts_with(start)) continue;
    line.remove_prefix(start.size());
    const std::size_t space = std::min(line.find(' '), line.size());
    const std::string_view key = line.substr(0, space), text = line.substr(std::min(space + 1, line.size()));
    if (key == "center") out.how.polar.center = read_choice<PolarCenter>(source, text, key);
    if (key == "length_factor") out.how.global.length_factor = read_choice<LengthFactor>(source, text, key);
    if (key == "tan_cap") out.how.global.tan_cap = read_real(source, text, key);
    if (key == "cone") out.how.cones.push_back(read_cone(source, text));
    if (key == "holonomy") out.how.generator_holonomy.push_back(read_real(source, text, key));
    if (key == "loop_index") out.how.loop_index.push_back(read_real(source, text, key));
    target = target || key == "target";
    if (key != "detail") continue;
    out.how.global.detail = read_real(source, text, key);
    weights = true;
  }
  out.connection_known = weights && !target;
}

using Columns = FieldColumns;
constexpr std::array<const char*, 8> property_names = {"u_re", "u_im", "axis_x", "axis_y", "axis_z", "nx", "ny", "nz"};

Columns find_columns(const Source& source, const PlyHeader& header) {
  if (header.encoding != PlyEncoding::little_endian || header.elements.empty() || header.elements[0].name != "vertex") {
    fail(source, "not laid out as write_field does: binary little endian, vertices first");
  }
  const PlyElement& vertex = header.elements[0];
  Columns columns;
  std::vector<std::size_t> start;
  for (const PlyProperty& p : vertex.properties) {
    if (p.is_list)
      fail(source, "property " + quoted(p.name) + " of the vertices is a list; fields are written without");
    start.push_back(columns.stride);
    columns.stride += size_of(p.type);
  }
  for (std::size_t i = 0; i < property_names.size(); ++i) {
    const int found = vertex.find(property_names[i], property_names[i]);
    if (found < 0 || vertex.properties[static_cast<std::size_t>(found)].type != PlyType::float64) {
      fail(source, std::string("the vertices have no property double ") + property_names[i] +
                       "; only a .ply that write_field wrote holds a field");
    }
    columns.at[i] = start[static_cast<std::size_t>(found)];
  }
  return columns;
}

// The degree of a field of the version that is read here.
int read_degree(const Source& source, std::string_view header) {
  if (const int version = read_number(source, info(source, header, "alcap_field"), "alcap_field"); version != 1) {
    fail(source, "a field file of version " + std::to_string(version) + "; this program reads version 1");
  }
  return read_number(source, info(source, header, "n"), "n");
}

FieldFile read(const Source& source) {
  const PlyHeader header = read_ply_header(source);
  const std::string_view text(source.begin(), static_cast<std::size_t>(header.body - source.begin()));
  FieldFile out;
  out.field.n = read_degree(source, text);
  out.connection = read_connection(source, info(source, text, "connection"));
  read_how(source, text, out);
  const Columns columns = find_columns(source, header);

  MeshFile mesh = ply_format.read(source, {.format = "ply"});  // also finds a file that was cut
  if (!mesh.remarks.empty()) fail(source, "not as write_field wrote it: " + mesh.remarks.front());
  out.V = std::move(mesh.V);
  out.F = std::move(mesh.F);

  const std::int64_t vertices = out.V.rows();
  Frames frames{Positions<double>(vertices, 3), Positions<double>(vertices, 3)};
  out.field.u.resize(vertices);
  parallel_for(vertices, [&](std::int64_t v) {
    const char* const row = header.body + static_cast<std::size_t>(v) * columns.stride;
    const auto value = [&](std::size_t i) { return load<double, std::endian::little>(row + columns.at[i]); };
    out.field.u[v] = {value(0), value(1)};
    for (int c = 0; c < 3; ++c) {
      frames.X(v, c) = value(static_cast<std::size_t>(2 + c));
      frames.N(v, c) = value(static_cast<std::size_t>(5 + c));
    }
  });
  for (std::int64_t v = 0; v < vertices; ++v) {
    const bool finite = std::isfinite(out.field.u[v].real()) && std::isfinite(out.field.u[v].imag()) &&
                        frames.X.row(v).allFinite() && frames.N.row(v).allFinite();
    if (!finite) fail(source, "the field or the frame at vertex " + std::to_string(v) + " is not finite");
  }
  out.field.frames = std::make_shared<const Frames>(std::move(frames));
  return out;
}

}  // namespace

FieldTable find_field_table(const std::string& path, std::string_view beginning) {
  const Source source{path, beginning};
  const PlyHeader header = read_ply_header(source);
  FieldTable table;
  table.body = header.body - source.begin();
  table.n = read_degree(source, {source.begin(), static_cast<std::size_t>(table.body)});
  table.columns = find_columns(source, header);
  return table;
}

}  // namespace detail

FieldFile read_field(const std::filesystem::path& file, const RunControl& control) {
  return controlled(control, [&] {
    detail::report_phase("read");
    const detail::InputFile input(file, {.what = "field file"});
    return detail::read({file.string(), input.bytes()});
  });
}

}  // namespace alcap
