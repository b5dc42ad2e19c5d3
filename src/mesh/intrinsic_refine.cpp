// SPDX-License-Identifier: MIT
#include "src/mesh/intrinsic_refine.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "src/base/cancel.h"

namespace alcap::detail {
namespace {

using Point = std::array<double, 2>;
using Points = IntrinsicMesh::Points;

// Sectors between fixed edges, and whole pointed vertices, below this are the surface's own small angles.
constexpr double own_sector = pi<double> / 3;
// Faces that a walk may cross, and that a new vertex's influence is looked for in: both are a few.
constexpr int longest_walk = 10000, widest_influence = 500;
// Faces that all walks together may cross, per vertex of the budget: where they go astray, the vertices do not help.
constexpr std::int64_t steps_per_vertex = 100;
// A vertex nearer to an edge than this part of the face is put on it.
constexpr double on_edge = 1e-6;
// New vertices lie no further from the shortest edge of a skinny triangle than where they see it under the smallest
// angle asked for, by this much nearer (Uengoer 2009): the circle's centre makes more of them than are needed.
constexpr double off_centre = 0.9;
// Sweeps over all edges, for those that became free to flip after they had been asked; one or two are usual.
constexpr int most_sweeps = 100;

double cross(const Point& o, const Point& a, const Point& b) {
  return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
}

double dot(const Point& o, const Point& a, const Point& b) {
  return (a[0] - o[0]) * (b[0] - o[0]) + (a[1] - o[1]) * (b[1] - o[1]);
}

double distance(const Point& a, const Point& b) { return std::hypot(a[0] - b[0], a[1] - b[1]); }

/// Whether d lies inside the circle through a, b and c, counter-clockwise.
bool in_circle(const Point& a, const Point& b, const Point& c, const Point& d) {
  const auto square = [&](const Point& p) { return dot(d, p, p); };
  return square(a) * cross(d, b, c) + square(b) * cross(d, c, a) + square(c) * cross(d, a, b) > 0;
}

}  // namespace

bool delaunay_cotangents(double a, double b) {
  constexpr double slack = 1e-12;  // rounding of cotangents after some flips
  return a + b >= -slack * (1 + std::abs(a) + std::abs(b));
}

void DelaunayFlips::ask(Index e) {
  if (static_cast<std::size_t>(e) >= queued_.size()) queued_.resize(static_cast<std::size_t>(mesh_.edges()), 0);
  char& queued = queued_[static_cast<std::size_t>(e)];
  if (queued != 0 || mesh_.fixed(e) || mesh_.delaunay(e)) return;
  queued = 1;
  queue_.push_back(e);
}

bool DelaunayFlips::empty_queue(std::vector<Index>* changed) {
  bool flipped = false;
  for (std::size_t k = 0; k < queue_.size(); ++k) {
    check_cancelled_at(static_cast<std::int64_t>(k));
    const Index e = queue_[k];
    queued_[static_cast<std::size_t>(e)] = 0;
    if (!complete_ || mesh_.delaunay(e) || !mesh_.flip(e)) continue;
    flipped = true;
    complete_ = static_cast<double>(++count_) < most_ * static_cast<double>(mesh_.edges());
    const Index h = mesh_.halfedge(e);
    for (const Index side : {h, mesh_.twin(h)}) {
      ask(mesh_.edge(Mesh::next(side)));
      ask(mesh_.edge(Mesh::prev(side)));
      if (changed != nullptr) changed->push_back(Mesh::face(side));
    }
  }
  queue_.clear();
  return flipped;
}

void DelaunayFlips::all() {
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    for (Index e = 0; e < mesh_.edges(); ++e) ask(e);
    if (!empty_queue(nullptr)) return;
  }
}

void DelaunayFlips::around(const std::vector<Index>& faces, std::vector<Index>& changed) {
  for (const Index t : faces)
    for (Index h = 3 * t; h < 3 * t + 3; ++h) ask(mesh_.edge(h));
  empty_queue(&changed);
}

Refinement::Refinement(IntrinsicMesh& mesh, DelaunayFlips& flips, const IntrinsicOptions& options)
    : mesh_(mesh),
      flips_(flips),
      cot_(1 / std::tan(options.min_angle)),
      largest_(options.max_radius > 0 ? options.max_radius * options.max_radius
                                      : std::numeric_limits<double>::infinity()) {
  constexpr double numbered = sizeof(Index) == 4 ? 1e9 : 4e18;  // halfedges, well below what is numbered
  most_ =
      static_cast<Index>(std::min(numbered / 6, (1 + options.most_vertices) * static_cast<double>(mesh.vertices())));
  for (Index e = 0; e < mesh.edges() && !any_fixed_; ++e) any_fixed_ = mesh.fixed(e);
}

