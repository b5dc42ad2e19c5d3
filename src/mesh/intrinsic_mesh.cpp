// SPDX-License-Identifier: MIT
#include "src/mesh/intrinsic_mesh.h"

#include <cmath>

#include "src/base/parallel.h"
#include "src/mesh/intrinsic_refine.h"

namespace alcap::detail {
IntrinsicMesh::IntrinsicMesh(const Surface& surface, const std::vector<Index>& keep) {
  const Mesh& mesh = surface.mesh();
  const Geometry& geometry = surface.geometry();
  const auto halfedges = at(mesh.halfedges());
  tail_.assign(mesh.F().data(), mesh.F().data() + halfedges);
  twin_.resize(halfedges);
  edge_.resize(halfedges);
  direction_.resize(halfedges);
  cot_.assign(geometry.cots().data(), geometry.cots().data() + halfedges);
  length_.assign(geometry.lengths().data(), geometry.lengths().data() + mesh.edges());
  twice_area_.resize(at(mesh.faces()));
  half_.resize(at(mesh.edges()));
  kept_.assign(at(mesh.edges()), none);
  out_.resize(at(mesh.vertices()));
  valence_.resize(at(mesh.vertices()));
  angle_sum_.resize(at(mesh.vertices()));
  boundary_.resize(at(mesh.vertices()));
  parallel_for(mesh.halfedges(), [&](std::int64_t i) {
    const auto h = static_cast<Index>(i);
    twin_[at(h)] = mesh.twin(h);
    edge_[at(h)] = mesh.edge(h);
  });
  parallel_for(mesh.faces(),
               [&](std::int64_t t) { twice_area_[static_cast<std::size_t>(t)] = 2 * geometry.areas()[t]; });
  parallel_for(mesh.edges(),
               [&](std::int64_t e) { half_[static_cast<std::size_t>(e)] = mesh.halfedge(static_cast<Index>(e)); });
  parallel_for(mesh.vertices(), [&](std::int64_t i) {
    const auto v = static_cast<Index>(i);
    out_[at(v)] = mesh.first(v);
    angle_sum_[at(v)] = geometry.angle_sum(v);
    boundary_[at(v)] = mesh.boundary_vertex(v) ? 1 : 0;
    double direction = 0;
    Index valence = mesh.boundary_vertex(v) ? 1 : 0;
    mesh.for_each_outgoing(v, [&](Index h) {
      direction_[at(h)] = direction;
      direction += geometry.angle(h);
      ++valence;
    });
    valence_[at(v)] = valence;
  });
  on_fixed_ = boundary_;
  for (const Index e : keep) {
    kept_[at(e)] = e;
    on_fixed_[at(tail(halfedge(e)))] = on_fixed_[at(tip(halfedge(e)))] = 1;
  }
}

bool IntrinsicMesh::delaunay(Index e) const {
  const Index h = halfedge(e), g = twin(h);
  return g == none || delaunay_cotangents(cot(Mesh::prev(h)), cot(Mesh::prev(g)));
}

// The halfedge that leaves v with nothing before it, at a boundary; any one elsewhere.
Index IntrinsicMesh::leftmost(Index v) const {
  const Index start = out_[at(v)];
  if (start == none) return none;
  for (Index h = start;;) {
    const Index g = twin(h);
    if (g == none) return h;
    h = Mesh::next(g);
    if (h == start) return h;
  }
}

bool IntrinsicMesh::joined(Index v, Index w) const {
  if (valence_[at(w)] < valence_[at(v)]) std::swap(v, w);
  bool found = false;
  for_each_around(v, [&](Index h) { found = found || tail(h) == w || tip(h) == w; });
  return found;
}

void IntrinsicMesh::put(Index h, const Side& s) {
  tail_[at(h)] = s.tail;
  twin_[at(h)] = s.twin;
  edge_[at(h)] = s.edge;
  direction_[at(h)] = s.direction;
  if (s.twin != none) twin_[at(s.twin)] = h;
  half_[at(s.edge)] = h;
  out_[at(s.tail)] = h;
}

void IntrinsicMesh::pair(Index g, Index h) {
  twin_[at(g)] = h;
  twin_[at(h)] = g;
}

// A direction within the angles around v. At a boundary there is nothing to wrap.
double IntrinsicMesh::turned(Index v, double angle) const {
  const double all = angle_sum_[at(v)];
  return angle >= all && boundary_[at(v)] == 0 ? angle - all : angle;
}

void IntrinsicMesh::measure(Index t, const Points& p) {
  const double ux = p[1][0] - p[0][0], uy = p[1][1] - p[0][1], vx = p[2][0] - p[0][0], vy = p[2][1] - p[0][1];
  const double area = ux * vy - uy * vx;
  twice_area_[at(t)] = area;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto &a = p[c], &b = p[(c + 1) % 3], &d = p[(c + 2) % 3];
    cot_[at(3 * t) + c] = ((b[0] - a[0]) * (d[0] - a[0]) + (b[1] - a[1]) * (d[1] - a[1])) / area;
  }
}

