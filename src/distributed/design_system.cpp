// SPDX-License-Identifier: MIT
#include "src/distributed/design_system.h"

#include <algorithm>
#include <cmath>

#include "src/base/array.h"
#include "src/design/variational/free_fields.h"
#include "src/design/variational/real_rows.h"
#include "src/distributed/linear.h"

namespace alcap::detail::distributed {
namespace {

using Vector = ComplexVectorX<double>;

/// An exact row on the rank that has it, and its number among those of all ranks.
struct ExactRow {
  const ControlRow* row;
  Eigen::Index number;
};

/// What of a component is asked for and held, over all ranks.
struct Hold {
  std::int64_t targets = 0, directions = 0, lengths = 0;
  [[nodiscard]] bool held() const { return directions + lengths > 0; }
};

class System {
 public:
  System(const Stage& stage, const Matrices& matrices, const std::vector<LocalControl>& controls,
         const DesignTerms& terms, const DistributedDesignOptions& options)
      : stage_(stage), patch_(stage.patch), M_(matrices.M), controls_(controls), terms_(terms), options_(options) {
    check(MatDuplicate(matrices.S.get(), MAT_COPY_VALUES, S2_.out()));
    check(MatScale(S2_.get(), 2));
    hold_unused();
    find_holds();
    collect_exact_rows();
    if (terms.mass_weight == 0) find_parallel();
  }

  DesignSolution solve() {
    LinearSystem system(make_matrix(), M_.get(), options_.tolerance, options_.max_iterations);
    DesignSolution out{Vector::Zero(patch_.owned), static_cast<int>(count_), 0, 0, 0, system.name()};
    const Vector load = make_load();
    Vector pull = Vector::Zero(patch_.owned);  // R' mu
    system.solve(load, out.u);
    if (count_ > 0) {
      const Vector mu = multipliers_of(system, out.u);
      pull = adjoint(mu);
      Vector push;
      system.solve(pull, push);
      out.u -= push;
    }
    Vector rest;
    system.multiply(out.u, rest);
    rest += pull - load;
    const double size = norm(load) + norm(pull);
    if (size > 0) out.residual = norm(rest) / size;
    out.solves = system.solves() + probe_solves_;
    out.iterations = system.iterations() + probe_iterations_;
    return out;
  }

 private:
  [[nodiscard]] double unit() const { return guidance_unit(terms_.n, terms_.total_area); }
  [[nodiscard]] Index component_of(Index v) const { return stage_.components.of_vertex[at(v)]; }
  [[nodiscard]] std::size_t components() const { return stage_.components.list.size(); }

  /// Ones for vertices that no face uses: they stay zero.
  void hold_unused() {
    for (Index v = 0; v < patch_.owned; ++v) {
      const PetscInt row = patch_.row[at(v)];
      if (component_of(v) == none) check(MatSetValue(S2_.get(), row, row, 1, ADD_VALUES));
    }
    assemble_end(S2_.get());
  }

  static void assemble_end(Mat A) {
    check(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY));
  }

  void find_holds() {
    std::vector<std::int64_t> counts(3 * components(), 0);
    for (const LocalControl& c : controls_) {
      if (!c.load.parts.empty()) ++counts[3 * at(c.component)];
      for (const ControlRow& row : c.load.rows)
        ++counts[3 * at(component_of(row.vertex[0])) + (row.direction_only ? 1 : 2)];
    }
    sum_all(counts);
    for (std::size_t k = 0; k < components(); ++k)
      holds_.push_back({counts[3 * k], counts[3 * k + 1], counts[3 * k + 2]});
  }

  void collect_exact_rows() {
    // In the order of the controls, and of their rows, which may be those of several ranks.
    std::vector<std::int64_t> sizes(controls_.size(), 0);
    for (std::size_t k = 0; k < controls_.size(); ++k)
      if (!controls_[k].load.soft()) sizes[k] = count_of(controls_[k].load.rows);
    sum_all(sizes);
    for (std::size_t k = 0; k < controls_.size(); ++k) {
      const LocalControl& c = controls_[k];
      for (std::size_t i = 0; i < c.load.rows.size() && !c.load.soft(); ++i)
        exact_.push_back(
            {&c.load.rows[i], count_ + (c.row_order.empty() ? static_cast<Eigen::Index>(i) : c.row_order[i])});
      count_ += sizes[k];
    }
  }

  /// x' M x of every component.
  [[nodiscard]] std::vector<double> sizes(const Vector& x) const {
    const Vector Mx = mass_times(x);
    std::vector<double> out(components(), 0);
    for (Index v = 0; v < patch_.owned; ++v)
      if (component_of(v) != none) out[at(component_of(v))] += (std::conj(x[v]) * Mx[v]).real();
    sum_all(out);
    return out;
  }

  [[nodiscard]] Vector mass_times(const Vector& x) const {
    Vector y(patch_.owned);
    petsc::OwnedVec in, out;
    PetscInt all = 0;
    check(MatGetSize(M_.get(), &all, nullptr));
    check(VecCreateMPIWithArray(PETSC_COMM_WORLD, 1, patch_.owned, all, x.data(), in.out()));
    check(VecCreateMPIWithArray(PETSC_COMM_WORLD, 1, patch_.owned, all, y.data(), out.out()));
    check(MatMult(M_.get(), in.get(), out.get()));
    return y;
  }

