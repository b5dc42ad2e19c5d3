// SPDX-License-Identifier: MIT
//
// problem.h: what is wrong with a design and where, before it becomes a FileError or an OptionError.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "alcap/design_file.h"
#include "alcap/errors.h"
#include "alcap/frames.h"

namespace alcap::detail {

struct Problem {
  std::string path;   ///< JSON pointer
  std::string value;  ///< as JSON, shortened
  std::string rule;
};

/// Throws Problem.
void check_design_values(const DesignFile& design);

/// What check_design() asks of a mesh.
struct DesignTarget {
  std::int64_t vertices = 0, faces = 0;
  std::function<bool(Index)> referenced;  ///< whether a face uses a vertex
};
/// check_design() for a mesh that may be spread over machines. Throws OptionError.
void check_design_on(const DesignFile& design, const DesignTarget& mesh);
/// Every vertex that a design names, in no order, those that no mesh has included.
[[nodiscard]] std::vector<Index> vertices_of(const DesignFile& design);

/// What lies nearest to a point of space.
struct Nearest {
  std::function<SurfacePoint(const Vector3&)> point;
  std::function<Index(const Vector3&)> vertex;
};
/// Gives cones, singularities, fixed vertices and strokes their faces and vertices, where a design has points of space.
void place_points(DesignFile& design, const Nearest& nearest);

/// What the designer is asked for, of a placed singularity or fixed vertex. Faces and vertices are those of the mesh
/// given, which may be a part of the user's; `path` is for messages. Throw OptionError.
[[nodiscard]] SingularityTarget target_of(const DesignSingularity& s, const std::string& path, const Mesh& mesh,
                                          const Positions<double>& V);
[[nodiscard]] VertexConstraint constraint_of(const DesignFixed& f, const std::string& path, int n,
                                             const Frames& frames);
/// Runs `call`; what is wrong with a control is named by its place in the design.
template <class Call>
void at_path(const std::string& path, Call&& call) {
  try {
    call();
  } catch (const OptionError& e) {
    throw OptionError(path, e.field() + " " + e.value(), e.rule());
  }
}
/// "/list/k".
[[nodiscard]] std::string path_of(const char* list, std::size_t k);

/// Moves, merges and splits the singularities of a placed design, and takes the edits out.
void apply_edits(const Surface& surface, DesignFile& design);

/// The name of a control for messages: the user's, or what and where it is.
[[nodiscard]] std::string label(const DesignSingularity& s);
[[nodiscard]] std::string label(const DesignFixed& f);
[[nodiscard]] std::string label(const DesignStroke& s, std::size_t number);
[[nodiscard]] std::string label(const DesignBoundary& b);
[[nodiscard]] std::string label(const DesignFeatures& f);

}  // namespace alcap::detail
