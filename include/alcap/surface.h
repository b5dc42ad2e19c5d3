// SPDX-License-Identifier: MIT
//
// surface.h: a triangle mesh ready to compute on, made once and shared: its points, half-edges, lengths and angles, and
// topology.
//
//   alcap::Surface surface(V, F);                           // the users' own arrays, see arrays.h
//   alcap::Surface surface(std::move(file.V), std::move(file.F));    // no copy
//   surface.mesh().faces(); surface.geometry().area(t); surface.topology().euler();
//
// A Surface is a handle: copies share the same immutable parts, which live as long as one of them does, and may be used
// by several threads at once.
#pragma once

#include <memory>
#include <utility>

#include "alcap/arrays.h"
#include "alcap/geometry.h"
#include "alcap/mesh.h"
#include "alcap/topology.h"

namespace alcap {

/// A mesh with points, half-edges, lengths and topology; a handle, cheap to copy.
class Surface {
 public:
  /// No surface; only good for being assigned to.
  Surface() = default;

  /// From points (#V x 3) and counter-clockwise triangles (#F x 3); which types is said in arrays.h. Vertices and faces
  /// keep their numbers. Throws MeshError naming the elements where Mesh and Geometry do, OptionError for arrays that
  /// do not have three columns. O(V + F).
  template <class Points, class Triangles>
  Surface(Points&& V, Triangles&& F)
      : Surface(Made{}, as_positions(std::forward<Points>(V)), as_faces(std::forward<Triangles>(F))) {}

  /// From points and a mesh that is made already. Throws MeshError where Geometry does, OptionError when V does not
  /// have one row per vertex.
  [[nodiscard]] static Surface from_mesh(Positions<double> V, Mesh mesh);

  /// An intrinsic surface, from the lengths of its edges (#E, in the order of the mesh's edges), such as a flat torus.
  /// Without V it lies in no space, and what needs positions throws OptionError. With V (#V x 3) that is where vertices
  /// are drawn, such as those of an intrinsic triangulation, though edges are as long as `lengths` says. Throws
  /// MeshError as Geometry::from_lengths, OptionError when V has another number of rows.
  [[nodiscard]] static Surface from_lengths(Mesh mesh, const VectorX<double>& lengths, Positions<double> V = {});

  /// An intrinsic surface from measures that are made already, as Geometry::from_measures() makes them.
  [[nodiscard]] static Surface from_geometry(Mesh mesh, Geometry geometry);

  /// Whether there are points.
  [[nodiscard]] bool in_space() const { return parts_->V.rows() > 0; }
  [[nodiscard]] const Positions<double>& V() const { return parts_->V; }  ///< #V x 3; empty on an intrinsic surface
  /// V(), or OptionError on an intrinsic surface: for functions that need points.
  [[nodiscard]] const Positions<double>& positions() const;
  [[nodiscard]] const Faces& F() const { return parts_->mesh.F(); }  ///< #F x 3
  /// Half-edges.
  [[nodiscard]] const Mesh& mesh() const { return parts_->mesh; }
  /// Lengths, angles, areas.
  [[nodiscard]] const Geometry& geometry() const { return parts_->geometry; }
  /// Components, boundary loops.
  [[nodiscard]] const Topology& topology() const { return parts_->topology; }

 private:
  struct Made {};
  struct Parts {
    Positions<double> V;
    Mesh mesh;
    Topology topology;
    Geometry geometry;
  };
  Surface(Made, Positions<double> V, Faces F);

  std::shared_ptr<const Parts> parts_;
};

}  // namespace alcap
