// SPDX-License-Identifier: MIT
//
// connection_global.cpp: the connection that minimises D_T + lambda D_E (LTGD 2016, Sec. 5.3).
//
// Iterative refinement: the gradient is taken in double, the correction it asks for is solved by conjugate gradients in
// float (src/correction_system.h), which halves the memory traffic that bounds them; where float makes no headway
// (extreme slivers) the next correction is solved in double.
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alcap/connection.h"
#include "alcap/parallel.h"
#include "kernels/connection_energy.h"
#include "kernels/face_relaxation.h"
#include "src/correction_system.h"
#include "src/face_pairs.h"
#include "src/grounded_laplacian.h"
#include "src/large_array.h"

namespace alcap {
namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

// tan of the angle opposite a halfedge, capped, times the length factor: the weights of D_E. Computed where they are
// needed, which costs less than to store and read them.
template <class T>
class HalfedgeWeights {
 public:
  HalfedgeWeights(const Mesh& mesh, const Geometry<T>& geometry, const GlobalOptions& options)
      : mesh_(mesh), geometry_(geometry), cap_(static_cast<T>(options.tan_cap)), factor_(options.length_factor) {
    if (factor_ != LengthFactor::mean_edge) return;
    Topology topology = find_topology(mesh);
    if (topology.components.size() == 1) {
      const double sum = parallel_sum<double>(
          mesh.edges(), [&](std::int64_t e) { return double(geometry.length(static_cast<Index>(e))); });
      per_length_ = {static_cast<T>(mesh.edges() / sum)};
      return;
    }
    std::vector<double> sum(topology.components.size());
    for (Index e = 0; e < mesh.edges(); ++e)
      sum[static_cast<std::size_t>(topology.face_component[static_cast<std::size_t>(Mesh::face(mesh.halfedge(e)))])] +=
          double(geometry.length(e));
    for (std::size_t c = 0; c < sum.size(); ++c)
      per_length_.push_back(static_cast<T>(topology.components[c].edges / sum[c]));
    face_component_ = std::move(topology.face_component);
  }

  T operator()(Index h) const { return kernels::capped_tangent(geometry_.cot(Mesh::prev(h)), cap_) * length_factor(h); }

  // p of a face's halfedges, from its cotangents and their length factors (times detail, 0 on the boundary).
  template <class Lanes>
  void from_factors(const Lanes (&cot)[3], const Lanes (&factor)[3], Lanes (&p)[3]) const {
    for (int k = 0; k < 3; ++k) p[k] = kernels::capped_tangent(cot[(k + 2) % 3], Lanes(double(cap_))) * factor[k];
  }

  T length_factor(Index h) const {
    if (factor_ == LengthFactor::per_edge) return T(1);
    const T length = geometry_.length(mesh_.edge(h));
    if (factor_ == LengthFactor::metric) return length;
    const Index c = face_component_.empty() ? 0 : face_component_[static_cast<std::size_t>(Mesh::face(h))];
    return length * per_length_[static_cast<std::size_t>(c)];
  }

 private:
  const Mesh& mesh_;
  const Geometry<T>& geometry_;
  T cap_;
  LengthFactor factor_;
  std::vector<T> per_length_;          // 1 over the mean edge length, per component
  std::vector<Index> face_component_;  // empty where there is only one
};

void validate(const GlobalOptions& o) {
  const auto refuse = [](const char* field, double value, const char* rule) {
    throw OptionError(field, std::to_string(value), rule);
  };
  if (!(o.detail > 0) || !std::isfinite(o.detail)) refuse("detail", o.detail, "must be positive and finite");
  if (!(o.tan_cap > 0) || !std::isfinite(o.tan_cap)) refuse("tan_cap", o.tan_cap, "must be positive and finite");
  if (!(o.tolerance > 0) || o.tolerance >= 1) refuse("tolerance", o.tolerance, "must lie in (0, 1)");
  if (o.max_iterations < 1) refuse("max_iterations", o.max_iterations, "must be at least 1");
}

// The correction of rho_{v->e} at both ends of edge e that is best for the state r.
template <class T>
std::pair<T, T> edge_correction(const Mesh& mesh, const HalfedgeWeights<T>& weights,
                                const detail::LiftedResiduals<T>& r, Index e) {
  const Index h = mesh.halfedge(e), g = mesh.twin(h);
  if (g == none) return {r.start[h], r.end[h]};
  const T here = weights(h), there = weights(g), sum = here + there;
  return {(here * r.start[h] + there * r.end[g]) / sum, (here * r.end[h] + there * r.start[g]) / sum};
}

// Three numbers per edge, or per row of the exchange between faces and edges, wherever they lie.
using EdgeValues = Eigen::Matrix<double, 3, Eigen::Dynamic>;
using Values = Eigen::Ref<const EdgeValues>;
using ValuesOut = Eigen::Map<EdgeValues>;

// The lifted state, as the optimisation sees it; at rest, all of it is zero.
template <class T>
struct FaceStates {
  using Lanes = detail::DoubleLanes;
  static constexpr int N = Lanes::size;

