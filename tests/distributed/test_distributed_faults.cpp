// SPDX-License-Identifier: MIT
//
// What is wrong is said once, in users' numbers, and thrown on every rank alike.
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "alcap/mesh_io.h"
#include "alcap/output.h"
#include "tests/distributed/ranks_fixture.h"

using namespace alcap;
using namespace alcap::test;

namespace {

template <class E, class Body>
std::string thrown(Body&& body) {
  try {
    body();
  } catch (const E& e) {
    return e.what();
  }
  return "";
}

/// A folder that all ranks see.
struct SharedFolder {
  SharedFolder() {
    path = std::filesystem::temp_directory_path() / ("alcap_distributed_" + std::to_string(::getppid()));
    on_first_rank([&] { std::filesystem::create_directories(path); });
  }
  ~SharedFolder() {
    on_first_rank([] {});  // all have come here
    on_first_rank([&] { std::filesystem::remove_all(path); });
  }
  [[nodiscard]] std::string operator/(const char* name) const { return (path / name).string(); }
  std::filesystem::path path;
};

void write_text_file(const std::string& path, const std::string& text) {
  on_first_rank([&] { std::ofstream(path, std::ios::binary) << text; });
}

}  // namespace

TEST_CASE("defects of meshes are named as one machine names them") {
  const MeshData good = bumpy_sphere(3, 0.3, 4);
  const auto check = [&](const MeshData& bad, Defect defect) {
    try {
      (void)distributed_field(slice_of(bad.V, bad.F), {.connection = {ConnectionKind::polar}});
      FAIL("no error");
    } catch (const MeshError& e) {
      CHECK(name(e.defect()) == name(defect));
      try {
        const Mesh mesh(bad.F, bad.V.rows());
        const Geometry geometry(mesh, bad.V);
        FAIL("one machine takes it");
      } catch (const MeshError& one) {
        CHECK(name(one.defect()) == name(e.defect()));
        CHECK(one.first() == e.first());
        CHECK(one.count() == e.count());
      }
    }
  };
  MeshData bad = good;
  bad.F.conservativeResize(bad.F.rows() + 1, 3);
  bad.V.conservativeResize(bad.V.rows() + 1, 3);
  bad.V.bottomRows(1).setConstant(3);
  bad.F.bottomRows(1) << bad.F(500, 0), bad.F(500, 1), static_cast<Index>(bad.V.rows() - 1);  // a third face
  check(bad, Defect::non_manifold_edge);

  bad = good;
  bad.F.row(700) = Eigen::RowVector3i(bad.F(700, 1), bad.F(700, 0), bad.F(700, 2));
  try {
    (void)distributed_field(slice_of(bad.V, bad.F));
    FAIL("no error");
  } catch (const MeshError& e) {
    CHECK(e.defect() == Defect::inconsistent_orientation);
    CHECK(e.count() == 3);
  }

  bad = side_by_side({good, good});  // touch in a vertex
  const auto second = static_cast<Index>(good.V.rows());
  for (Eigen::Index k = 0; k < bad.F.size(); ++k)
    if (bad.F.data()[k] == second) bad.F.data()[k] = 17;
  check(bad, Defect::non_manifold_vertex);

  bad = good;
  bad.F(33, 1) = bad.F(33, 0);
  check(bad, Defect::repeated_vertex_in_face);

  bad = good;
  bad.V.row(bad.F(900, 0)) = bad.V.row(bad.F(900, 1));
  check(bad, Defect::zero_length_edge);

  bad = good;
  bad.F(33, 1) = static_cast<Index>(good.V.rows());
  check(bad, Defect::index_out_of_range);
}

TEST_CASE("options") {
  const MeshData good = icosphere(2);
  const MeshSlice slice = slice_of(good.V, good.F);
  CHECK_THROWS_AS((void)distributed_field(slice, {.n = 0}), OptionError);
  CHECK_THROWS_AS((void)distributed_field(slice, {.s = 2}), OptionError);
  CHECK_THROWS_AS((void)distributed_field(slice, {.tolerance = 0}), OptionError);
  CHECK_THROWS_AS((void)distributed_field(slice, {.connection = {ConnectionKind::trivial}}), OptionError);
}

