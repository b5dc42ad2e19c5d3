// SPDX-License-Identifier: MIT
//
// test_element_tables.cpp: directions and frames of faces and vertices as .csv, .npy and .dmat, and numbers of
// vertices, found again by readers that know only the formats' own rules. NumPy itself reads .npy in the tests of the
// Python package.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <sstream>

#include "tests/io/output_fixture.h"

namespace {

using namespace alcap;
using namespace alcap::test;
using Table = Eigen::MatrixXd;

// A line of names, then numbers between commas; the first column counts.
Table read_csv(const fs::path& path, std::string& names) {
  std::istringstream in(contents(path));
  std::getline(in, names);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(in, line);) {
    std::istringstream cells(line);
    std::vector<double> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    CHECK(row.at(0) == double(rows.size()));
    rows.emplace_back(row.begin() + 1, row.end());
  }
  Table table(rows.size(), rows.empty() ? 0 : rows[0].size());
  for (Eigen::Index i = 0; i < table.rows(); ++i) {
    REQUIRE(std::int64_t(rows[std::size_t(i)].size()) == table.cols());
    for (Eigen::Index j = 0; j < table.cols(); ++j) table(i, j) = rows[std::size_t(i)][std::size_t(j)];
  }
  return table;
}

// Format 1.0: magic, version, two bytes of length, a dictionary that ends with a newline, all a multiple of 64.
Table read_npy(const fs::path& path) {
  const std::string bytes = contents(path);
  REQUIRE(bytes.substr(0, 8) == std::string("\x93NUMPY\x01\x00", 8));
  const std::size_t head =
      10 + static_cast<unsigned char>(bytes[8]) + 256 * std::size_t(static_cast<unsigned char>(bytes[9]));
  CHECK(head % 64 == 0);
  CHECK(bytes[head - 1] == '\n');
  long long rows = 0, columns = 1;
  const std::string text = bytes.substr(10, head - 10);
  CHECK(text.find("'descr': '<f8'") != std::string::npos);
  CHECK(text.find("'fortran_order': False") != std::string::npos);
  REQUIRE(std::sscanf(text.c_str() + text.find('('), "(%lld, %lld)", &rows, &columns) >= 1);
  REQUIRE(bytes.size() == head + std::size_t(rows * columns) * sizeof(double));
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> table(rows, columns);
  std::memcpy(table.data(), bytes.data() + head, bytes.size() - head);
  return table;
}

// As igl::readDMAT does: "%d %d" of columns and rows and one byte; both 0 say that a second head and doubles follow,
// column by column.
Table read_dmat(const fs::path& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  int columns = -1, rows = -1;
  char end = 0;
  const auto head = [&] {
    REQUIRE(std::fscanf(file.get(), "%d %d", &columns, &rows) == 2);
    REQUIRE(std::fread(&end, 1, 1, file.get()) == 1);
    REQUIRE(end == '\n');
  };
  head();
  REQUIRE(columns == 0);
  REQUIRE(rows == 0);
  head();
  Table table(rows, columns);
  REQUIRE(std::fread(table.data(), sizeof(double), std::size_t(table.size()), file.get()) == std::size_t(table.size()));
  CHECK(std::fread(&end, 1, 1, file.get()) == 0);
  return table;
}

// Row i against the field and the geometry: an orthonormal right-handed frame whose e1 is the principal direction.
void check_row(const Table& table, Index i, const Field& field, const Eigen::RowVector3d& position) {
  const Eigen::RowVector3d at = table.block<1, 3>(i, 0), e1 = table.block<1, 3>(i, 3), e2 = table.block<1, 3>(i, 6),
                           e3 = table.block<1, 3>(i, 9);
  CHECK((at - position).norm() < 1e-14);
  CHECK((e3 - field.frames->N.row(i)).norm() < 1e-14);
  CHECK((e2 - e3.cross(e1)).norm() < 1e-14);
  CHECK(e1.norm() == doctest::Approx(1));
  CHECK(std::abs(e1.dot(e3)) < 1e-12);
  const double length = table(i, 13);
  const Complex<double> z = field.frames->component(i, e1 * length);
  CHECK(std::abs(std::pow(z, field.n) - field.u[i]) <= 1e-11 * std::abs(field.u[i]));
  const Complex<double> turned = std::polar(1.0, table(i, 12) * pi<double> / 180);
  CHECK(std::abs(field.frames->component(i, e1) - turned) < 1e-12);
}

}  // namespace