  const Mesh& mesh;
  const Geometry<T>& geometry;
  const HalfedgeWeights<T>& weights;
  double detail;
  const VectorX<T>& tau;
  const detail::LiftedResiduals<T>& r;
  bool at_rest = false;

  // The coefficients of the faces of some halfedges, from there on. Boundaries have p = 0: rho_{v->e} is free there and
  // follows its face.
  void coefficients(const Index (&first)[N], kernels::FaceCoefficients<Lanes>& c) const {
    double cots[3][N], factors[3][N];
    for (int l = 0; l < N; ++l) {
      Index h = first[l];
      for (int k = 0; k < 3; ++k, h = Mesh::next(h)) {
        cots[k][l] = double(geometry.cot(h));
        factors[k][l] = mesh.boundary_halfedge(h) ? 0 : detail * double(weights.length_factor(h));
      }
    }
    Lanes cot[3], factor[3], p[3];
    for (int k = 0; k < 3; ++k) {
      cot[k] = Lanes::load(cots[k]);
      factor[k] = Lanes::load(factors[k]);
    }
    weights.from_factors(cot, factor, p);
    kernels::face_coefficients(cot, p, c);
  }

  // What they see with edges turned by u.
  void look(const Index (&first)[N], const Values& u, Lanes (&v)[3][3]) const {
    double in[3][3][N];
    for (int l = 0; l < N; ++l) {
      Index h = first[l];
      for (int k = 0; k < 3; ++k, h = Mesh::next(h)) {
        const Index e = mesh.edge(h);
        const double sign = mesh.canonical(h) ? 1.0 : -1.0;
        const double start = at_rest ? 0 : double(r.start[h]), end = at_rest ? 0 : double(r.end[h]);
        in[0][k][l] = (start + end) / 2 - u(0, e);
        in[1][k][l] = end - start - sign * u(1, e);
        in[2][k][l] = (at_rest ? 0 : double(tau[h])) + sign * u(2, e);
      }
    }
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) v[i][k] = Lanes::load(in[i][k]);
  }

  // Halfedge h's column k of v, to its edge.
  template <class System>
  void pull_at(const System& system, Index h, int k, int lane, const Lanes (&v)[3][3], ValuesOut& parts) const {
    const std::int64_t row = system.row(h);
    for (int i = 0; i < 3; ++i) parts(i, row) = v[i][k].v[lane];
  }

  // With the edges turned by u: parts = the pull of each face on its outer edges, x = what its relaxed corners move by.
  // Edges between paired faces are turned to their optimum.
  template <class System>
  void pull(const System& system, const detail::FacePairs& faces, ValuesOut& u, ValuesOut& parts, double* x) const {
    parallel_for((std::int64_t{faces.singles} + N - 1) / N,
                 [&](std::int64_t group) { pull_singles(system, faces, group * N, u, parts, x); });
    parallel_for((std::int64_t{faces.pairs} + N - 1) / N,
                 [&](std::int64_t group) { pull_pairs(system, faces, group * N, u, parts, x); });
  }

