// SPDX-License-Identifier: MIT
//
// vtp.cpp: VTK's XML PolyData with raw appended data: the surface with the field, and beside it the singularities as
// points. Field data "n" holds the number of branches.
#include "src/field/branches.h"
#include "src/io/field/format.h"
#include "src/io/field/polydata.h"

namespace alcap::detail {
namespace {

using namespace polydata;

DataArray scalars(std::string name, std::int64_t rows, const double* values) {
  return array<double, 1>(std::move(name), rows, [values](std::int64_t i, double* x) { x[0] = values[i]; });
}

DataArray vectors(std::string name, const Positions<double>& rows) {
  return array<double, 3>(std::move(name), rows.rows(),
                          [&rows](std::int64_t i, double* x) { put_vector(x, rows.row(i)); });
}

void write_surface(AtomicFile& file, const FieldOutput& out, const std::vector<std::int32_t>& index) {
  const Field& field = out.field;
  const Branches branches(field.n);
  const std::int64_t vertices = out.surface.mesh().vertices(), faces = out.surface.mesh().faces();

  const Section points{"Points", "", {vectors("Points", out.surface.V())}};
  const Section polys{"Polys",
                      "",
                      {whole_numbers("connectivity", 3 * faces, vertices,
                                     [&](std::int64_t h) { return out.surface.mesh().tail(static_cast<Index>(h)); }),
                       whole_numbers("offsets", faces, 3 * faces, [](std::int64_t t) { return 3 * (t + 1); })}};

  Section at_points{"PointData", " Vectors=\"d_0\" Normals=\"normal\"", {}};
  for (int k = 0; k < field.n; ++k) {
    at_points.arrays.push_back(
        array<double, 3>("d_" + std::to_string(k), vertices, [&branches, &field, k](std::int64_t v, double* x) {
          put_vector(x, branches.at(field, static_cast<Index>(v)).vector(k));
        }));
  }
  at_points.arrays.push_back(
      array<double, 1>("magnitude", vertices, [&](std::int64_t v, double* x) { x[0] = std::abs(field.u[v]); }));
  at_points.arrays.push_back(array<double, 2>("u", vertices, [&](std::int64_t v, double* x) {
    x[0] = field.u[v].real();
    x[1] = field.u[v].imag();
  }));
  at_points.arrays.push_back(vectors("axis", field.frames->X));
  at_points.arrays.push_back(vectors("normal", field.frames->N));

  Section in_faces{"CellData", index_colours_shown, {}};
  in_faces.arrays.push_back(scalars("K", faces, out.surface.connection().K.data()));
  in_faces.arrays.push_back(array<std::int32_t, 1>(
      "index", faces, [&](std::int64_t t, std::int32_t* x) { x[0] = index[static_cast<std::size_t>(t)]; }));
  in_faces.arrays.push_back(array<std::uint8_t, 3>("index_rgb", faces, [&](std::int64_t t, std::uint8_t* x) {
    put_index_colour(index[static_cast<std::size_t>(t)], x);
  }));
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
  const auto counting = [&](std::string name, std::int64_t from) {
    return whole_numbers(std::move(name), count, count, [from](std::int64_t i) { return from + i; });
  };

  const Section points{"Points", "", {array<double, 3>("Points", count, [&](std::int64_t i, double* x) {
                         put_vector(x, position(out.surface, at(i)));
                       })}};
  const Section verts{"Verts", "", {counting("connectivity", 0), counting("offsets", 1)}};
  const Section data{
      "PointData",
      index_colours_shown,
      {array<std::int32_t, 1>("index", count, [&](std::int64_t i, std::int32_t* x) { x[0] = at(i).index; }),
       array<std::uint8_t, 3>("index_rgb", count,
                              [&](std::int64_t i, std::uint8_t* x) { put_index_colour(at(i).index, x); }),
       array<double, 1>("orientation", count, [&](std::int64_t i, double* x) { x[0] = at(i).orientation; }),
       whole_numbers("face", count, out.surface.mesh().faces(), [&](std::int64_t i) { return at(i).face; }),
       array<double, 3>("barycentric", count,
                        [&](std::int64_t i, double* x) { put_vector(x, at(i).barycentric.data()); }),
       array<std::uint8_t, 1>("located", count,
                              [&](std::int64_t i, std::uint8_t* x) { x[0] = at(i).located ? 1 : 0; })}};

  const std::string number = std::to_string(count);
  write_polydata(file, out.field.n,
                 "NumberOfPoints=\"" + number + "\" NumberOfVerts=\"" + number +
                     "\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\"",
                 {data, points, verts});
}

WrittenFiles write_vtp(const FieldJob& job, const Target& target) {
  std::vector<std::int32_t> index(static_cast<std::size_t>(job.out.surface.mesh().faces()), 0);
  for (const Singularity& s : job.out.singularities) index[static_cast<std::size_t>(s.face)] = s.index;

  WrittenFiles files = open_files({target.file, target.beside("_singularities.vtp")});
  write_surface(*files[0], job.out, index);
  write_singularities(*files[1], job.out);
  return files;
}

}  // namespace

const OutputFormat vtp_format = {"vtp", false, write_vtp};

}  // namespace alcap::detail
