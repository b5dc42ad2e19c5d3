// SPDX-License-Identifier: MIT
//
// ply.cpp: the mesh with the field at its vertices, binary little endian, everything in double: what read_ply.cpp reads
// back bit for bit. Programs that know only meshes see a mesh with normals.
#include "src/io/field/ply_rows.h"

#include "alcap/version.h"
#include "src/base/narrow.h"
#include "src/io/field/format.h"
#include "src/io/field/rows.h"

namespace alcap::detail {
namespace {

std::string info(const char* key, double value) {
  return std::string("obj_info ") + key + " " + number_text(value) + "\n";
}

/// What connect() needs to make the connection again.
std::string describe(const Connection& c) {
  std::string text = "obj_info connection " + std::string(name(c.kind)) + "\n";
  if (c.center != PolarCenter::incenter) text += "obj_info center " + std::string(name(c.center)) + "\n";
  text += info("detail", c.options.detail);
  text += "obj_info length_factor " + std::string(name(c.options.length_factor)) + "\n";
  text += info("tan_cap", c.options.tan_cap);
  for (const Cone& cone : c.cones) text += info(("cone " + std::to_string(cone.vertex)).c_str(), cone.index);
  for (const double turns : c.generator_holonomy) text += info("holonomy", turns);
  for (const double turns : c.loop_index) text += info("loop_index", turns);
  if (c.to_target) text += "obj_info target lost\n";
  return text;
}

WrittenFiles write_ply(const FieldJob& job, const Target& target) {
  const FieldOutput& out = job.out;
  const Branches branches(out.field.n);
  const Mesh& mesh = out.surface.mesh();
  WrittenFiles files = open_files({target.file});
  AtomicFile& file = *files[0];
  check_32_bits(file.target(), mesh.vertices(), "vertices");
  file.write(ply_field_header(out.field.n, out.surface.connection(), mesh.vertices(), mesh.faces()));
  write_table(file, mesh.vertices(), ply_vertex_bytes, [&](std::int64_t i, char* to) {
    return put_ply_vertex(out.surface.V(), out.field, *out.field.frames, branches, static_cast<Index>(i), to);
  });
  write_table(file, mesh.faces(), ply_face_bytes,
              [&](std::int64_t t, char* to) { return put_ply_face(mesh.F(), static_cast<Index>(t), to); });
  return files;
}

}  // namespace

std::string ply_field_header(int n, const Connection& connection, std::int64_t vertices, std::int64_t faces) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  text += std::string("comment n-vector field, written by alcap ") + version() + "\n";
  text += "comment u = u_re + i u_im is the n-th power of any of the n branches, in the frame of its vertex\n";
  text += "comment frame: axis (unit tangent) and nx ny nz (unit normal); the component r exp(i a) is the vector\n";
  text += "comment r (cos(a) axis + sin(a) normal x axis); d_x d_y d_z is branch 0, argument arg(u) / n\n";
  text += "comment all of it is zero at vertices that no face uses\n";
  text += "obj_info alcap_field 1\n";
  text += "obj_info n " + std::to_string(n) + "\n";
  text += describe(connection);
  text += "element vertex " + std::to_string(vertices) + "\n";
  for (const char* name :
       {"x", "y", "z", "nx", "ny", "nz", "axis_x", "axis_y", "axis_z", "u_re", "u_im", "d_x", "d_y", "d_z"}) {
    text += std::string("property double ") + name + "\n";
  }
  text += "element face " + std::to_string(faces) + "\n";
  text += "property list uchar int vertex_indices\nend_header\n";
  return text;
}

char* put_ply_vertex(const Positions<double>& V, const Field& field, const Frames& frames, const Branches& branches,
                     Index v, char* to) {
  const Eigen::RowVector3d d = branches.at(field, v).vector(0);
  for (int c = 0; c < 3; ++c) to = put_binary(to, V(v, c));
  for (int c = 0; c < 3; ++c) to = put_binary(to, frames.N(v, c));
  for (int c = 0; c < 3; ++c) to = put_binary(to, frames.X(v, c));
  to = put_binary(to, field.u[v].real());
  to = put_binary(to, field.u[v].imag());
  for (int c = 0; c < 3; ++c) to = put_binary(to, d[c]);
  return to;
}

char* put_ply_face(const Faces& F, Index t, char* to) {
  to = put_binary(to, std::uint8_t{3});
  for (int c = 0; c < 3; ++c) to = put_binary(to, static_cast<std::int32_t>(F(t, c)));
  return to;
}

const OutputFormat ply_field_format = {"ply", false, write_ply};

}  // namespace alcap::detail