  // Beyond the last one, lanes repeat it.
  template <class System>
  void pull_singles(const System& system, const detail::FacePairs& faces, std::int64_t begin, const Values& u,
                    ValuesOut& parts, double* x) const {
    Index first[N];
    Lanes v[3][3], moved[3];
    for (int l = 0; l < N; ++l) first[l] = 3 * faces.single[at(std::min<std::int64_t>(begin + l, faces.singles - 1))];
    kernels::FaceCoefficients<Lanes> c;
    coefficients(first, c);
    look(first, u, v);
    kernels::relax(c, v, moved);
    for (int l = 0; l < N && begin + l < faces.singles; ++l)
      for (int k = 0; k < 3; ++k) {
        pull_at(system, first[l] + k, k, l, v, parts);
        x[first[l] + k] = moved[k].v[l];
      }
  }

  template <class System>
  void pull_pairs(const System& system, const detail::FacePairs& faces, std::int64_t begin, ValuesOut& u,
                  ValuesOut& parts, double* x) const {
    Index first[2][N];
    Lanes v[2][3][3], moved[2][3], inverse[6], turned[3];
    kernels::FaceCoefficients<Lanes> c[2];
    for (int l = 0; l < N; ++l) {
      const std::int64_t pair = std::min<std::int64_t>(begin + l, faces.pairs - 1);
      first[0][l] = mesh.halfedge(faces.between[at(pair)]);
      first[1][l] = mesh.twin(first[0][l]);
    }
    for (int side = 0; side < 2; ++side) {
      coefficients(first[side], c[side]);
      look(first[side], u, v[side]);
    }
    kernels::invert_between(c[0], c[1], inverse);
    kernels::relax_pair(c[0], c[1], inverse, v[0], v[1], moved[0], moved[1], turned);
    for (int l = 0; l < N && begin + l < faces.pairs; ++l) {
      const Index e = faces.between[at(begin + l)];
      u(0, e) -= turned[0].v[l];
      u(1, e) -= turned[1].v[l];
      u(2, e) += turned[2].v[l];
      for (int side = 0; side < 2; ++side) {
        Index h = first[side][l];
        for (int k = 0; k < 3; ++k, h = Mesh::next(h)) {
          if (k > 0) pull_at(system, h, k, l, v[side], parts);
          x[h] = moved[side][k].v[l];
        }
      }
    }
  }
};

// The faces' pull on outer edge i, the right-hand side of the correction, from the parts of its two faces.
std::array<double, 3> pull_on(const Values& parts, std::int64_t i, bool open) {
  const std::int64_t row = 2 * i;
  if (open) return {parts(0, row), parts(1, row), -parts(2, row)};
  return {parts(0, row) + parts(0, row + 1), parts(1, row) - parts(1, row + 1), parts(2, row + 1) - parts(2, row)};
}

template <class T>
void deviation(const Mesh& mesh, const Geometry<T>& geometry, const HalfedgeWeights<T>& weights, Connection<T>& c) {
  c.report.D_T = parallel_sum<double>(mesh.faces(), [&](std::int64_t t) {
    const Index h = static_cast<Index>(3 * t);
    const T cot[3] = {geometry.cot(h), geometry.cot(h + 1), geometry.cot(h + 2)};
    const T tau[3] = {c.tau[h], c.tau[h + 1], c.tau[h + 2]};
    return double(kernels::triangle_energy(cot, tau));
  });
  c.report.D_E = parallel_sum<double>(mesh.halfedges(), [&](std::int64_t i) {
    const Index h = static_cast<Index>(i);
    const T to_face = c.edge_to_face(geometry, h);
    const T at_tail = wrap(c.rho_t[h] - c.rho_start(mesh, h) - to_face);
    const T at_tip = wrap(c.rho_t[Mesh::next(h)] - c.rho_end(mesh, h) - to_face);
    return double(kernels::halfedge_energy(weights(h), at_tail, at_tip));
  });
}

