// SPDX-License-Identifier: MIT
//
// view_scene.h: what the page of apps/viewer shows, as arrays: the mesh, the field, its curves and singularities, and
// numbers per face. Used for pages that stand alone (html_page.h) and by the studio, which sends the parts that
// changed.
//
// Arrays: positions (3 #V), faces (3 #F); branch (i16, 3 #V: direction of branch 0 times 32767) and length (#V);
// curves (3 a point) with curve_offsets; separatrices with separatrix_offsets; singular (8 each: position, normal,
// index, swirl), singular_faces, arms (4 each: number of the singularity, direction); scalar.NAME (#F).
// Positions are relative to meta.center, so that floats keep their digits far from the origin.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "alcap/output.h"
#include "alcap/streamlines.h"
#include "apps/alcap/page/view_pack.h"

namespace alcap::app {

/// Rows of the page's table of figures.
using Figures = std::vector<std::pair<std::string, std::string>>;

void add_mesh(ViewPack& pack, const Surface& surface);
/// Loops around the handles of the surface, homology_generators(), through the middles of the edges they cross.
void add_loops(ViewPack& pack, const Surface& surface);
void add_field(ViewPack& pack, const FieldOutput& source);
/// Positions, indices and straight branches. `sizes` of the arms are left to the page.
void add_singularities(ViewPack& pack, const FieldOutput& source);
/// Evenly spaced curves and separatrices, at a distance that suits the mesh.
struct PageCurves {
  double spacing = 0;  ///< as in StreamlineOptions
  CurveSet even, separatrices;
  [[nodiscard]] bool complete() const { return even.complete && separatrices.complete; }
};
[[nodiscard]] PageCurves page_curves(const FieldOutput& source);
/// Halves of it. The evenly spaced ones so many times as far apart; they begin with what still follows the field of
/// earlier ones.
[[nodiscard]] PageCurves page_even_curves(const FieldOutput& source, double apart = 1, const RunControl& control = {},
                                          const CurveSet* earlier = nullptr);
[[nodiscard]] PageCurves page_separatrices(const FieldOutput& source, const RunControl& control = {});
void add_curves(ViewPack& pack, const FieldOutput& source, const PageCurves& curves);
void add_separatrices(ViewPack& pack, const FieldOutput& source, const PageCurves& curves);
/// n = 1: divergence, curl; otherwise |d|; always |dbar|, |u| and K, as densities.
void add_scalars(ViewPack& pack, const FieldOutput& source);
/// Their names, labels and explanations: what add_scalars() would add for this n.
[[nodiscard]] Json scalar_list(int n);

/// The rows that a report of `alcap field` or `alcap design` has numbers for.
[[nodiscard]] Figures figures(const Json& report);

/// Everything together: the page's data for one result. `report` may be empty.
[[nodiscard]] ViewPack make_scene(const FieldOutput& source, const std::string& title, const Json& report);
/// The same with curves that have been traced.
[[nodiscard]] ViewPack make_scene(const FieldOutput& source, const PageCurves& curves, const std::string& title,
                                  const Json& report);

}  // namespace alcap::app
