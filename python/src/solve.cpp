// SPDX-License-Identifier: MIT
//
// solve.cpp: linear solvers and eigensolvers.
#include "alcap/solve.h"

#include <mutex>

#include "python/src/arrays.h"
#include "python/src/bindings.h"
#include "python/src/long_call.h"
#include "python/src/options.h"

namespace alcap::python {

ControlTolerances tolerances_of(const py::object& tolerances) {
  const auto number = [&](const char* name) {
    return as<double>(tolerances.attr(name), std::string("tolerances.") + name);
  };
  return {.singularity_degrees = number("singularity_degrees"),
          .fixed_degrees = number("fixed_degrees"),
          .stroke_degrees = number("stroke_degrees"),
          .boundary_degrees = number("boundary_degrees"),
          .cone_degrees = number("cone_degrees"),
          .fixed_value = number("fixed_value"),
          .pin_length = number("pin_length")};
}

EigenOptions eigen_of(const py::dict& d) {
  EigenOptions out;
  for (const auto& [key, value] : d) {
    const auto name = key.cast<std::string>();
    if (name == "tolerance") {
      if (!value.is_none()) out.tolerance = as<double>(value, name);
    } else if (name == "angle_tolerance") {
      out.angle_tolerance = as<double>(value, name);
    } else if (name == "degree") {
      out.degree = as<int>(value, name);
    } else if (name == "solver") {
      out.solver = as<std::string>(value, name);
    } else if (name == "method") {
      out.method = as<std::string>(value, name);
    } else if (name == "max_iterations") {
      out.max_iterations = as<int>(value, name);
    } else if (name == "seed") {
      out.seed = as<std::uint64_t>(value, name);
    } else if (name == "prove_smallest") {
      const auto text = as<std::string>(value, name);
      const std::optional<Prove> prove = from_name<Prove>(text);
      if (!prove) throw OptionError(name, text, "must be 'auto', 'always' or 'never'");
      out.prove_smallest = *prove;
    } else {
      throw OptionError(name, py::str(py::reinterpret_borrow<py::object>(value)).cast<std::string>(),
                        "is not an option of an eigensolver");
    }
  }
  return out;
}

py::dict eigen_dict(const EigenReport& r) {
  return py::dict(
      "solver"_a = r.solver, "converged"_a = r.converged, "iterations"_a = r.iterations, "lambda"_a = r.lambda,
      "next"_a = r.next ? py::object(py::float_(*r.next)) : py::none(), "residual"_a = r.residual,
      "energy_residual"_a = r.energy_residual, "distance"_a = r.distance,
      "angle"_a = r.angle ? py::object(py::float_(*r.angle)) : py::none(),
      "angle_check"_a = std::string(name(r.angle_check)),
      "angle_at_vertices"_a = r.angle_at_vertices ? py::object(py::float_(*r.angle_at_vertices)) : py::none(),
      "smallest"_a = std::string(name(r.smallest)),
      "lower_bound"_a = r.lower_bound ? py::object(py::float_(*r.lower_bound)) : py::none(),
      "smallest_note"_a = r.smallest_note, "seconds"_a = r.seconds, "proof_seconds"_a = r.proof_seconds,
      "message"_a = r.message);
}

py::dict solve_dict(const SolveReport& r) {
  return py::dict("solver"_a = r.solver, "converged"_a = r.converged, "iterations"_a = r.iterations,
                  "residual"_a = r.residual, "analyse_seconds"_a = r.analyse_seconds,
                  "factorise_seconds"_a = r.factorise_seconds, "solve_seconds"_a = r.solve_seconds,
                  "factor_nonzeros"_a = r.factor_nonzeros);
}

namespace {

using C = Complex<double>;
using Columns = Eigen::Map<MatrixX<C>>;
using ConstColumns = Eigen::Map<const MatrixX<C>>;

/// A factorised matrix. One call at a time; a mutex sees to it.
class Factorised {
 public:
  Factorised(const py::tuple& A, const SolverOptions& options) : A_(sparse_of(A, "A")) {
    long_call(py::none(), 0, [&] {
      solver_ = make_linear_solver<C>(options);
      solver_->analyse(A_);
      solver_->factorise(A_);
    });
  }
  [[nodiscard]] py::tuple solve(const py::array_t<C, py::array::f_style | py::array::forcecast>& B) {
    if (B.ndim() != 2 || B.shape(0) != A_.rows()) throw OptionError("B", B.size(), "must have a row per row of A");
    py::array_t<C, py::array::f_style> X({B.shape(0), B.shape(1)});
    const ConstColumns b(B.data(), B.shape(0), B.shape(1));
    Columns x(X.mutable_data(), B.shape(0), B.shape(1));
    SolveReport report = watched(py::none(), 0, [&] {
      const std::lock_guard lock(mutex_);
      SolveReport r = solver_->solve(b, x);
      r.residual = residual<C>(A_, x, b);
      return r;
    });
    return py::make_tuple(X, solve_dict(report));
  }
  [[nodiscard]] std::string name() const { return solver_->name(); }

