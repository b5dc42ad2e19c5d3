// SPDX-License-Identifier: MIT
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "alcap/distributed_output.h"
#include "src/base/array.h"
#include "src/distributed/exchange.h"
#include "src/distributed/meter.h"
#include "src/field/branches.h"
#include "src/io/field/polydata.h"

namespace alcap {
namespace detail::distributed {
namespace {

using namespace polydata;

/// The faces of this rank's slice with their vertices, fetched from whoever has them.
struct PolygonPiece {
  Positions<double> V;
  Faces F;  // in the piece's own numbers
  Field field;
  std::vector<std::int32_t> index;  // per face
};

PolygonPiece make_piece(const MeshSlice& mesh, const DistributedField& all) {
  std::vector<Index> vertices(mesh.F.data(), mesh.F.data() + mesh.F.size());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  using Row = std::array<double, 11>;  // point, axis, normal, u
  std::vector<Row> rows(at(mesh.V.rows()));
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
    Row& row = rows[at(v)];
    for (int c = 0; c < 3; ++c) {
      row[at(c)] = mesh.V(v, c);
      row[at(3 + c)] = all.frames.X(v, c);
      row[at(6 + c)] = all.frames.N(v, c);
    }
    row[9] = all.u[v].real();
    row[10] = all.u[v].imag();
  }
  rows = Exchange(static_cast<Index>(mesh.V.rows()), Slices(mesh.vertices).find(vertices)).fetch(rows);
  const auto count = static_cast<Eigen::Index>(rows.size());
  auto frames = std::make_shared<Frames>(Frames{Positions<double>(count, 3), Positions<double>(count, 3)});
  PolygonPiece piece{Positions<double>(count, 3), mesh.F, {all.n, ComplexVectorX<double>(count), nullptr}, {}};
  for (Eigen::Index v = 0; v < count; ++v) {
    const Row& row = rows[at(v)];
    for (int c = 0; c < 3; ++c) {
      piece.V(v, c) = row[at(c)];
      frames->X(v, c) = row[at(3 + c)];
      frames->N(v, c) = row[at(6 + c)];
    }
    piece.field.u[v] = {row[9], row[10]};
  }
  piece.field.frames = std::move(frames);
  for (Eigen::Index k = 0; k < piece.F.size(); ++k) {
    Index& v = piece.F.data()[k];
    v = static_cast<Index>(std::ranges::lower_bound(vertices, v) - vertices.begin());
  }
  piece.index.assign(at(mesh.F.rows()), 0);
  for (const DistributedSingularity& s : all.singularities)
    if (s.face >= mesh.first_face && s.face < mesh.first_face + mesh.F.rows())
      piece.index[at(s.face - mesh.first_face)] = s.index;
  return piece;
}

std::vector<DataArray> point_arrays(const PolygonPiece& piece, const Branches& branches) {
  const Field& field = piece.field;
  const std::int64_t vertices = field.u.size();
  std::vector<DataArray> arrays;
  for (int k = 0; k < field.n; ++k)
    arrays.push_back(array<double, 3>("d_" + std::to_string(k), vertices, [&, k](std::int64_t v, double* x) {
      put_vector(x, branches.at(field, static_cast<Index>(v)).vector(k));
    }));
  arrays.push_back(
      array<double, 1>("magnitude", vertices, [&](std::int64_t v, double* x) { x[0] = std::abs(field.u[v]); }));
  arrays.push_back(array<double, 2>("u", vertices, [&](std::int64_t v, double* x) {
    x[0] = field.u[v].real();
    x[1] = field.u[v].imag();
  }));
  arrays.push_back(
      array<double, 3>("axis", vertices, [&](std::int64_t v, double* x) { put_vector(x, field.frames->X.row(v)); }));
  arrays.push_back(
      array<double, 3>("normal", vertices, [&](std::int64_t v, double* x) { put_vector(x, field.frames->N.row(v)); }));
  return arrays;
}

std::vector<DataArray> face_arrays(const PolygonPiece& piece, std::int64_t first_face) {
  const auto faces = static_cast<std::int64_t>(piece.F.rows());
  return {array<std::int32_t, 1>("index", faces, [&](std::int64_t t, std::int32_t* x) { x[0] = piece.index[at(t)]; }),
          array<std::uint8_t, 3>("index_rgb", faces,
                                 [&](std::int64_t t, std::uint8_t* x) { put_index_colour(piece.index[at(t)], x); }),
          array<std::int32_t, 1>("face", faces, [first_face](std::int64_t t, std::int32_t* x) {
            x[0] = static_cast<std::int32_t>(first_face + t);
          })};
}

constexpr const char* point_attributes = " Vectors=\"d_0\" Normals=\"normal\"";

void write_piece(AtomicFile& file, const PolygonPiece& piece, std::int64_t first_face) {
  const Branches branches(piece.field.n);
  const auto faces = static_cast<std::int64_t>(piece.F.rows());
  const Section points{"Points", "", {array<double, 3>("Points", piece.V.rows(), [&](std::int64_t v, double* x) {
                         put_vector(x, piece.V.row(v));
                       })}};
  const Section polys{"Polys",
                      "",
                      {array<std::int32_t, 1>("connectivity", 3 * faces,
                                              [&](std::int64_t h, std::int32_t* x) { x[0] = piece.F.data()[h]; }),
                       array<std::int32_t, 1>("offsets", faces, [](std::int64_t t, std::int32_t* x) {
                         x[0] = static_cast<std::int32_t>(3 * (t + 1));
                       })}};
  write_polydata(file, piece.field.n,
                 "NumberOfPoints=\"" + std::to_string(piece.V.rows()) +
                     "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" +
                     std::to_string(faces) + "\"",
                 {{"PointData", point_attributes, point_arrays(piece, branches)},
                  {"CellData", index_colours_shown, face_arrays(piece, first_face)},
                  points,
                  polys});
}

std::string declared(const std::vector<DataArray>& arrays) {
  std::string text;
  for (const DataArray& a : arrays)
    text += "      <PDataArray type=\"" + std::string(a.type) + "\" Name=\"" + a.name + "\" NumberOfComponents=\"" +
            std::to_string(a.components) + "\"/>\n";
  return text;
}

/// `pieces`: names of files in the folder of the .pvtp.
std::string index_of_pieces(const PolygonPiece& like, const std::vector<std::string>& pieces) {
  const Branches branches(like.field.n);
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PPolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n  <PPolyData GhostLevel=\"0\">\n";
  text += "    <PPointData" + std::string(point_attributes) + ">\n" + declared(point_arrays(like, branches)) +
          "    </PPointData>\n    <PCellData" + std::string(index_colours_shown) + ">\n" +
          declared(face_arrays(like, 0)) + "    </PCellData>\n";
  text += "    <PPoints>\n      <PDataArray type=\"Float64\" NumberOfComponents=\"3\"/>\n    </PPoints>\n";
  for (const std::string& name : pieces) text += "    <Piece Source=\"" + escaped(name) + "\"/>\n";
  return text + "  </PPolyData>\n</VTKFile>\n";
}

}  // namespace
}  // namespace detail::distributed

void write_distributed_pvtp(const std::string& path, const MeshSlice& mesh, DistributedField& field) {
  using namespace detail;
  using namespace detail::distributed;
  const petsc::Session session;
  Meter meter;
  const PolygonPiece piece = make_piece(mesh, field);
  const std::filesystem::path target(path);
  const auto name_of = [&](int r) { return target.stem().string() + "_" + std::to_string(r) + ".vtp"; };
  std::optional<AtomicFile> file;
  agreed([&] {
    if (mesh.F.rows() == 0) return;
    file.emplace(target.parent_path() / name_of(rank()));
    write_piece(*file, piece, mesh.first_face);
    file->complete();
  });
  agreed([&] {
    if (file) file->commit();
  });
  on_first_rank([&] {
    std::vector<std::string> pieces;
    for (int r = 0; r < ranks(); ++r)
      if (slice_begin(mesh.faces, r + 1, ranks()) > slice_begin(mesh.faces, r, ranks())) pieces.push_back(name_of(r));
    AtomicFile index(target);
    index.write(index_of_pieces(piece, pieces));
    index.commit();
  });
  meter.done("write pieces", field.phases);
}

}  // namespace alcap