/// Whether the corner of h belongs to a sector between fixed edges, or a pointed vertex, that is small itself.
bool Refinement::own_corner(Index h) const {
  const Index v = mesh_.tail(h);
  if (!mesh_.on_fixed(v)) return mesh_.angle_sum(v) < own_sector;
  double sector = 0;
  const auto corner = [&](Index g) { return std::atan2(1.0, mesh_.cot(g)); };
  for (Index g = h; sector < own_sector;) {  // counter-clockwise
    sector += corner(g);
    const Index last = Mesh::prev(g);
    if (mesh_.fixed(mesh_.edge(last))) break;
    g = mesh_.twin(last);
  }
  for (Index g = h; sector < own_sector;) {  // clockwise
    if (mesh_.fixed(mesh_.edge(g))) break;
    g = Mesh::next(mesh_.twin(g));
    sector += corner(g);
  }
  return sector < own_sector;
}

double Refinement::squared_radius(Index t) const {
  const Index h = 3 * t;
  const double product =
      mesh_.length(mesh_.edge(h)) * mesh_.length(mesh_.edge(h + 1)) * mesh_.length(mesh_.edge(h + 2));
  const double radius = product / (2 * mesh_.twice_area(t));
  return radius * radius;
}

bool Refinement::skinny(Index t) const {
  Index sharpest = 3 * t;
  for (Index h = 3 * t + 1; h < 3 * t + 3; ++h)
    if (mesh_.cot(h) > mesh_.cot(sharpest)) sharpest = h;
  return mesh_.cot(sharpest) > cot_ && !own_corner(sharpest);
}

/// Whether the corner opposite the fixed edge of h is obtuse; not where it belongs to another fixed edge that meets
/// this one: two edges at a small angle would halve each other forever.
bool Refinement::encroached(Index h) const {
  return mesh_.cot(Mesh::prev(h)) < -1e-9 && !mesh_.fixed(mesh_.edge(Mesh::next(h))) &&
         !mesh_.fixed(mesh_.edge(Mesh::prev(h)));
}

void Refinement::look_at(Index t) {
  for (Index h = 3 * t; h < 3 * t + 3; ++h)
    if (mesh_.fixed(mesh_.edge(h)) && encroached(h)) halves_.push_back(mesh_.edge(h));
  if (!(squared_radius(t) > largest_ || skinny(t))) return;
  bad_[std::ilogb(squared_radius(t))].push_back({t, {mesh_.cot(3 * t), mesh_.cot(3 * t + 1)}});
}

/// The face beyond edge k of the corners p, whose halfedge there is g: its corners from the tail of g on.
Points Refinement::across(const Points& p, std::size_t k, Index g) const {
  const Point &a = p[k], &b = p[(k + 1) % 3];
  const Points local = mesh_.layout(g);
  const double length = distance(a, b), x = (a[0] - b[0]) / length, y = (a[1] - b[1]) / length;
  const Point& apex = local[2];
  return {b, a, Point{b[0] + apex[0] * x - apex[1] * y, b[1] + apex[0] * y + apex[1] * x}};
}

Refinement::Place Refinement::walk_to_cure(Index t) {
  Index shortest = 3 * t;
  for (Index h = 3 * t + 1; h < 3 * t + 3; ++h)
    if (mesh_.length(mesh_.edge(h)) < mesh_.length(mesh_.edge(shortest))) shortest = h;
  Place place{.face = t, .hit = none, .corner = shortest, .p = mesh_.layout(shortest), .target = {}};
  const Point& apex = place.p[2];
  const double side = place.p[1][0];
  const double centre = (apex[0] * apex[0] + apex[1] * apex[1] - side * apex[0]) / (2 * apex[1]);
  // Half the side times the cotangent of half the angle.
  const double off = off_centre * side / 2 * (cot_ + std::hypot(1.0, cot_));
  place.target = {side / 2, skinny(t) ? std::min(centre, off) : centre};
  for (int step = 0; step < longest_walk; ++step) {
    std::size_t out = 3;
    double farthest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      if (step > 0 && k == 0) continue;  // where it came from
      const Point &a = place.p[k], &b = place.p[(k + 1) % 3];
      const double beyond = -cross(a, b, place.target) / distance(a, b);
      if (beyond > farthest) out = k, farthest = beyond;
    }
    if (out == 3) return place;
    Index h = place.corner;
    for (std::size_t k = 0; k < out; ++k) h = Mesh::next(h);
    if (mesh_.fixed(mesh_.edge(h))) {
      place.hit = mesh_.edge(h);
      return place;
    }
    const Index g = mesh_.twin(h);
    place.p = across(place.p, out, g);
    place.corner = g;
    place.face = Mesh::face(g);
    ++steps_;
  }
  place.face = none;
  return place;
}

