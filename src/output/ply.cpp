// SPDX-License-Identifier: MIT
//
// ply.cpp: the mesh with the field at its vertices, binary little endian, everything in double: what read_ply.cpp reads
// back bit for bit. Programs that know only meshes see a mesh with normals.
#include "alcap/version.h"
#include "output/format.h"
#include "output/rows.h"

namespace alcap::detail {
namespace {

std::string header(const FieldOutput& out) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  text += std::string("comment n-vector field, written by alcap ") + version() + "\n";
  text += "comment u = u_re + i u_im is the n-th power of any of the n branches, in the frame of its vertex\n";
  text += "comment frame: axis (unit tangent) and nx ny nz (unit normal); the component r exp(i a) is the vector\n";
  text += "comment r (cos(a) axis + sin(a) normal x axis); d_x d_y d_z is branch 0, argument arg(u) / n\n";
  text += "comment all of it is zero at vertices that no face uses\n";
  text += "obj_info alcap_field 1\n";
  text += "obj_info n " + std::to_string(out.field.n) + "\n";
  text += "obj_info connection " + std::string(connection_name(out.connection.kind)) + "\n";
  text += "element vertex " + std::to_string(out.mesh.vertices()) + "\n";
  for (const char* name :
       {"x", "y", "z", "nx", "ny", "nz", "axis_x", "axis_y", "axis_z", "u_re", "u_im", "d_x", "d_y", "d_z"}) {
    text += std::string("property double ") + name + "\n";
  }
  text += "element face " + std::to_string(out.mesh.faces()) + "\n";
  text += "property list uchar int vertex_indices\nend_header\n";
  return text;
}

std::vector<std::filesystem::path> write(FieldJob& job, const Target& target) {
  const FieldOutput& out = job.out;
  AtomicFile file(target.file);
  file.write(header(out));
  write_rows(file, out.mesh.vertices(), [&](std::int64_t i, std::string& bytes) {
    const auto v = static_cast<Index>(i);
    const Eigen::RowVector3d d = branch_vector(out.field, v, 0);
    for (int c = 0; c < 3; ++c) append_binary(bytes, out.V(v, c));
    for (int c = 0; c < 3; ++c) append_binary(bytes, out.field.frames->N(v, c));
    for (int c = 0; c < 3; ++c) append_binary(bytes, out.field.frames->X(v, c));
    append_binary(bytes, out.field.u[v].real());
    append_binary(bytes, out.field.u[v].imag());
    for (int c = 0; c < 3; ++c) append_binary(bytes, d[c]);
  });
  write_rows(file, out.mesh.faces(), [&](std::int64_t t, std::string& bytes) {
    append_binary(bytes, std::uint8_t{3});
    for (int c = 0; c < 3; ++c) append_binary(bytes, std::int32_t{out.mesh.F()(t, c)});
  });
  file.commit();
  return {target.file};
}

}  // namespace

const OutputFormat ply_field_format = {"ply", write};

}  // namespace alcap::detail
