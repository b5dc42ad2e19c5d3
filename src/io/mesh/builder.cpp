// SPDX-License-Identifier: MIT
//
// builder.cpp: from vertices and faces in file order to a MeshFile.
#include "src/io/mesh/builder.h"

#include <algorithm>
#include <utility>

#include "src/base/array.h"
#include "src/base/limits.h"
#include "src/base/numbers.h"
#include "src/io/mesh/tokenizer.h"
#include "src/io/mesh/triangulate.h"

namespace alcap::detail {
namespace {

constexpr std::int64_t first_rows = 1024;  // doubled whenever they run out

std::string too_many(const char* what) { return "more than " + std::to_string(most_numbered) + " " + what; }

std::string numbered(const char* what, std::int64_t number) {
  return std::string(what) + " " + std::to_string(number) + " (counted from 0)";
}

}  // namespace

std::string Builder::next_vertex() const { return numbered("vertex", vertices_); }
std::string Builder::next_face() const { return numbered("face", faces_); }

void Builder::told(const char* where) const {
  report_phase("read", static_cast<double>(where - source_.begin()) / static_cast<double>(source_.bytes.size()));
}

void Builder::grow_vertices() {
  if (vertices_ >= most_numbered) fail(source_, too_many("vertices"));
  V_.conservativeResize(std::max(first_rows, 2 * vertices_), 3);
}

void Builder::grow_faces() {
  if (faces_ >= most_numbered) fail(source_, too_many("faces"));
  F_.conservativeResize(std::max(first_rows, 2 * faces_), 3);
}

void Builder::ignore(std::string_view kind, std::int64_t count) {
  const auto known = std::ranges::find(ignored_, kind, &MeshFile::Ignored::kind);
  if (known != ignored_.end()) {
    known->count += count;
  } else {
    ignored_.push_back({std::string(kind), count});
  }
}

void Builder::fail_index(std::int64_t v, std::int64_t face, const char* where) const {
  std::string message = numbered("face", face) + " names vertex " + std::to_string(v) + " (counted from 0), ";
  message += v < 0 ? "which is before the first one" : "but there are " + std::to_string(vertices_) + " vertices";
  fail_at(source_, where, message + "; the file was cut or its indices are off");
}

void Builder::polygon(std::span<const std::int64_t> corners, const char* where) {
  if (corners.size() < 3) {  // keeps its number, and has no triangle
    if (short_faces_++ == 0) {
      first_short_ = next_face() + " has " + std::to_string(corners.size()) + " corners; a face needs three";
      first_short_where_ = where;
    }
    corners = {};
  }
  if (corners.size() > 3 && options_.polygons == ReadOptions::Polygons::refuse) {
    fail_at(source_, where,
            next_face() + " has " + std::to_string(corners.size()) +
                " corners and polygons are refused; triangulate the mesh, or let the reader do it");
  }
  tick(faces_, where);
  if (faces_ >= most_numbered) fail(source_, too_many("faces"));
  if (!polygonal()) {  // the first polygon: triangles so far become polygons of three corners
    corners_.assign(F_.data(), F_.data() + 3 * faces_);
    for (std::int64_t f = 0; f < faces_; ++f) starts_.push_back(at(3 * f));
    places_.assign(at(faces_), where);
    F_.resize(0, 3);
  }
  starts_.push_back(corners_.size());
  places_.push_back(where);
  for (const std::int64_t v : corners) corners_.push_back(checked(v, where));
  ++faces_;
}

void Builder::triangulate_all(MeshFile& mesh) const {
  const std::size_t triangles = corners_.size() - 2 * (starts_.size() - at(short_faces_));
  if (triangles > at(most_numbered)) fail(source_, too_many("triangles"));
  mesh.F.resize(static_cast<Eigen::Index>(triangles), 3);
  mesh.polygon_of.resize(triangles);
  std::vector<Index> local;
  std::size_t row = 0;
  for (std::size_t f = 0; f < starts_.size(); ++f) {
    check_cancelled_at(static_cast<std::int64_t>(f));
    const std::size_t stop = f + 1 < starts_.size() ? starts_[f + 1] : corners_.size();
    const std::span<const Index> corners(corners_.data() + starts_[f], stop - starts_[f]);
    if (corners.empty()) continue;
    local.clear();
    if (!triangulate(mesh.V, corners, local)) {
      fail_at(source_, places_[f],
              numbered("face", static_cast<std::int64_t>(f)) + " has " + std::to_string(corners.size()) +
                  " corners, is not convex, and is too large or crosses itself; triangulate it before");
    }
    for (std::size_t i = 0; i < local.size(); i += 3, ++row) {
      for (std::size_t c = 0; c < 3; ++c) {
        mesh.F(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(c)) = corners[at(local[i + c])];
      }
      mesh.polygon_of[row] = static_cast<Index>(f);
    }
  }
}

// Vertices without a position that no face uses get one that is there already.
void Builder::place_nowhere(MeshFile& mesh) {
  if (nowhere_.empty()) return;
  std::vector<bool> used(at(mesh.V.rows()), false);
  for (Eigen::Index t = 0; t < mesh.F.rows(); ++t)
    for (int c = 0; c < 3; ++c) used[at(mesh.F(t, c))] = true;
  const Index somewhere = mesh.F(0, 0);
  for (const auto& [v, where] : nowhere_) {
    if (used[at(v)]) {
      const std::string what = "coordinate of " + numbered("vertex", v);
      if (source_.binary_from != nullptr && where >= source_.binary_from)
        fail_at(source_, where, what + " is not a finite number (or not whole where it must be)");
      Tokenizer in(source_, where);
      double x = 0;
      for (int c = 0; c < 3 && in.next_token() && in.real(x); ++c) {
      }
      in.fail_number(what);
    }
    mesh.V.row(v) = mesh.V.row(somewhere);
  }
  remarks_.push_back(counted(count_of(nowhere_), "vertex that no face uses has", "vertices that no face uses have") +
                     " coordinates that are not finite; placed at vertex " + std::to_string(somewhere));
}

void Builder::take_edges(MeshFile& mesh) {
  const auto known = [&](std::int64_t v) { return v >= 0 && v < vertices_; };
  std::int64_t lost = 0;
  for (const auto& [i, j] : edges_) {
    if (known(i) && known(j))
      mesh.edges.push_back({static_cast<Index>(i), static_cast<Index>(j)});
    else
      ++lost;
  }
  if (lost > 0)
    remarks_.push_back(counted(lost, "edge names a vertex", "edges name vertices") + " that the file does not have");
}

MeshFile Builder::finish(const char* format) {
  if (vertices_ == 0) fail(source_, "there are no vertices; is this a mesh, and is it complete?");
  if (faces_ == 0) {
    fail(source_, "there are " + std::to_string(vertices_) +
                      " vertices but no faces; a surface is needed, so triangulate the point cloud first");
  }
  if (highest_ >= vertices_) fail_index(highest_, highest_face_, highest_where_);
  MeshFile mesh;
  V_.conservativeResize(vertices_, 3);
  mesh.V = std::move(V_);
  if (polygonal()) {
    triangulate_all(mesh);
  } else {
    F_.conservativeResize(faces_, 3);
    mesh.F = std::move(F_);
  }
  if (mesh.F.rows() == 0) fail_at(source_, first_short_where_, first_short_);
  if (short_faces_ > 0)
    remarks_.push_back(counted(short_faces_, "face has", "faces have") + " fewer than three corners; left out");
  place_nowhere(mesh);
  take_edges(mesh);
  mesh.remarks = std::move(remarks_);
  mesh.format = format;
  mesh.ignored = std::move(ignored_);
  mesh.bytes = static_cast<std::int64_t>(source_.bytes.size());
  return mesh;
}

}  // namespace alcap::detail
