// SPDX-License-Identifier: MIT
//
// builder.h: collects vertices and faces in the order of the file and turns them into a MeshFile: range checks,
// polygons, growth. Every format reader ends here, so all of them agree on what an acceptable mesh is.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "alcap/mesh_io.h"
#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/io/mesh/source.h"

namespace alcap::detail {

class Builder {
 public:
  Builder(const Source& source, const ReadOptions& options) : source_(source), options_(options) {}

  [[nodiscard]] std::int64_t vertices() const { return vertices_; }
  [[nodiscard]] std::int64_t faces() const { return faces_; }

  /// Room for what the header announces (after check_count).
  void reserve_vertices(std::int64_t count) { V_.resize(count, 3); }
  void reserve_faces(std::int64_t count) { F_.resize(count, 3); }

  /// Adds a vertex; `x` holds three coordinates, read at `where`. Those that are not finite are an error if a face uses
  /// the vertex.
  void vertex(const double* x, const char* where) {
    if (!std::isfinite(x[0]) || !std::isfinite(x[1]) || !std::isfinite(x[2])) nowhere_.push_back({vertices_, where});
    tick(vertices_, where);
    if (vertices_ == V_.rows()) grow_vertices();
    double* row = V_.data() + 3 * vertices_++;
    row[0] = x[0], row[1] = x[1], row[2] = x[2];
  }

  /// Adds a face by zero-based vertex numbers; `where` is its place in the file. Faces may come before their vertices.
  void face(std::span<const std::int64_t> corners, const char* where) {
    if (corners.size() != 3 || polygonal()) return polygon(corners, where);
    tick(faces_, where);
    if (faces_ == F_.rows()) grow_faces();
    Index* row = F_.data() + 3 * faces_;
    for (int c = 0; c < 3; ++c) row[c] = checked(corners[at(c)], where);
    ++faces_;
  }

  /// Says how far the reader is, and asks whether to go on, every so many steps.
  void tick(std::int64_t step, const char* where) const {
    if (step % check_every == 0 && step > 0) told(where);
  }

  /// Adds a sentence to MeshFile::remarks.
  void remark(std::string text) { remarks_.push_back(std::move(text)); }

  /// Adds an edge that the file lists, by zero-based vertex numbers; those of no vertex are left out, with a remark.
  void edge(std::int64_t i, std::int64_t j) { edges_.push_back({i, j}); }

  /// Counts something that is no surface.
  void ignore(std::string_view kind, std::int64_t count = 1);

  /// The mesh; throws FileError when there is none (no vertices, no faces, an index without its vertex).
  [[nodiscard]] MeshFile finish(const char* format);

  /// "vertex 7 (counted from 0)", for messages about the vertex that comes next.
  [[nodiscard]] std::string next_vertex() const;
  [[nodiscard]] std::string next_face() const;

 private:
  [[nodiscard]] bool polygonal() const { return !starts_.empty(); }

  // The highest index and its place are kept: whether it exists is known at the end.
  Index checked(std::int64_t v, const char* where) {
    if (v < 0 || v > std::numeric_limits<Index>::max()) fail_index(v, faces_, where);
    if (v > highest_) highest_ = v, highest_face_ = faces_, highest_where_ = where;
    return static_cast<Index>(v);
  }

  /// A vertex without a finite position, and where it was read.
  struct Nowhere {
    std::int64_t vertex;
    const char* where;
  };

  void told(const char* where) const;
  void place_nowhere(MeshFile& mesh);
  void take_edges(MeshFile& mesh);
  void grow_vertices();
  void grow_faces();
  void polygon(std::span<const std::int64_t> corners, const char* where);
  void triangulate_all(MeshFile& mesh) const;
  [[noreturn]] void fail_index(std::int64_t v, std::int64_t face, const char* where) const;

  const Source& source_;
  const ReadOptions& options_;
  Positions<double> V_;  // the first vertices_ rows
  Faces F_;              // the first faces_ rows, as long as all are triangles
  std::int64_t vertices_ = 0;
  std::int64_t faces_ = 0;
  std::int64_t highest_ = -1;
  std::int64_t highest_face_ = 0;
  const char* highest_where_ = nullptr;
  std::vector<Index> corners_;       // from the first polygon on, all corners ...
  std::vector<std::size_t> starts_;  // ... and where each face starts
  std::vector<const char*> places_;  // of the faces, for the same
  std::vector<MeshFile::Ignored> ignored_;
  std::vector<std::array<std::int64_t, 2>> edges_;
  std::vector<Nowhere> nowhere_;
  std::int64_t short_faces_ = 0;  // of fewer than three corners
  std::string first_short_;       // what is wrong with the first of them, and where it is
  const char* first_short_where_ = nullptr;
  std::vector<std::string> remarks_;
};

}  // namespace alcap::detail
