// SPDX-License-Identifier: MIT
#include "src/design/singularity_parts.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <queue>
#include <set>
#include <string>
#include <unordered_set>
#include <utility>

#include "src/base/cancel.h"
#include "src/design/variational/rows.h"

namespace alcap::detail {
namespace {

using C = Complex<double>;

// Between zeros, in square roots of the face's area: from here on they are as good as points to each other, and up to
// four of them are met to half a degree.
constexpr double least_gap = 4;

/// A face in the plane of the first one: its point z lies at origin + e^{i turn} z.
struct Unfolded {
  double distance = 0;
  Index face = none;
  C origin = 0;
  double turn = 0;
  C middle = 0;  ///< where its barycenter lies

  bool operator>(const Unfolded& other) const {
    return std::pair(distance, face) > std::pair(other.distance, other.face);
  }
};

std::array<C, 3> corners(const Mesh& mesh, const Geometry& geometry, Index t) {
  return {C(0), C(geometry.length(mesh.edge(3 * t))),
          std::polar(geometry.length(mesh.edge(3 * t + 2)), geometry.angle(3 * t))};
}

C barycenter(const std::array<C, 3>& p) { return (p[0] + p[1] + p[2]) / 3.0; }

/// Faces from `start`, by the length of the strip of barycenters that leads there, until visit(face) says so.
void walk(const Mesh& mesh, const Geometry& geometry, Index start, const std::function<bool(const Unfolded&)>& visit) {
  std::priority_queue<Unfolded, std::vector<Unfolded>, std::greater<>> open;
  std::unordered_set<Index> done;
  open.push({.face = start, .middle = barycenter(corners(mesh, geometry, start))});
  std::int64_t steps = 0;
  while (!open.empty()) {
    check_cancelled_at(steps++);
    const Unfolded here = open.top();
    open.pop();
    if (!done.insert(here.face).second) continue;
    if (visit(here)) return;
    const std::array<C, 3> p = corners(mesh, geometry, here.face);
    for (Index h = 3 * here.face; h < 3 * here.face + 3; ++h) {
      const Index g = mesh.twin(h);
      if (g == none || done.count(Mesh::face(g)) > 0) continue;
      const std::array<C, 3> q = corners(mesh, geometry, Mesh::face(g));
      Unfolded next{.face = Mesh::face(g)};
      next.turn = here.turn + geometry.direction(h) + pi<double> - geometry.direction(g);
      const C tip = here.origin + std::polar(1.0, here.turn) * p[static_cast<std::size_t>(Mesh::next(h) % 3)];
      next.origin = tip - std::polar(1.0, next.turn) * q[static_cast<std::size_t>(g % 3)];
      next.middle = next.origin + std::polar(1.0, next.turn) * barycenter(q);
      next.distance = here.distance + std::abs(next.middle - here.middle);
      open.push(next);
    }
  }
}

}  // namespace

double carried_turn(const Mesh& mesh, const Geometry& geometry, Index from, Index to) {
  if (to < 0 || to >= mesh.faces())
    throw OptionError("face", to, "there is no such face; the mesh has " + std::to_string(mesh.faces()));
  double turn = 0;
  bool found = false;
  walk(mesh, geometry, from, [&](const Unfolded& at) {
    if (at.face != to) return false;
    turn = -at.turn;
    return found = true;
  });
  if (!found) throw OptionError("face", to, "lies on another component than face " + std::to_string(from));
  return wrap(turn);
}

std::vector<SingularityPart> singularity_parts(const Mesh& mesh, const Geometry& geometry, int n,
                                               const SingularityTarget& target,
                                               const std::function<void(Index)>& visited) {
  if (target.count == 1) return {{.face = target.face}};
  const double unit = std::sqrt(geometry.area(target.face));
  std::vector<Unfolded> chosen;
  std::set<Index> taken;
  walk(mesh, geometry, target.face, [&](const Unfolded& at) {
    if (visited) visited(at.face);
    const auto vertex = [&](Index c) { return mesh.F()(at.face, c); };
    if (taken.count(vertex(0)) + taken.count(vertex(1)) + taken.count(vertex(2)) > 0) return false;
    for (const Unfolded& other : chosen)
      if (std::abs(other.middle - at.middle) < least_gap * unit) return false;
    for (Index c = 0; c < 3; ++c) taken.insert(vertex(c));
    chosen.push_back(at);
    return static_cast<int>(chosen.size()) == target.count;
  });
  if (static_cast<int>(chosen.size()) < target.count)
    throw OptionError("count", target.count,
                      "this component has room for " + std::to_string(chosen.size()) + " zeros that far apart");
  // Around a target of flux d the field is that of a pole, d / conj(z - z_j). Their sum is 1 / prod conj(z - z_l), of
  // index k as seen from afar and without other zeros, when d_j = 1 / prod_{l != j} conj(z_j - z_l).
  std::vector<C> residues;
  double least = std::numeric_limits<double>::infinity();
  for (const Unfolded& at : chosen) {
    C residue = 1;
    for (const Unfolded& other : chosen)
      if (other.face != at.face) residue *= unit / std::conj(at.middle - other.middle);
    residues.push_back(target.sign < 0 ? std::conj(residue) : residue);
    least = std::min(least, std::abs(residue));
  }
  std::vector<SingularityPart> parts;
  for (std::size_t k = 0; k < chosen.size(); ++k)
    parts.push_back({chosen[k].face, residues[k] / least * std::polar(1.0, -(n - target.sign) * chosen[k].turn)});
  return parts;
}

SingularityTarget moved(const Mesh& mesh, const Geometry& geometry, int n, const SingularityTarget& target,
                        Index face) {
  SingularityTarget out = target;
  const double turn = carried_turn(mesh, geometry, target.face, face);
  out.face = face;
  if (target.sign * target.count != n) out.orientation = wrap(target.orientation + turn);  // a swirl has no direction
  if (target.pin) out.pin = std::array<double, 3>{1.0 / 3, 1.0 / 3, 1.0 / 3};
  return out;
}

}  // namespace alcap::detail