IntrinsicMesh::Points IntrinsicMesh::layout(Index h) const {
  const double length = length_[at(edge(h))], height = twice_area_[at(Mesh::face(h))] / length;
  return {{{0, 0}, {length, 0}, {cot(h) * height, height}}};
}

// h = i -> j with the apex k on its left, g = j -> i with the apex m. All heights and areas are products of quantities
// that are known to a few digits of rounding, whatever the shapes.
bool IntrinsicMesh::flip(Index e) {
  const Index h = halfedge(e), g = twin(h);
  if (fixed(e)) return false;
  const Index h1 = Mesh::next(h), h2 = Mesh::prev(h), g1 = Mesh::next(g), g2 = Mesh::prev(g);
  const Index i = tail(h), j = tail(g), k = tail(h2), m = tail(g2);
  if (k == m || joined(k, m)) return false;
  const double length = length_[at(e)], yk = twice_area_[at(Mesh::face(h))] / length,
               ym = twice_area_[at(Mesh::face(g))] / length;
  const double ki = cot(h) * yk, kj = cot(h1) * yk, mi = cot(g1) * ym, mj = cot(g) * ym;  // along e, from i and from j
  const double at_i = yk * ym * (cot(h) + cot(g1)), at_j = yk * ym * (cot(h1) + cot(g));
  const double across = yk + ym, apart = std::abs(ki) + std::abs(mi) < std::abs(kj) + std::abs(mj) ? ki - mi : mj - kj;
  const double diagonal = std::hypot(apart, across);
  if (!(at_i > 0 && at_j > 0 && std::isfinite(at_i + at_j + diagonal))) return false;
  const double cot_i = (cot(h) * cot(g1) - 1) / (cot(h) + cot(g1)), cot_j = (cot(h1) * cot(g) - 1) / (cot(h1) + cot(g));
  const Side ki_side = side(h2), im_side = side(g1), mj_side = side(g2), jk_side = side(h1);

  const Index s = Mesh::face(h), t = Mesh::face(g), a = 3 * s, b = 3 * t;
  twice_area_[at(s)] = at_i;
  twice_area_[at(t)] = at_j;
  length_[at(e)] = diagonal;
  cot_[at(a)] = (ki * apart + yk * across) / at_i;
  cot_[at(a + 1)] = cot_i;
  cot_[at(a + 2)] = (-mi * apart + ym * across) / at_i;
  cot_[at(b)] = (mj * apart + ym * across) / at_j;
  cot_[at(b + 1)] = cot_j;
  cot_[at(b + 2)] = (-kj * apart + yk * across) / at_j;
  put(a, ki_side);
  put(a + 1, im_side);
  put(b, mj_side);
  put(b + 1, jk_side);
  put(a + 2, {m, none, e, 0});
  put(b + 2, {k, none, e, 0});
  pair(a + 2, b + 2);
  direction_[at(a + 2)] = turned(m, mj_side.direction + corner(b));
  direction_[at(b + 2)] = turned(k, ki_side.direction + corner(a));
  --valence_[at(i)], --valence_[at(j)], ++valence_[at(k)], ++valence_[at(m)];
  return true;
}

Index IntrinsicMesh::add_vertex(double angle_sum, bool on_boundary, bool on_fixed) {
  out_.push_back(none);
  valence_.push_back(0);
  angle_sum_.push_back(angle_sum);
  boundary_.push_back(on_boundary ? 1 : 0);
  on_fixed_.push_back(on_fixed ? 1 : 0);
  return vertices() - 1;
}