// tau, K and the deviations of a connection whose lifted residuals are r.
template <class T>
void close_faces(const Mesh& mesh, const Geometry<T>& geometry, const HalfedgeWeights<T>& weights,
                 const detail::LiftedResiduals<T>& r, Connection<T>& c) {
  using Sums = std::array<double, 2>;
  const Sums sums = parallel_reduce(
      mesh.faces(), Sums{},
      [&](std::int64_t begin, std::int64_t end) {
        Sums sum{};
        for (std::int64_t t = begin; t < end; ++t) {
          const Index h = static_cast<Index>(3 * t);
          const T cot[3] = {geometry.cot(h), geometry.cot(h + 1), geometry.cot(h + 2)};
          T tau[3];
          for (Index k = 0; k < 3; ++k) {
            c.tau[h + k] = tau[k] = c.eps_along(mesh, h + k) - r.start[h + k] + r.end[h + k];
            sum[1] += double(kernels::halfedge_energy(weights(h + k), r.start[h + k], r.end[h + k]));
          }
          c.K[t] = -(tau[0] + tau[1] + tau[2]);
          sum[0] += double(kernels::triangle_energy(cot, tau));
        }
        return sum;
      },
      [](const Sums& a, const Sums& b) {
        return Sums{a[0] + b[0], a[1] + b[1]};
      });
  c.report.D_T = sums[0];
  c.report.D_E = sums[1];
}

// With rho held (trivial connections) the problem is not local: turning all frames around slowly varying vertices costs
// next to nothing, the Dirichlet energy of the turn. So the edges' blocks are joined by a Poisson solve for such turns
// g: y = g at both ends of an edge, X = g in its faces. Conjugate gradients in double; returns the iterations.
class HeldRho {
 public:
  template <class T>
  HeldRho(const Mesh& mesh, const Geometry<T>& geometry)
      : mesh_(mesh), poisson_(make_linear_solver<double>({.tolerance = 1e-4})) {
    const SparseMatrix<double> L = detail::grounded_laplacian(mesh, geometry, find_topology(mesh));
    poisson_->analyse(L);
    poisson_->factorise(L);
  }

  // u += the solution for rhs, to the relative reduction `wanted`; product(p) is A p.
  template <class System, class Product>
  int solve(System& system, const EdgeValues& rhs, double wanted, int most, const Product& product,
            ValuesOut& u) const {
    EdgeValues r = rhs, z(3, r.cols()), p, before = r;
    double square = precondition(system, r, z), first = square;
    p = z;
    int done = 0;
    while (done < most && square > wanted * wanted * first) {
      ++done;
      const EdgeValues q = product(p);
      const double alpha = square / dot(p, q);
      if (!std::isfinite(alpha)) break;
      u += alpha * p;
      before = r;
      r -= alpha * q;
      const double next = precondition(system, r, z);
      // Flexible: the float blocks and the Poisson solver are not exactly linear.
      const double beta = (next - dot(before, z)) / square;
      square = next;
      p = z + beta * p;
    }
    return done;
  }

 private:
  static double dot(const EdgeValues& a, const EdgeValues& b) {
    return parallel_sum<double>(a.cols(), [&](std::int64_t e) { return a.col(e).dot(b.col(e)); });
  }

  // z = P r; returns r' z.
  template <class System>
  double precondition(System& system, const EdgeValues& r, EdgeValues& z) const {
    (void)system.start([&](Index e) { return std::array<double, 3>{r(0, e), r(1, e), r(2, e)}; });
    parallel_for(mesh_.edges(), [&](std::int64_t e) {
      const auto blocks = system.preconditioned(static_cast<Index>(e));
      for (Eigen::Index k = 0; k < 3; ++k) z(k, e) = double(blocks[static_cast<std::size_t>(k)]);
    });
    MatrixX<double> b = MatrixX<double>::Zero(mesh_.vertices(), 1), g(mesh_.vertices(), 1);
    for (Index e = 0; e < mesh_.edges(); ++e) {
      const Index h = mesh_.halfedge(e);
      b(mesh_.tail(h), 0) += r(0, e) / 2 - r(1, e);
      b(mesh_.tip(h), 0) += r(0, e) / 2 + r(1, e);
    }
    (void)poisson_->solve(b, g);
    parallel_for(mesh_.edges(), [&](std::int64_t e) {
      const Index h = mesh_.halfedge(static_cast<Index>(e));
      const double tail = g(mesh_.tail(h), 0), tip = g(mesh_.tip(h), 0);
      z(0, e) += (tail + tip) / 2;
      z(1, e) += tip - tail;
      z(2, e) = 0;
    });
    return dot(r, z);
  }

