// SPDX-License-Identifier: MIT
//
// mesh_repair.cpp: repairs, each on the mesh that the one before left.
#include "alcap/mesh_repair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "alcap/mesh_check.h"
#include "src/base/index_pair.h"
#include "src/base/numbers.h"
#include "src/mesh/face_edges.h"
#include "src/mesh/near_vertices.h"

namespace alcap {
namespace {

using detail::at;
using detail::counted;

constexpr std::size_t named_at_most = 8;
// Rounds of collapsing and flipping: each round a face is touched once, and chains of flat faces are short.
constexpr int degenerate_rounds = 50;

bool has(const std::vector<DefectReport>& reports, std::initializer_list<Defect> defects) {
  return std::any_of(reports.begin(), reports.end(), [&](const DefectReport& r) {
    return std::find(defects.begin(), defects.end(), r.defect) != defects.end();
  });
}

class Repairing {
 public:
  Repairing(Positions<double> V, Faces F) : given_(V.rows()) {
    mesh_.V = std::move(V);
    mesh_.F = std::move(F);
  }

  void weld(double tolerance);
  void degenerate();
  void duplicates();
  void split();
  void orient();
  void bow_ties();
  void automatic(bool may_weld);

  [[nodiscard]] const RepairedMesh& mesh() const { return mesh_; }
  [[nodiscard]] std::vector<DefectReport> defects() const {
    std::vector<DefectReport> all = find_defects(mesh_.F, mesh_.V.rows());
    if (has(all, {Defect::index_out_of_range, Defect::empty})) return all;
    for (DefectReport& d : find_defects(mesh_.V, mesh_.F)) all.push_back(std::move(d));
    return all;
  }
  [[nodiscard]] RepairedMesh take() { return std::move(mesh_); }

 private:
  void check_numbers() const {
    if (mesh_.F.rows() > 0 && (mesh_.F.minCoeff() < 0 || mesh_.F.maxCoeff() >= mesh_.V.rows()))
      throw_defect(find_defects(mesh_.F, mesh_.V.rows()).front());
  }
  /// Leaves out the faces with drop[t] != 0; returns the given numbers of the first of them.
  std::vector<Index> drop_faces(const std::vector<char>& drop);
  void done(Repair repair, const char* code, std::int64_t count, std::vector<Index> first, std::string message) {
    if (count == 0) return;
    if (first.size() > named_at_most) first.resize(named_at_most);
    mesh_.steps.push_back({code, count, std::move(first), std::move(message), repair});
  }
  [[nodiscard]] Index given_face(std::size_t t) const {
    return mesh_.face_of.empty() ? static_cast<Index>(t) : mesh_.face_of[t];
  }
  [[nodiscard]] bool collapsed(Eigen::Index t) const {
    const auto& F = mesh_.F;
    return F(t, 0) == F(t, 1) || F(t, 1) == F(t, 2) || F(t, 2) == F(t, 0);
  }
  /// Edges of one face.
  [[nodiscard]] std::int64_t open_sides() const {
    detail::Array<char> usable(mesh_.F.rows(), 1);
    for (Eigen::Index t = 0; t < mesh_.F.rows(); ++t) usable[t] = collapsed(t) ? 0 : 1;
    const detail::FaceEdges edges(mesh_.F, usable);
    std::int64_t count = 0;
    for (std::size_t e = 0; e < edges.edges(); ++e) count += edges.halfedges(e).size() == 1 ? 1 : 0;
    return count;
  }
  std::int64_t join_short_sides();
  std::int64_t flip_flat_faces(std::vector<char>& drop);
  std::int64_t drop_collapsed(std::vector<Index>& first);
  /// Fans of corners joined across edges become vertices of their own. Returns the vertices that had more than one.
  std::vector<Index> separate_fans(bool across_any_edge);

