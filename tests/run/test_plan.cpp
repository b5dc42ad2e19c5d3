// SPDX-License-Identifier: MIT
//
// What is planned is what happens: counts of real meshes, sizes of written files, memory of a run; and meshes beyond
// 2^31 half-edges, without the memory for them: refused everywhere by the same rule, before an index is computed.
#include <doctest/doctest.h>
#include <sys/mman.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "alcap/assembly.h"
#include "alcap/field_run.h"
#include "alcap/generators.h"
#include "alcap/mesh_check.h"
#include "alcap/mesh_io.h"
#include "alcap/output.h"
#include "alcap/plan.h"
#include "src/base/limits.h"
#include "tests/support/folder.h"

using namespace alcap;

namespace {

#ifndef ALCAP_INDEX_64
/// Addresses for so many faces, without memory: reading one ends the program.
class Nowhere {
 public:
  explicit Nowhere(std::int64_t faces) : bytes_(static_cast<std::size_t>(faces) * 3 * sizeof(Index)) {
    at_ = ::mmap(nullptr, bytes_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    REQUIRE(at_ != MAP_FAILED);
  }
  Nowhere(const Nowhere&) = delete;
  Nowhere& operator=(const Nowhere&) = delete;
  ~Nowhere() { ::munmap(at_, bytes_); }
  [[nodiscard]] const Index* data() const { return static_cast<const Index*>(at_); }

 private:
  std::size_t bytes_;
  void* at_ = nullptr;
};
#endif

template <class Call>
std::string refusal(Call&& call) {
  try {
    static_cast<void>(call());
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

}  // namespace

TEST_CASE("counts are those of real meshes") {
  for (const MeshData& s : {icosphere(3), torus(20, 12, 1, 0.4), genus_surface(2, 2)}) {
    const Mesh mesh(s.F, s.V.rows());
    const RunPlan plan = plan_field({.faces = s.F.rows(), .vertices = s.V.rows()});
    CHECK(plan.halfedges == mesh.halfedges());
    CHECK(plan.edges == mesh.edges());
    CHECK(plan.matrix_entries == HermitianPattern(mesh).nonzeros());
    CHECK(plan.refusals.empty());
  }
  CHECK(plan_field({.faces = icosphere(3).F.rows()}).matrix_entries ==
        plan_field({.faces = icosphere(3).F.rows(), .vertices = icosphere(3).V.rows()}).matrix_entries);
}

#ifndef ALCAP_INDEX_64  // with 64 bits they are accepted, see test_index_width.cpp
TEST_CASE("half-edges beyond 2^31 are refused by one rule, by every door, unread") {
  constexpr std::int64_t most = detail::most_faces, beyond = most + 1;
  // The last halfedge has a number, and so has the one after it; one face more and it had none.
  static_assert(3 * most - 1 <= std::numeric_limits<Index>::max() &&
                3 * beyond - 1 > std::numeric_limits<Index>::max());
  constexpr auto last = static_cast<Index>(3 * most - 1);
  CHECK(Mesh::next(last) == last - 2);
  CHECK(Mesh::next(last - 1) == last);
  CHECK(Mesh::prev(last - 2) == last);

  const Nowhere nowhere(beyond);
  const Eigen::Map<const Faces> F(nowhere.data(), beyond, 3);
  const std::vector<DefectReport> defects = find_defects(F, 3);
  REQUIRE(!defects.empty());
  CHECK(defects.front().defect == Defect::index_out_of_range);
  CHECK(defects.front().count == beyond);
  CHECK(defects.front().message.find(std::to_string(most)) != std::string::npos);

  for (const std::int64_t faces : {beyond, std::int64_t{1} << 31, std::int64_t{10'000'000'000}}) {
    CAPTURE(faces);
    const RunPlan plan = plan_field({.faces = faces, .memory = std::int64_t{1} << 60});
    CHECK(plan.halfedges == 3 * faces);
    CHECK(plan.matrix_entries == faces / 2 + 2 + 2 * ((3 * faces + 1) / 2));
    CHECK(!plan.fits());
    CHECK(plan.refusals.front().starts_with(std::to_string(faces) + " faces"));
  }
  // Matrices end earlier: 3.5 entries per triangle of a closed surface.
  const auto refused = [](std::int64_t faces) {
    return plan_field({.faces = faces, .memory = std::int64_t{1} << 60}).refusals;
  };
  constexpr std::int64_t closed = (detail::most_entries - 2) * 2 / 7;
  CHECK(refused(closed - closed % 2).empty());
  CHECK(refused(closed + 4).size() == 1);
  CHECK(refused(closed + 4).front().find("matrix entries") != std::string::npos);
}
#endif

TEST_CASE("a file that announces more faces than can be numbered is refused from its header") {
  const test::Folder folder;
  const auto path = folder.path / "huge.ply";
  std::ofstream(path) << "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                         "property float z\nelement face 3000000000\nproperty list uchar int vertex_indices\n"
                         "end_header\n"
                      << std::string(36, '\0');
  CHECK(refusal([&] { return read_mesh(path); }).find("3000000000") != std::string::npos);
}

TEST_CASE("files take the disk that was planned") {
  const MeshData s = jittered_sphere(4, 0.2, 1);
  const test::Folder folder;
  for (const int n : {1, 4}) {
    const FieldRun run = run_field(s.V, s.F, {.n = n});
    for (const std::string format : {"ply", "vtp", "rosy", "rawfield"}) {
      CAPTURE(n);
      CAPTURE(format);
      double bytes = 0;
      for (const auto& file :
           write_field({.surface = run.surface, .field = run.field, .singularities = run.singularities},
                       folder.path / ("field." + format)))
        bytes += static_cast<double>(std::filesystem::file_size(file));
      const RunPlan plan = plan_field({.faces = s.F.rows(), .vertices = s.V.rows(), .n = n, .formats = {format}});
      CHECK(bytes == doctest::Approx(plan.disk).epsilon(0.05));
    }
  }
}

TEST_CASE("the plan adds up, and grows with the mesh") {
  const RunPlan small = plan_field({.faces = 1'000'000, .threads = 1}),
                large = plan_field({.faces = 8'000'000, .threads = 1});
  double seconds = 0, bytes = 0;
  for (const PhasePlan& phase : large.phases) {
    seconds += phase.seconds;
    bytes = std::max(bytes, phase.bytes);
  }
  CHECK(seconds == doctest::Approx(large.seconds));
  CHECK(bytes == large.bytes);
  CHECK(large.seconds == doctest::Approx(8 * small.seconds));
  CHECK(large.most_bytes > large.bytes);
  CHECK(large.factor_bytes > 8 * small.factor_bytes);
  CHECK(plan_field({.faces = 8'000'000, .threads = 1, .speed = 2}).seconds == doctest::Approx(large.seconds / 2));
  const RunPlan tight = plan_field({.faces = 8'000'000, .memory = 1'000'000'000});
  CHECK(!tight.fits());
  CHECK(plan_field({.faces = tight.largest, .memory = 1'000'000'000}).fits());
  CHECK(!plan_field({.faces = tight.largest + 10, .memory = 1'000'000'000}).fits());
  CHECK(relative_speed() > 0);
  for (const PlanOptions& bad :
       {PlanOptions{}, PlanOptions{.faces = 10, .n = 0}, PlanOptions{.faces = 10, .speed = 0},
        PlanOptions{.faces = 10, .formats = {"gif"}}, PlanOptions{.faces = 10, .vertices = -1},
        PlanOptions{.faces = 10, .threads = -1}, PlanOptions{.faces = std::numeric_limits<std::int64_t>::max()}})
    CHECK_THROWS_AS(static_cast<void>(plan_field(bad)), OptionError);
}