  const Mesh& mesh_;
  std::unique_ptr<LinearSolver<double>> poisson_;
};

}  // namespace

namespace detail {

template <class T>
void optimise_globally(const Mesh& mesh, const Geometry<T>& geometry, const GlobalOptions& options, bool fix_rho,
                       Connection<T>& c, LiftedResiduals<T>& r) {
  validate(options);
  // A float solve gains about five digits before its rounding shows; less than one digit means it is of no use here.
  constexpr double float_reduction = 1e-5, useful_reduction = 0.1;

  const HalfedgeWeights<T> weights(mesh, geometry, options);
  const FaceStates<T> states{mesh, geometry, weights, options.detail, c.tau, r};
  const auto coefficients = [&](const auto& first, auto& out) { states.coefficients(first, out); };
  const LargeArray<double> u_memory(3 * static_cast<std::size_t>(mesh.edges()));
  const LargeArray<double> x(static_cast<std::size_t>(mesh.halfedges()));
  ValuesOut u(u_memory.data(), 3, mesh.edges());
  parallel_for(mesh.edges(), [&](std::int64_t e) { u.col(e).setZero(); });
  {
    const FacePairs faces = fix_rho ? single_faces(mesh) : pair_faces(mesh, geometry);
    CorrectionSystem<float> system(mesh, faces, coefficients, fix_rho);
    std::optional<CorrectionSystem<double>> full_system;  // only where float does not do
    std::optional<HeldRho> held;
    if (fix_rho) held.emplace(mesh, geometry);

    const double tolerance = std::max(options.tolerance, 4.0 * double(std::numeric_limits<T>::epsilon()));
    const LargeArray<double> parts_memory(6 * static_cast<std::size_t>(faces.outer));
    ValuesOut parts(parts_memory.data(), 3, 2 * std::int64_t{faces.outer});
    const auto rhs = [&](Index i) {
      std::array<double, 3> pull = pull_on(parts, i, mesh.boundary_halfedge(mesh.halfedge(faces.edge[at(i)])));
      if (fix_rho) pull[2] = 0;
      return pull;
    };
    const auto improve = [&](const auto& solved) {
      parallel_for(faces.outer, [&](std::int64_t i) {
        const auto gain = solved.solution(static_cast<Index>(i));
        for (Eigen::Index k = 0; k < 3; ++k) u(k, faces.edge[at(i)]) += double(gain[static_cast<std::size_t>(k)]);
      });
    };
    double first = 0, last = 0;
    c.report.iterations = 0;
    for (int round = 0;; ++round) {
      states.pull(system, faces, u, parts, x.data());
      // Measured through the preconditioner; float is enough for a norm.
      const double square = system.start(rhs);
      const double norm = std::sqrt(std::max(0.0, square));
      if (round == 0) first = norm;
      // Where the start is already the optimum (a flat piece) the gradient is rounding and nothing is left to do.
      const double floor = double(std::numeric_limits<T>::epsilon()) * std::sqrt(double(mesh.halfedges()));
      c.report.residual = first > floor ? norm / first : 0.0;
      const int left = options.max_iterations - c.report.iterations;
      if (c.report.residual <= tolerance || left <= 0) break;
      if (round > 0 && norm > useful_reduction * last) {
        if (full_system) break;  // full precision has reached its own rounding
        full_system.emplace(mesh, faces, coefficients, fix_rho);
      }
      last = norm;
      const double wanted = 0.5 * tolerance / c.report.residual;
      if (held) {
        const VectorX<T> nothing;
        const LiftedResiduals<T> nowhere;
        const FaceStates<T> rest{mesh, geometry, weights, options.detail, nothing, nowhere, true};
        VectorX<double> moved(mesh.halfedges());
        EdgeValues gradient(3, mesh.edges());
        parallel_for(mesh.edges(), [&](std::int64_t e) {
          const auto pull = rhs(static_cast<Index>(e));
          for (Eigen::Index k = 0; k < 3; ++k) gradient(k, e) = pull[static_cast<std::size_t>(k)];
        });
        const auto product = [&](EdgeValues& direction) {
          EdgeValues out(3, mesh.edges());
          ValuesOut turned(direction.data(), 3, mesh.edges());
          rest.pull(system, faces, turned, parts, moved.data());
          parallel_for(mesh.edges(), [&](std::int64_t e) {
            const auto pull = rhs(static_cast<Index>(e));
            out(0, e) = -pull[0];
            out(1, e) = -pull[1];
            out(2, e) = 0;
          });
          return out;
        };
        c.report.iterations += held->solve(system, gradient, std::max(1e-8, wanted), left, product, u);
      } else if (full_system) {
        c.report.iterations += conjugate_gradients(*full_system, full_system->start(rhs), wanted, left);
        improve(*full_system);
      } else {
        c.report.iterations += conjugate_gradients(system, square, std::max(float_reduction, wanted), left);
        improve(system);
      }
    }
    c.report.converged = c.report.residual <= tolerance;
  }
  c.report.message.clear();
  if (!c.report.converged)
    c.report.message = "the global connection stopped after " + std::to_string(c.report.iterations) +
                       " iterations above its tolerance; raise max_iterations, tolerance or detail";

  // The frame of a vertex may be turned without a change of energy. The one that is kept turns the directions of the
  // vertex's faces by 0 on average, whichever way the iteration took.
  VectorX<double> turn(mesh.vertices());
  parallel_for(mesh.vertices(), [&](std::int64_t v) {
    double sum = 0, weight = 0;
    if (!fix_rho)
      mesh.for_each_outgoing(static_cast<Index>(v), [&](Index h) {
        sum += double(geometry.angle(h)) * x[at(h)];
        weight += double(geometry.angle(h));
      });
    turn[v] = weight > 0 ? sum / weight : 0.0;
  });
  parallel_for(mesh.faces(), [&](std::int64_t t) {
    const Index h = static_cast<Index>(3 * t);
    for (Index k = 0; k < 3; ++k) {
      const Index e = mesh.edge(h + k);
      const double here = x[at(h + k)];
      c.rho_t[h + k] += static_cast<T>(here - turn[mesh.tail(h + k)]);
      r.start[h + k] += static_cast<T>(here);
      r.end[h + k] += static_cast<T>(x[at(h + (k + 1) % 3)]);
      if (!fix_rho && mesh.canonical(h + k)) {
        c.rho[e] += static_cast<T>(u(2, e) - turn[mesh.tail(h + k)] + turn[mesh.tip(h + k)]);
        c.eps[e] += static_cast<T>(u(2, e));
      }
    }
  });
  parallel_for(mesh.edges(), [&](std::int64_t e) {
    const auto [at_tail, at_tip] = edge_correction(mesh, weights, r, static_cast<Index>(e));
    const Index h = mesh.halfedge(static_cast<Index>(e)), g = mesh.twin(h);
    c.rho_e[2 * e] += at_tail - static_cast<T>(turn[mesh.tail(h)]);
    c.rho_e[2 * e + 1] += at_tip - static_cast<T>(turn[mesh.tip(h)]);
    c.eps[e] += at_tip - at_tail;
    r.start[h] -= at_tail;
    r.end[h] -= at_tip;
    if (g != none) {
      r.end[g] -= at_tail;
      r.start[g] -= at_tip;
    }
  });
  close_faces(mesh, geometry, weights, r, c);
}

template void optimise_globally(const Mesh&, const Geometry<float>&, const GlobalOptions&, bool, Connection<float>&,
                                LiftedResiduals<float>&);
template void optimise_globally(const Mesh&, const Geometry<double>&, const GlobalOptions&, bool, Connection<double>&,
                                LiftedResiduals<double>&);

}  // namespace detail

template <class T>
void measure_deviation(const Mesh& mesh, const Geometry<T>& geometry, const GlobalOptions& options, Connection<T>& c) {
  validate(options);
  deviation(mesh, geometry, HalfedgeWeights<T>(mesh, geometry, options), c);
}

template void measure_deviation(const Mesh&, const Geometry<float>&, const GlobalOptions&, Connection<float>&);
template void measure_deviation(const Mesh&, const Geometry<double>&, const GlobalOptions&, Connection<double>&);

}  // namespace alcap