/// A fixed edge in whose circle a vertex at the target would lie; `none`.
Index Refinement::influenced(const Place& place) const {
  if (!any_fixed_) return none;
  struct Step {
    Points p;
    Index corner;
    std::size_t first;
  };
  std::vector<Step> open{{place.p, place.corner, 0}};
  for (int seen = 0; !open.empty() && seen < widest_influence; ++seen) {
    const Step here = open.back();
    open.pop_back();
    Index h = here.corner;
    for (std::size_t k = 0; k < 3; ++k, h = Mesh::next(h)) {
      if (k < here.first) continue;
      if (mesh_.fixed(mesh_.edge(h))) {
        if (dot(place.target, here.p[k], here.p[(k + 1) % 3]) < 0) return mesh_.edge(h);
        continue;
      }
      const Index g = mesh_.twin(h);
      const Points beyond = across(here.p, k, g);
      if (in_circle(beyond[0], beyond[1], beyond[2], place.target)) open.push_back({beyond, g, 1});
    }
  }
  return none;
}

void Refinement::settle(const std::vector<Index>& faces) {
  std::vector<Index> changed = faces;
  flips_.around(faces, changed);
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  for (const Index t : changed) look_at(t);
}

void Refinement::halve(Index e) {
  const Index p = mesh_.split_edge(e, 0.5);
  std::vector<Index> faces;
  mesh_.for_each_around(p, [&](Index h) { faces.push_back(Mesh::face(h)); });
  settle(faces);
}

void Refinement::put_vertex(const Place& place) {
  double weight[3], sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    weight[k] = std::max(0.0, cross(place.target, place.p[(k + 1) % 3], place.p[(k + 2) % 3]));
    sum += weight[k];
  }
  const Points q = mesh_.layout(3 * place.face);
  Point at{0, 0};
  Index on = none;
  double fraction = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    weight[k] /= sum;
    const Point& corner = q[(static_cast<std::size_t>(place.corner % 3) + k) % 3];
    at = {at[0] + weight[k] * corner[0], at[1] + weight[k] * corner[1]};
  }
  for (std::size_t k = 0; k < 3 && on == none; ++k) {
    if (weight[k] > on_edge) continue;
    const std::size_t from = (k + 1) % 3, to = (k + 2) % 3;
    Index h = place.corner;
    for (std::size_t j = 0; j < from; ++j) h = Mesh::next(h);
    on = mesh_.edge(h);
    fraction = weight[to] / (weight[from] + weight[to]);
    if (mesh_.halfedge(on) != h) fraction = 1 - fraction;
  }
  if (on != none && !(fraction > on_edge && fraction < 1 - on_edge)) return;  // on a vertex: nothing to gain
  const Index p = on == none        ? mesh_.split_face(place.face, at[0], at[1])
                  : mesh_.fixed(on) ? mesh_.split_edge(on, 0.5)
                                    : mesh_.split_edge(on, fraction);
  std::vector<Index> faces;
  mesh_.for_each_around(p, [&](Index h) { faces.push_back(Mesh::face(h)); });
  settle(faces);
}

void Refinement::run() {
  for (Index t = 0; t < mesh_.faces(); ++t) look_at(t);
  while (!halves_.empty() || !bad_.empty()) {
    check_cancelled();
    if (mesh_.vertices() >= most_ || !flips_.complete() || steps_ > steps_per_vertex * most_) {
      complete_ = false;
      return;
    }
    if (!halves_.empty()) {
      const Index e = halves_.back(), h = mesh_.halfedge(e), g = mesh_.twin(h);
      halves_.pop_back();
      if (encroached(h) || (g != none && encroached(g))) halve(e);
      continue;
    }
    // The largest circles first: what they cut up need not be looked at.
    const auto largest = std::prev(bad_.end());
    const Bad worst = largest->second.back();
    largest->second.pop_back();
    if (largest->second.empty()) bad_.erase(largest);
    if (same(worst)) cure(worst);  // else it was looked at again when it changed
  }
}

bool Refinement::same(const Bad& bad) const {
  return mesh_.cot(3 * bad.face) == bad.cot[0] && mesh_.cot(3 * bad.face + 1) == bad.cot[1];
}

void Refinement::cure(const Bad& worst) {
  const Place place = walk_to_cure(worst.face);
  if (place.face == none) return;
  const Index fixed = place.hit != none ? place.hit : influenced(place);
  if (fixed == none) {
    put_vertex(place);
    return;
  }
  halve(fixed);
  if (same(worst)) look_at(worst.face);
}

}  // namespace alcap::detail