TEST_CASE("tables of faces and vertices: frames along the field, the same numbers in every format, bit for bit") {
  const Folder folder;
  for (const int n : {1, 2, 4}) {
    Case c(with_unreferenced(noisy_scan(3, 0.2, 8)), n);
    c.randomise(5);
    const FieldOutput output = c.output();
    for (const std::string kind : {"", "vertex."}) {
      std::vector<fs::path> files;
      for (const char* extension : {"csv", "npy", "dmat"}) files.push_back(folder.path / ("f." + kind + extension));
      CHECK(write_field(output, files) == files);
      std::string names;
      const Table table = read_csv(files[0], names);
      CHECK(names == (kind.empty() ? "face" : "vertex") +
                         std::string(",x,y,z,e1_x,e1_y,e1_z,e2_x,e2_y,e2_z,e3_x,e3_y,e3_z,theta,length"));
      CHECK(read_npy(files[1]) == table);
      CHECK(read_dmat(files[2]) == table);
      const Field field = kind.empty() ? at_faces(output.surface, c.field) : c.field;
      REQUIRE(table.rows() == field.u.size());
      for (Index i = 0; i < field.u.size(); ++i) {
        const Eigen::RowVector3d corner = c.surface.V.row(kind.empty() ? c.surface.F(i, 0) : i);
        if (kind.empty()) {
          const Eigen::RowVector3d sum =
              corner + c.surface.V.row(c.surface.F(i, 1)) + c.surface.V.row(c.surface.F(i, 2));
          check_row(table, i, field, sum / 3);
        } else if (c.mesh.referenced(i)) {
          check_row(table, i, field, corner);
        } else {
          CHECK(table.row(i).tail(11).norm() == 0);
        }
      }
    }
  }
}

TEST_CASE("theta of a face is the angle from its first edge, as material angles of shells are counted") {
  const Folder folder;
  Case c(grid(6, 4), 1);
  Positions<double> constant = Positions<double>::Zero(c.mesh.vertices(), 3);
  constant.col(0).setConstant(3);
  c.field = from_vectors(1, constant, c.field.frames);
  write_field(c.output(), folder.path / "f.npy");
  const Table table = read_npy(folder.path / "f.npy");
  for (Index t = 0; t < c.mesh.faces(); ++t) {
    const Eigen::RowVector3d edge = c.surface.V.row(c.surface.F(t, 1)) - c.surface.V.row(c.surface.F(t, 0));
    const double expected = -std::atan2(edge[1], edge[0]) * 180 / pi<double>;
    CHECK(std::abs(std::remainder(table(t, 12) - expected, 360)) < 1e-9);
    CHECK(table(t, 13) == doctest::Approx(3));
  }
}

TEST_CASE("a zero has length 0 and still a frame; unit fields have length 1 in every face") {
  const Folder folder;
  Case c(icosphere(2), 4);
  const Index t = 7;
  c.randomise(2);
  for (int k = 0; k < 3; ++k) c.field.u[c.mesh.F()(t, k)] = 0;
  c.singularities.clear();
  FieldOutput output = c.output();
  write_field(output, folder.path / "f.npy");
  Table table = read_npy(folder.path / "f.npy");
  CHECK(table(t, 13) == 0);
  CHECK(table(t, 12) == 0);
  CHECK(table.block<1, 3>(t, 3).norm() == doctest::Approx(1));
  output.unit = true;
  write_field(output, folder.path / "f.npy");
  table = read_npy(folder.path / "f.npy");
  CHECK((table.col(13).array() - 1).abs().maxCoeff() < 1e-12);
}

TEST_CASE("binary files are usual; text and tables are written on request") {
  const std::vector<std::string> all = field_formats(), usual = usual_field_formats();
  CHECK(usual == std::vector<std::string>{"ply", "vtp"});
  CHECK(std::set<std::string>(all.begin(), all.end()).size() == all.size());
  for (const std::string& format : usual) CHECK(std::count(all.begin(), all.end(), format) == 1);
}

TEST_CASE("numbers of vertices come back from every format bit for bit") {
  const Folder folder;
  VectorX<double> values(5);
  values << 1, 1.0 / 3, 1e-300, 0, 12345.678;
  for (const std::string& format : scalar_formats()) write_scalars(values, "h", folder.path / ("h." + format));
  std::string names;
  CHECK(read_csv(folder.path / "h.csv", names) == values);
  CHECK(names == "vertex,h");
  CHECK(read_npy(folder.path / "h.npy") == values);
  CHECK(read_dmat(folder.path / "h.dmat") == values);
  // Medit: keywords and numbers between blanks; one scalar (type 1) per vertex.
  std::istringstream in(contents(folder.path / "h.sol"));
  std::string version, dimension, at_vertices, end;
  int v = 0, d = 0, count = 0, solutions = 0, type = 0;
  in >> version >> v >> dimension >> d >> at_vertices >> count >> solutions >> type;
  CHECK(version == "MeshVersionFormatted");
  CHECK(dimension == "Dimension");
  CHECK(at_vertices == "SolAtVertices");
  CHECK(v == 2);
  CHECK(d == 3);
  CHECK(solutions == 1);
  CHECK(type == 1);
  REQUIRE(count == 5);
  for (Eigen::Index i = 0; i < 5; ++i) {
    std::string text;
    in >> text;
    CHECK(std::stod(text) == values[i]);
  }
  in >> end;
  CHECK(end == "End");
  CHECK_THROWS_AS(write_scalars(values, "h", folder.path / "h.vtp"), FileError);
  values[2] = std::nan("");
  CHECK_THROWS_AS(write_scalars(values, "h", folder.path / "bad.csv"), OptionError);
  CHECK_FALSE(fs::exists(folder.path / "bad.csv"));
}