  /// Which components have parallel fields: inverse iteration, as Designer::State::find_parallel().
  void find_parallel() {
    petsc::OwnedMat lifted;
    check(MatDuplicate(S2_.get(), MAT_COPY_VALUES, lifted.out()));
    check(MatAXPY(lifted.get(), probe_lift * unit(), M_.get(), SAME_NONZERO_PATTERN));
    check(MatSetOption(lifted.get(), MAT_HERMITIAN, PETSC_TRUE));
    constexpr double digits = 1e-6;  // of an energy that is to be told from nothing
    LinearSystem probe(std::move(lifted), M_.get(), digits, options_.max_iterations);
    Vector x = Vector::Ones(patch_.owned), y;
    std::vector<double> size;
    for (int round = 0; round < singular_probes; ++round) {
      size = sizes(x);
      Vector b = mass_times(x);
      for (Index v = 0; v < patch_.owned; ++v)
        if (component_of(v) != none) b[v] /= std::sqrt(size[at(component_of(v))]);
      probe.solve(b, y);
      x.swap(y);
    }
    size = sizes(x);
    probe_solves_ = probe.solves();
    probe_iterations_ = probe.iterations();
    parallel_.assign(components(), 0);
    for (std::size_t k = 0; k < components(); ++k) {
      const double own = 1 / std::sqrt(std::max(0.0, size[k])) - probe_lift * unit();
      parallel_[k] = own * stage_.components.list[k].area > parallel_energy ? 0 : 1;  // also where nothing can be told
      if (parallel_[k] == 0) continue;
      if (holds_[k].targets > 0 && !holds_[k].held()) throw_undetermined(terms_.guidance_weight, k);
      singular_ = true;
    }
    if (singular_) anchor_ = mean_diagonal();
  }

  [[nodiscard]] double mean_diagonal() const {
    const LocalRows rows(S2_.get());
    double total = 0;
    for (PetscInt i = 0; i < rows.rows; ++i)
      for (PetscInt e = rows.own.start[i]; e < rows.own.start[i + 1]; ++e)
        if (rows.own.column[e] == i) total += rows.own.value[e].real();
    return sum(total) / static_cast<double>(sum(std::int64_t{patch_.owned}));
  }

  /// What holds parallel fields that no row with a length does, as Designer::State::hold_kernel(). Where nothing is
  /// asked for the field is zero, and any weight will do.
  [[nodiscard]] double kernel_weight(std::size_t k) const {
    if (parallel_.empty() || parallel_[k] == 0 || holds_[k].lengths > 0) return 0;
    return unit() * (holds_[k].directions > 0 ? free_length : 1);
  }

  [[nodiscard]] petsc::OwnedMat make_matrix() const {
    petsc::OwnedMat A;
    check(MatDuplicate(S2_.get(), MAT_COPY_VALUES, A.out()));
    if (terms_.mass_weight != 0) check(MatAXPY(A.get(), terms_.mass_weight, weighted().get(), SAME_NONZERO_PATTERN));
    if (singular_) {
      Vector weights = Vector::Zero(patch_.owned);
      for (Index v = 0; v < patch_.owned; ++v)
        if (component_of(v) != none) weights[v] = kernel_weight(at(component_of(v)));
      check(MatAXPY(A.get(), 1, scaled(weights, false).get(), SAME_NONZERO_PATTERN));
    }
    const auto add_row = [&](const ControlRow& row, double weight) {
      row.add_product(weight, [&](Index i, Index j, C value) {
        check(MatSetValue(A.get(), patch_.row[at(i)], patch_.row[at(j)], value, ADD_VALUES));
      });
    };
    for (const LocalControl& c : controls_)
      if (c.load.soft())
        for (const ControlRow& row : c.load.rows) add_row(row, row.weight);
    if (singular_)
      for (const ExactRow& e : exact_) add_row(*e.row, anchor_);
    assemble_end(A.get());
    check(MatSetOption(A.get(), MAT_HERMITIAN, PETSC_TRUE));
    return A;
  }

  /// M with its rows, and perhaps its columns, scaled.
  [[nodiscard]] petsc::OwnedMat scaled(const Vector& by, bool columns) const {
    petsc::OwnedMat out;
    petsc::OwnedVec factors;
    PetscInt all = 0;
    check(MatDuplicate(M_.get(), MAT_COPY_VALUES, out.out()));
    check(MatGetSize(M_.get(), &all, nullptr));
    check(VecCreateMPIWithArray(PETSC_COMM_WORLD, 1, patch_.owned, all, by.data(), factors.out()));
    check(MatDiagonalScale(out.get(), factors.get(), columns ? factors.get() : nullptr));
    return out;
  }
  [[nodiscard]] petsc::OwnedMat weighted() const {
    const Vector roots = terms_.vertex_weights.size() > 0 ? Vector(terms_.vertex_weights.cwiseSqrt().cast<C>())
                                                          : Vector(Vector::Ones(patch_.owned));
    return scaled(roots, true);
  }