TEST_CASE("files that cannot be read") {
  const SharedFolder folder;
  CHECK(thrown<FileError>([&] { (void)read_mesh_slice(folder / "none.ply"); }).find("no such file") !=
        std::string::npos);
  CHECK(thrown<FileError>([&] { (void)read_mesh_slice(folder.path.string()); }).find("folder") != std::string::npos);
  const std::string head =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float "
      "y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string points(36, '\0');
  const auto complaint = [&](const std::string& text) {
    write_text_file(folder / "bad.ply", text);
    return thrown<FileError>([&] { (void)read_mesh_slice(folder / "bad.ply"); });
  };
  CHECK(complaint("").find("empty") != std::string::npos);
  CHECK(complaint("solid\n").find("no PLY") != std::string::npos);
  CHECK(complaint(head).find("cut") != std::string::npos);
  CHECK(complaint(head + points + std::string("\4") + std::string(16, '\0')).find("4 corners") != std::string::npos);
  const auto of_size = [&](const std::string& faces) {
    std::string text = head;
    return complaint(text.replace(text.find("face 1"), 6, "face " + faces));
  };
  CHECK(of_size("2147483647").find("was cut") != std::string::npos);
  CHECK(of_size("2147483648").find("can be numbered") != std::string::npos);
  const std::string wild = std::string("\3") + std::string(8, '\0') + std::string("\7\0\0\0", 4);
  CHECK(complaint(head + points + wild).find("names vertex 7") != std::string::npos);
  std::string nan = points;
  nan.replace(12, 4, std::string("\0\0\xC0\x7F", 4));
  CHECK(complaint(head + nan + std::string("\3") + std::string(12, '\0')).find("not finite") != std::string::npos);
}

TEST_CASE("files are read and written in the users' numbering") {
  const SharedFolder folder;
  const MeshData data = noisy_scan(3, 0.3, 11);
  on_first_rank([&] { write_mesh(folder / "mesh.ply", data.V, data.F); });
  const MeshSlice read = read_mesh_slice(folder / "mesh.ply"), slice = slice_of(data.V, data.F);
  CHECK(read.vertices == slice.vertices);
  CHECK(read.first_face == slice.first_face);
  CHECK(read.V == slice.V);
  CHECK(read.F == slice.F);
  DistributedField all = distributed_field(read, {.n = 2, .gather_below = 100});
  write_distributed_ply(folder / "field.ply", read, all);
  const FieldFile back = read_field(folder / "field.ply");
  CHECK(back.V == data.V);
  CHECK(back.F == data.F);
  CHECK(back.field.n == 2);
  CHECK(ComplexVectorX<double>(back.field.u.segment(slice.first_vertex, all.u.size())) == all.u);
  CHECK(Positions<double>(back.field.frames->X.middleRows(slice.first_vertex, all.u.size())) == all.frames.X);
  CHECK(all.phases.back().name == "write");
}

TEST_CASE("outputs that cannot be written leave nothing behind") {
  const SharedFolder folder;
  const MeshData data = icosphere(3);
  const MeshSlice slice = slice_of(data.V, data.F);
  DistributedField all = distributed_field(slice);
  const std::string no_folder = folder / "none/field.ply", full = folder / "field.ply";
  CHECK(thrown<FileError>([&] { write_distributed_ply(no_folder, slice, all); }).find("folder does not exist") !=
        std::string::npos);
  // A disk that takes a thousand bytes a file.
  rlimit before = {};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small = {1000, before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  const std::string message = thrown<FileError>([&] { write_distributed_ply(full, slice, all); });
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  CHECK(message.find("field.ply") != std::string::npos);
  CHECK(message.find("failed") != std::string::npos);
  on_first_rank([&] { CHECK(std::filesystem::is_empty(folder.path)); });
}