  RepairedMesh mesh_;
  Eigen::Index given_;
};

std::vector<Index> Repairing::drop_faces(const std::vector<char>& drop) {
  std::vector<Index> dropped, kept;
  Eigen::Index next = 0;
  for (std::size_t t = 0; t < drop.size(); ++t) {
    if (drop[t] != 0) {
      if (dropped.size() < named_at_most) dropped.push_back(given_face(t));
      continue;
    }
    kept.push_back(given_face(t));
    mesh_.F.row(next++) = mesh_.F.row(static_cast<Eigen::Index>(t)).eval();
  }
  if (next == mesh_.F.rows()) return dropped;
  mesh_.F.conservativeResize(next, 3);
  mesh_.face_of = std::move(kept);
  return dropped;
}

std::int64_t Repairing::drop_collapsed(std::vector<Index>& first) {
  std::vector<char> drop(at(mesh_.F.rows()), 0);
  std::int64_t count = 0;
  for (Eigen::Index t = 0; t < mesh_.F.rows(); ++t) count += drop[at(t)] = collapsed(t) ? 1 : 0;
  if (count > 0)
    for (const Index t : drop_faces(drop)) first.push_back(t);
  return count;
}

void Repairing::weld(double tolerance) {
  check_numbers();
  const Faces before = mesh_.F;
  if (tolerance > 0) {
    const std::vector<Index> near = detail::first_near(mesh_.V, tolerance * detail::box_diagonal(mesh_.V));
    for (Eigen::Index t = 0; t < mesh_.F.rows(); ++t)
      for (int c = 0; c < 3; ++c) mesh_.F(t, c) = near[at(mesh_.F(t, c))];
  } else {
    mesh_.F = repair_weld(mesh_.V, mesh_.F);
  }
  const std::int64_t corners = (mesh_.F.array() != before.array()).count();
  done(Repair::weld, "welded", corners, {},
       counted(corners, "corner", "corners") + " moved to the first vertex " +
           (tolerance > 0 ? "within the tolerance" : "at the same position"));
  if (!(tolerance > 0)) return;
  std::vector<Index> first;
  const std::int64_t lost = drop_collapsed(first);
  done(Repair::weld, "collapsed_removed", lost, first,
       counted(lost, "face that lost a side by welding was", "faces that lost a side by welding were") + " removed");
}

/// Vertices at the same position that a side joins become the one of smaller number.
std::int64_t Repairing::join_short_sides() {
  std::vector<Index> into(at(mesh_.V.rows()));
  std::iota(into.begin(), into.end(), Index{0});
  const auto root = [&](Index v) {
    while (into[at(v)] != v) v = into[at(v)] = into[at(into[at(v)])];
    return v;
  };
  std::int64_t joined = 0;
  for (Eigen::Index t = 0; t < mesh_.F.rows(); ++t)
    for (int c = 0; c < 3; ++c) {
      const Index i = mesh_.F(t, c), j = mesh_.F(t, (c + 1) % 3);
      if (i == j || (mesh_.V.row(i).array() != mesh_.V.row(j).array()).any()) continue;
      const Index a = root(i), b = root(j);
      if (a == b) continue;
      into[at(std::max(a, b))] = std::min(a, b);
      ++joined;
    }
  if (joined > 0)
    for (Eigen::Index t = 0; t < mesh_.F.rows(); ++t)
      for (int c = 0; c < 3; ++c) mesh_.F(t, c) = root(mesh_.F(t, c));
  return joined;
}

/// A face whose corner q lies on its longest side r-p is flipped with the neighbour there; without one it is dropped.
std::int64_t Repairing::flip_flat_faces(std::vector<char>& drop) {
  auto& F = mesh_.F;
  using Ends = detail::IndexPair;
  std::vector<Index> flat;
  for (Eigen::Index t = 0; t < F.rows(); ++t)
    if (!collapsed(t) && alcap::degenerate(mesh_.V.row(F(t, 0)), mesh_.V.row(F(t, 1)), mesh_.V.row(F(t, 2))))
      flat.push_back(static_cast<Index>(t));
  if (flat.empty()) return 0;
  std::unordered_map<Ends, std::vector<Index>, detail::IndexPairHash> halfedges;
  for (Index h = 0; h < 3 * F.rows(); ++h) halfedges[{F(h / 3, h % 3), F(h / 3, (h + 1) % 3)}].push_back(h);
  std::vector<char> touched(at(F.rows()), 0);
  std::int64_t changed = 0;
  for (const Index t : flat) {
    if (touched[at(t)] != 0) continue;
    int side = 0;
    double longest = -1;
    for (int c = 0; c < 3; ++c) {
      const double length = (mesh_.V.row(F(t, c)) - mesh_.V.row(F(t, (c + 1) % 3))).norm();
      if (length > longest) longest = length, side = c;
    }
    const Index r = F(t, side), p = F(t, (side + 1) % 3), q = F(t, (side + 2) % 3);
    const auto across = halfedges.find(Ends{p, r});
    touched[at(t)] = 1;
    if (across == halfedges.end()) {
      drop[at(t)] = 1;
      ++changed;
      continue;
    }
    const Index h = across->second.front(), s = h / 3, d = F(s, (h + 2) % 3);
    // With several faces there, or the new side already taken, flipping would make a worse defect.
    if (across->second.size() > 1 || touched[at(s)] != 0 || d == q || halfedges.count(Ends{q, d}) != 0 ||
        halfedges.count(Ends{d, q}) != 0)
      continue;
    touched[at(s)] = 1;
    F.row(t) << p, q, d;
    F.row(s) << q, r, d;
    ++changed;
  }
  return changed;
}

void Repairing::degenerate() {
  check_numbers();
  std::vector<Index> first;
  std::int64_t removed = 0, joined = 0, flipped = 0;
  for (int round = 0; round < degenerate_rounds; ++round) {
    detail::check_cancelled();
    const std::int64_t sides = join_short_sides();
    const std::int64_t gone = drop_collapsed(first);
    std::vector<char> drop(at(mesh_.F.rows()), 0);
    const std::int64_t flips = flip_flat_faces(drop);
    for (const Index t : drop_faces(drop)) first.push_back(t);
    const std::int64_t dropped = std::count(drop.begin(), drop.end(), char{1});
    joined += sides;
    removed += gone + dropped;
    flipped += flips - dropped;
    if (sides + gone + flips == 0) break;
  }
  done(Repair::degenerate, "degenerate_repaired", removed + flipped, first,
       counted(removed, "face without area", "faces without area") + " removed, " +
           counted(flipped, "flat face", "flat faces") + " flipped with the neighbour, " +
           counted(joined, "side", "sides") + " of length 0 made one vertex");
}

void Repairing::duplicates() {
  check_numbers();
  const auto sorted = [&](Index t) {
    std::array<Index, 3> f{mesh_.F(t, 0), mesh_.F(t, 1), mesh_.F(t, 2)};
    std::sort(f.begin(), f.end());
    return f;
  };
  std::vector<Index> order(at(mesh_.F.rows()));
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(), [&](Index s, Index t) {
    const auto a = sorted(s), b = sorted(t);
    return a != b ? a < b : s < t;
  });
  std::vector<char> drop(order.size(), 0);
  for (std::size_t k = 1; k < order.size(); ++k) drop[at(order[k])] = sorted(order[k]) == sorted(order[k - 1]) ? 1 : 0;
  const std::int64_t count = std::count(drop.begin(), drop.end(), char{1});
  if (count > 0)
    done(Repair::duplicates, "duplicates_removed", count, drop_faces(drop),
         counted(count, "face with the same vertices as an earlier one",
                 "faces with the same vertices as earlier ones") +
             " removed");
}

std::vector<Index> Repairing::separate_fans(bool across_any_edge) {
  check_numbers();
  auto& F = mesh_.F;
  detail::Array<char> usable(F.rows(), 1);
  for (Eigen::Index t = 0; t < F.rows(); ++t) usable[t] = collapsed(t) ? 0 : 1;
  const detail::FaceEdges edges(F, usable);
  std::vector<Index> parent(at(3 * F.rows()));
  std::iota(parent.begin(), parent.end(), Index{0});
  const auto root = [&](Index c) {
    while (parent[at(c)] != c) c = parent[at(c)] = parent[at(parent[at(c)])];
    return c;
  };
  const auto join = [&](Index a, Index b) {
    a = root(a);
    b = root(b);
    parent[at(std::max(a, b))] = std::min(a, b);
  };
  const auto next = [](Index k) { return k % 3 == 2 ? k - 2 : k + 1; };
  for (std::size_t e = 0; e < edges.edges(); ++e) {
    detail::check_cancelled_at(static_cast<std::int64_t>(e));
    const auto h = edges.halfedges(e);
    if (h.size() > 2 && !across_any_edge) continue;
    for (std::size_t k = 1; k < h.size(); ++k) {
      const bool same_way = F(h[0] / 3, h[0] % 3) == F(h[k] / 3, h[k] % 3);
      join(h[0], same_way ? h[k] : next(h[k]));
      join(next(h[0]), same_way ? next(h[k]) : h[k]);
    }
  }
  std::vector<Index> number(parent.size(), none), several, copies;
  std::vector<char> fans(at(mesh_.V.rows()), 0);  // none, one, more
  for (Index c = 0; c < static_cast<Index>(parent.size()); ++c) {
    if (usable[c / 3] == 0 || root(c) != c) continue;
    const Index v = F(c / 3, c % 3);
    if (fans[at(v)] == 0) {
      fans[at(v)] = 1;
      number[at(c)] = v;
      continue;
    }
    if (std::exchange(fans[at(v)], char{2}) == 1) several.push_back(v);
    number[at(c)] = static_cast<Index>(mesh_.V.rows()) + static_cast<Index>(copies.size());
    copies.push_back(v);
  }
  for (Index c = 0; c < static_cast<Index>(parent.size()); ++c)
    if (usable[c / 3] != 0) F(c / 3, c % 3) = number[at(root(c))];
  Eigen::Index row = mesh_.V.rows();
  mesh_.V.conservativeResize(row + static_cast<Eigen::Index>(copies.size()), 3);
  for (const Index v : copies) {
    mesh_.V.row(row++) = mesh_.V.row(v).eval();
    mesh_.copies_of.push_back(v < given_ ? v : mesh_.copies_of[at(v - given_)]);
  }
  return several;
}

void Repairing::split() {
  check_numbers();
  std::int64_t count = 0;
  for (const DefectReport& d : find_defects(mesh_.F, mesh_.V.rows()))
    if (d.defect == Defect::non_manifold_edge) count = d.count;
  if (count == 0) return;
  std::vector<Index> ends = separate_fans(false);
  done(Repair::split, "edges_split", count, std::move(ends),
       "the surface was cut along " + counted(count, "edge", "edges") + " of more than two faces");
}

void Repairing::bow_ties() {
  const auto before = static_cast<std::int64_t>(mesh_.copies_of.size());
  std::vector<Index> vertices = separate_fans(true);
  const auto count = static_cast<std::int64_t>(vertices.size());
  const auto copies = static_cast<std::int64_t>(mesh_.copies_of.size()) - before;
  done(Repair::split, "bow_ties_split", count, std::move(vertices),
       counted(count, "vertex where parts of the surface only touch was",
               "vertices where parts of the surface only touch were") +
           " split; " + counted(copies, "copy is", "copies are") + " appended to the vertices");
}

void Repairing::orient() {
  std::vector<Index> flipped;
  mesh_.F = repair_orientation(mesh_.F, mesh_.V.rows(), &flipped);
  const auto count = static_cast<std::int64_t>(flipped.size());
  for (Index& t : flipped) t = given_face(at(t));
  done(Repair::orient, "reoriented", count, std::move(flipped), counted(count, "face", "faces") + " turned");
}

void Repairing::automatic(bool may_weld) {
  if (has(defects(), {Defect::index_out_of_range, Defect::empty, Defect::not_finite})) return;
  if (may_weld && duplicate_positions(mesh_.V) > 0) {
    // Joined where that gives a surface; left apart where it does not.
    Repairing trial(*this);
    trial.weld(0);
    trial.automatic(false);
    if (trial.open_sides() < open_sides() && trial.defects().empty()) {
      *this = std::move(trial);
      return;
    }
  }
  if (has(defects(), {Defect::repeated_vertex_in_face, Defect::zero_length_edge, Defect::zero_area_face})) degenerate();
  if (has(defects(), {Defect::duplicate_face})) duplicates();
  if (has(defects(), {Defect::non_manifold_edge})) split();
  if (has(defects(), {Defect::inconsistent_orientation}) && !has(defects(), {Defect::not_orientable})) orient();
  if (has(defects(), {Defect::non_manifold_vertex})) bow_ties();
}

}  // namespace

RepairedMesh repair_mesh(Positions<double> V, Faces F, const RepairOptions& options) {
  if (!(options.weld_tolerance >= 0 && options.weld_tolerance <= 0.1))
    throw OptionError("weld_tolerance", options.weld_tolerance, "must be in [0, 0.1], in diagonals of the box");
  const auto asked = [&](Repair repair) {
    return std::find(options.repairs.begin(), options.repairs.end(), repair) != options.repairs.end();
  };
  Repairing work(std::move(V), std::move(F));
  if (asked(Repair::weld)) work.weld(options.weld_tolerance);
  if (asked(Repair::degenerate)) work.degenerate();
  if (asked(Repair::duplicates)) work.duplicates();
  if (asked(Repair::split)) work.split();
  if (asked(Repair::orient)) work.orient();
  if (asked(Repair::automatic)) work.automatic(!asked(Repair::weld));
  if (options.bow_ties && has(find_defects(work.mesh().F, work.mesh().V.rows()), {Defect::non_manifold_vertex}))
    work.bow_ties();
  return work.take();
}

}  // namespace alcap