  /// Values that this rank adds at local vertices, brought to those who own them.
  [[nodiscard]] Vector gathered(Vector local) const {
    patch_.ring.reduce(local.data() + patch_.owned, local.data(), MPI_SUM);
    return local.head(patch_.owned);
  }

  [[nodiscard]] Vector make_load() const {
    Vector b = Vector::Zero(patch_.inner);
    const auto add = [&](Index v, C value) { b[v] += value; };
    for (const LocalControl& c : controls_) {
      c.load.add_target(patch_.mesh, c.load.density, add);
      if (c.load.soft())
        for (const ControlRow& row : c.load.rows) row.add_adjoint(row.weight * row.target, add);
    }
    if (singular_)
      for (const ExactRow& e : exact_)
        if (!e.row->direction_only) e.row->add_adjoint(anchor_ * e.row->target, add);
    Vector load = gathered(std::move(b));
    if (terms_.u0.size() == 0) return load;
    Vector guided = terms_.u0;
    const bool weights = terms_.vertex_weights.size() > 0;
    if (weights) guided = guided.cwiseProduct(terms_.vertex_weights.cwiseSqrt().cast<C>());
    guided = mass_times(guided);
    if (weights) guided = guided.cwiseProduct(terms_.vertex_weights.cwiseSqrt().cast<C>());
    return load + terms_.guidance_scale * guided;
  }

  /// R u of all exact rows, on every rank.
  [[nodiscard]] Vector values_of_rows(const Vector& u) const {
    Vector inner(patch_.inner), values = Vector::Zero(count_);
    inner.head(patch_.owned) = u;
    patch_.extend(inner.data());
    for (const ExactRow& e : exact_) values[e.number] = e.row->at(inner);
    sum_all({reinterpret_cast<double*>(values.data()), at(2 * values.size())});
    return values;
  }

  /// R' mu.
  [[nodiscard]] Vector adjoint(const Vector& mu) const {
    Vector b = Vector::Zero(patch_.inner);
    for (const ExactRow& e : exact_) e.row->add_adjoint(mu[e.number], [&](Index v, C value) { b[v] += value; });
    return gathered(std::move(b));
  }

  /// One solve for each row; of its solution only what the rows see is kept.
  Vector multipliers_of(LinearSystem& system, const Vector& u) const {
    MatrixX<C> response(count_, count_);
    Vector column;
    for (Eigen::Index k = 0; k < count_; ++k) {
      system.solve(adjoint(Vector::Unit(count_, k)), column);
      response.col(k) = values_of_rows(column);
    }
    struct Plain {
      Eigen::Index number;
      double re, im, weight;
      int direction_only;
    };
    std::vector<Plain> mine;
    for (const ExactRow& e : exact_)
      mine.push_back(
          {e.number, e.row->target.real(), e.row->target.imag(), e.row->weight, e.row->direction_only ? 1 : 0});
    std::vector<Plain> all = gather_all(mine);
    std::ranges::sort(all, {}, &Plain::number);
    std::vector<RowFunctional> real;
    for (const Plain& p : all) {
      ControlRow row;
      row.target = {p.re, p.im};
      row.weight = p.weight;
      row.direction_only = p.direction_only != 0;
      append_real_rows(row, p.number, singular_ ? anchor_ : 0, real);
    }
    VectorX<double> mu = multipliers(real, response, values_of_rows(u));
    share_from_first({mu.data(), at(mu.size())});
    return complex_multipliers(real, mu, count_);
  }

  const Stage& stage_;
  const Patch& patch_;
  const petsc::OwnedMat& M_;
  const std::vector<LocalControl>& controls_;
  const DesignTerms& terms_;
  const DistributedDesignOptions& options_;
  petsc::OwnedMat S2_;          // with ones for vertices that no face uses
  std::vector<Hold> holds_;     // per component
  std::vector<char> parallel_;  // per component; empty where the mass holds all fields
  std::vector<ExactRow> exact_;
  Eigen::Index count_ = 0;  // of the exact rows of all ranks
  bool singular_ = false;
  double anchor_ = 0;
  int probe_solves_ = 0, probe_iterations_ = 0;
};

}  // namespace

std::vector<char> touched_components(const Stage& stage, const std::vector<LocalControl>& controls) {
  std::vector<std::int64_t> counts(stage.components.list.size(), 0);
  for (const LocalControl& c : controls) {
    if (c.component != none) ++counts[at(c.component)];
    for (const ControlRow& row : c.load.rows) ++counts[at(stage.components.of_vertex[at(row.vertex[0])])];
  }
  sum_all(counts);
  std::vector<char> touched;
  for (const std::int64_t c : counts) touched.push_back(c > 0 ? 1 : 0);
  return touched;
}

DesignSolution solve_design(const Stage& stage, const Matrices& matrices, const std::vector<LocalControl>& controls,
                            const DesignTerms& terms, const DistributedDesignOptions& options) {
  if (controls.empty() && terms.u0.size() == 0) throw_nothing_asked();
  return System(stage, matrices, controls, terms, options).solve();
}

}  // namespace alcap::detail::distributed