 private:
  SparseMatrix<C> A_;
  std::unique_ptr<LinearSolver<C>> solver_;
  std::mutex mutex_;
};

}  // namespace

py::tuple modes_tuple(EigenModes r) {
  py::dict d("solver"_a = r.solver, "converged"_a = r.converged, "iterations"_a = r.iterations,
             "residual"_a = moved(std::move(r.residual)), "cluster"_a = r.cluster,
             "smallest"_a = std::string(name(r.smallest)), "seconds"_a = r.seconds, "message"_a = r.message);
  py::array_t<C, py::array::f_style> U({r.U.rows(), r.U.cols()});
  Columns(U.mutable_data(), r.U.rows(), r.U.cols()) = r.U;
  return py::make_tuple(moved(std::move(r.lambda)), U, d);
}

void bind_solve(py::module_& m) {
  py::class_<Factorised>(m, "Factorised", "A factorised Hermitian positive definite matrix, see factorise().")
      .def("_solve", &Factorised::solve)
      .def_property_readonly("name", &Factorised::name, "str: the backend and its choices.");
  m.def("factorise",
        [](const py::tuple& A, const std::string& solver, int right_hand_sides, double tolerance, int max_iterations) {
          return std::make_unique<Factorised>(A, SolverOptions{.name = solver,
                                                               .right_hand_sides = right_hand_sides,
                                                               .tolerance = tolerance,
                                                               .max_iterations = max_iterations});
        });
  m.def("linear_solvers", &linear_solvers);
  m.def("eigen_solvers", &eigen_solvers);
  m.def("smallest_eigenpair", [](const py::tuple& S, const py::tuple& M, double area, const py::dict& options,
                                 const py::object& progress, int threads) {
    const auto s = sparse_of(S, "S"), mass = sparse_of(M, "M");
    if (s.rows() != mass.rows()) throw OptionError("M", mass.rows(), "must have as many rows as S");
    const EigenOptions how = eigen_of(options);
    EigenResult r = watched(progress, threads, [&] { return smallest_eigenpair(s, mass, area, how); });
    return py::make_tuple(moved(std::move(r.u)), eigen_dict(r.report));
  });
  m.def("eigenpairs", [](const py::tuple& S, const py::tuple& M, double area, int count, const py::dict& options,
                         const py::object& progress, int threads) {
    const auto s = sparse_of(S, "S"), mass = sparse_of(M, "M");
    const EigenOptions how = eigen_of(options);
    EigenModes r = watched(progress, threads, [&] { return eigenpairs(s, mass, area, count, how); });
    return modes_tuple(std::move(r));
  });
  m.def("inertia", [](const py::tuple& S, const py::tuple& M, double sigma, const py::object& progress, int threads) {
    const auto s = sparse_of(S, "S"), mass = sparse_of(M, "M");
    return watched(progress, threads, [&] { return inertia(s, mass, sigma); }).below;
  });
}

}  // namespace alcap::python