Index IntrinsicMesh::add_edge(double length, Index of_kept) {
  half_.push_back(none);
  length_.push_back(length);
  kept_.push_back(of_kept);
  return edges() - 1;
}

Index IntrinsicMesh::add_face() {
  twice_area_.push_back(0);
  for (std::vector<Index>* array : {&tail_, &twin_, &edge_}) array->resize(array->size() + 3, none);
  for (std::vector<double>* array : {&cot_, &direction_}) array->resize(array->size() + 3, 0.0);
  return faces() - 1;
}

Index IntrinsicMesh::split_edge(Index e, double s) {
  const Index h = halfedge(e), g = twin(h);
  const double length = length_[at(e)];
  const Index p = add_vertex((g == none ? 1 : 2) * pi<double>, g == none, fixed(e));
  const Index rest = add_edge((1 - s) * length, kept(e));
  // One side after the other: x -> p -> y with the apex z becomes (x, p, z) in place and (p, y, z).
  std::array<std::array<Index, 2>, 2> new_sides{};  // x -> p and p -> y of each
  const double fraction[2] = {s, 1 - s};
  const Index first[2] = {e, rest}, last[2] = {rest, e}, sides[2] = {h, g};
  for (std::size_t k = 0; k < 2 && sides[k] != none; ++k) {
    const Index xy = sides[k], yz = Mesh::next(xy), zx = Mesh::prev(xy);
    const Points all = layout(xy);
    const std::array<double, 2> point{fraction[k] * length, 0};
    const Side from_x = side(xy), from_y = side(yz), from_z = side(zx);
    const Index t = Mesh::face(xy), u = add_face(), a = 3 * t, b = 3 * u;
    const Index spoke = add_edge(std::hypot(all[2][0] - point[0], all[2][1]), none);
    measure(t, {all[0], point, all[2]});
    measure(u, {point, all[1], all[2]});
    put(a, {from_x.tail, none, first[k], from_x.direction});
    put(a + 1, {p, none, spoke, 0});
    put(a + 2, from_z);
    put(b, {p, none, last[k], 0});
    put(b + 1, from_y);
    put(b + 2, {from_z.tail, none, spoke, 0});
    pair(a + 1, b + 2);
    direction_[at(b + 2)] = turned(from_z.tail, from_z.direction + corner(a + 2));
    ++valence_[at(from_z.tail)], ++valence_[at(p)];
    new_sides[k] = {a, b};
  }
  length_[at(e)] = s * length;
  valence_[at(p)] += 2;
  if (g != none) {
    pair(new_sides[0][0], new_sides[1][1]);
    pair(new_sides[0][1], new_sides[1][0]);
  }
  return p;
}

Index IntrinsicMesh::split_face(Index t, double x, double y) {
  const Index a = 3 * t, b = 3 * add_face(), c = 3 * add_face();
  const Points q = layout(a);
  const std::array<double, 2> point{x, y};
  const Index p = add_vertex(2 * pi<double>, false, false);
  const Side sides[3] = {side(a), side(a + 1), side(a + 2)};
  const Index base[3] = {a, b, c};
  Index spokes[3];
  for (std::size_t k = 0; k < 3; ++k) spokes[k] = add_edge(std::hypot(q[k][0] - x, q[k][1] - y), none);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    measure(Mesh::face(base[k]), {q[k], q[next], point});
    put(base[k], sides[k]);
    put(base[k] + 1, {sides[next].tail, none, spokes[next], 0});
    put(base[k] + 2, {p, none, spokes[k], 0});
    ++valence_[at(sides[k].tail)];
  }
  for (std::size_t k = 0; k < 3; ++k) {
    pair(base[k] + 1, base[(k + 1) % 3] + 2);
    direction_[at(base[k] + 1)] =
        turned(sides[(k + 1) % 3].tail, sides[(k + 1) % 3].direction + corner(base[(k + 1) % 3]));
  }
  valence_[at(p)] = 3;
  return p;
}

Faces IntrinsicMesh::F() const {
  Faces out(faces(), 3);
  std::copy(tail_.begin(), tail_.end(), out.data());
  return out;
}

}  // namespace alcap::detail
