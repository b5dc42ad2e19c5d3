// SPDX-License-Identifier: MIT
//
// vtp.cpp: VTK's XML PolyData with raw appended data: the surface with the field, and beside it the singularities as
// points. Field data "n" holds the number of branches.
#include "output/format.h"
#include "output/polydata.h"

namespace alcap::detail {
namespace {

using namespace polydata;

Array scalars(std::string name, std::int64_t rows, const double* values) {
  return {std::move(name), "Float64", 1, rows, [values](std::int64_t i, auto& b) { append_binary(b, values[i]); }};
}

void write_surface(AtomicFile& file, const FieldOutput& out, const std::vector<std::int32_t>& index) {
  const Field<double>& field = out.field;
  const std::int64_t vertices = out.mesh.vertices(), faces = out.mesh.faces();

  Section points{"Points", "", {}};
  points.arrays.push_back(
      {"Points", "Float64", 3, vertices, [&](std::int64_t v, auto& b) { append_vector(b, out.V.row(v)); }});

  Section polys{"Polys", "", {}};
  polys.arrays.push_back({"connectivity", "Int32", 1, 3 * faces, [&](std::int64_t h, auto& b) {
                            append_binary(b, std::int32_t{out.mesh.tail(static_cast<Index>(h))});
                          }});
  polys.arrays.push_back({"offsets", "Int32", 1, faces,
                          [](std::int64_t t, auto& b) { append_binary(b, static_cast<std::int32_t>(3 * (t + 1))); }});

  Section at_points{"PointData", " Scalars=\"magnitude\" Vectors=\"d_0\" Normals=\"normal\"", {}};
  for (int k = 0; k < field.n; ++k) {
    at_points.arrays.push_back({"d_" + std::to_string(k), "Float64", 3, vertices, [&field, k](std::int64_t v, auto& b) {
                                  append_vector(b, branch_vector(field, static_cast<Index>(v), k));
                                }});
  }
  at_points.arrays.push_back(
      {"magnitude", "Float64", 1, vertices, [&](std::int64_t v, auto& b) { append_binary(b, std::abs(field.u[v])); }});
  at_points.arrays.push_back({"u", "Float64", 2, vertices, [&](std::int64_t v, auto& b) {
                                append_binary(b, field.u[v].real());
                                append_binary(b, field.u[v].imag());
                              }});
  at_points.arrays.push_back(
      {"axis", "Float64", 3, vertices, [&](std::int64_t v, auto& b) { append_vector(b, field.frames->X.row(v)); }});
  at_points.arrays.push_back(
      {"normal", "Float64", 3, vertices, [&](std::int64_t v, auto& b) { append_vector(b, field.frames->N.row(v)); }});

  Section in_faces{"CellData", "", {}};
  in_faces.arrays.push_back(scalars("K", faces, out.connection.K.data()));
  in_faces.arrays.push_back({"index", "Int32", 1, faces,
                             [&](std::int64_t t, auto& b) { append_binary(b, index[static_cast<std::size_t>(t)]); }});
  for (const FaceScalars& s : out.face_scalars) in_faces.arrays.push_back(scalars(s.name, faces, s.values.data()));

  write_polydata(file, field.n,
                 "NumberOfPoints=\"" + std::to_string(vertices) +
                     "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" +
                     std::to_string(faces) + "\"",
                 {at_points, in_faces, points, polys});
}

void write_singularities(AtomicFile& file, const FieldOutput& out) {
  const auto at = [&](std::int64_t i) -> const Singularity& { return out.singularities[static_cast<std::size_t>(i)]; };
  const auto count = static_cast<std::int64_t>(out.singularities.size());

  Section points{"Points", "", {}};
  points.arrays.push_back({"Points", "Float64", 3, count, [&](std::int64_t i, auto& b) {
                             Eigen::RowVector3d x = Eigen::RowVector3d::Zero();
                             for (int c = 0; c < 3; ++c) {
                               x += at(i).barycentric[static_cast<std::size_t>(c)] *
                                    out.V.row(out.mesh.F()(at(i).face, c));
                             }
                             append_vector(b, x);
                           }});
  Section verts{"Verts", "", {}};
  verts.arrays.push_back({"connectivity", "Int32", 1, count,
                          [](std::int64_t i, auto& b) { append_binary(b, static_cast<std::int32_t>(i)); }});
  verts.arrays.push_back({"offsets", "Int32", 1, count,
                          [](std::int64_t i, auto& b) { append_binary(b, static_cast<std::int32_t>(i + 1)); }});

  Section data{"PointData", " Scalars=\"index\"", {}};
  data.arrays.push_back(
      {"index", "Int32", 1, count, [&](std::int64_t i, auto& b) { append_binary(b, std::int32_t{at(i).index}); }});
  data.arrays.push_back(
      {"orientation", "Float64", 1, count, [&](std::int64_t i, auto& b) { append_binary(b, at(i).orientation); }});
  data.arrays.push_back(
      {"face", "Int32", 1, count, [&](std::int64_t i, auto& b) { append_binary(b, std::int32_t{at(i).face}); }});
  data.arrays.push_back({"barycentric", "Float64", 3, count,
                         [&](std::int64_t i, auto& b) { append_vector(b, at(i).barycentric.data()); }});
  data.arrays.push_back({"located", "UInt8", 1, count,
                         [&](std::int64_t i, auto& b) { append_binary(b, static_cast<std::uint8_t>(at(i).located)); }});

  const std::string number = std::to_string(count);
  write_polydata(file, out.field.n,
                 "NumberOfPoints=\"" + number + "\" NumberOfVerts=\"" + number +
                     "\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\"",
                 {data, points, verts});
}

std::vector<std::filesystem::path> write(FieldJob& job, const Target& target) {
  std::vector<std::int32_t> index(static_cast<std::size_t>(job.out.mesh.faces()), 0);
  for (const Singularity& s : job.out.singularities) index[static_cast<std::size_t>(s.face)] = s.index;

  const std::filesystem::path beside = target.beside("_singularities.vtp");
  AtomicFile surface(target.file), singularities(beside);
  write_surface(surface, job.out, index);
  write_singularities(singularities, job.out);
  surface.commit();
  singularities.commit();
  return {target.file, beside};
}

}  // namespace

const OutputFormat vtp_format = {"vtp", write};

}  // namespace alcap::detail
