// SPDX-License-Identifier: MIT
//
// backends.cpp: callables of Python as linear backends and eigensolvers.
#include "alcap/backends.h"

#include "python/src/arrays.h"
#include "python/src/bindings.h"
#include "python/src/options.h"

namespace alcap::python {
namespace {

/// A Python object that threads without the interpreter's lock may copy and drop.
std::shared_ptr<py::object> held(py::object object) {
  return {new py::object(std::move(object)), [](py::object* p) {
            const py::gil_scoped_acquire lock;
            delete p;
          }};
}

/// factory(data, indices, indptr, shape) returns solve(B), B and the result (#V, k).
template <class Scalar>
class Callable final : public LinearSolver<Scalar> {
 public:
  Callable(std::string name, std::shared_ptr<py::object> factory)
      : name_(std::move(name)), factory_(std::move(factory)) {}
  void analyse(const SparseMatrix<Scalar>&) override {}
  void factorise(const SparseMatrix<Scalar>& A) override {
    const py::gil_scoped_acquire lock;
    solve_ = held((*factory_)(*sparse(SparseMatrix<Scalar>(A))));
  }
  SolveReport solve(const Eigen::Ref<const MatrixX<Scalar>>& B, Eigen::Ref<MatrixX<Scalar>> X) const override {
    const py::gil_scoped_acquire lock;
    py::array_t<Scalar, py::array::f_style> b({B.rows(), B.cols()});
    Eigen::Map<MatrixX<Scalar>>(b.mutable_data(), B.rows(), B.cols()) = B;
    const py::array_t<Scalar, py::array::f_style | py::array::forcecast> x((*solve_)(b));
    if (x.size() != B.size() || x.shape(0) != B.rows())
      throw SolveError("the solver '" + name_ + "' returned an array of another size than the right-hand sides");
    X = Eigen::Map<const MatrixX<Scalar>>(x.data(), B.rows(), B.cols());
    SolveReport report;
    report.solver = name_;
    report.converged = true;
    return report;
  }
  [[nodiscard]] std::string name() const override { return name_; }

 private:
  std::string name_;
  std::shared_ptr<py::object> factory_, solve_;
};

template <class Scalar>
LinearSolverFactory<Scalar> factory_of(const std::string& name, const std::shared_ptr<py::object>& factory) {
  return [name, factory](const SolverOptions&) { return std::make_unique<Callable<Scalar>>(name, factory); };
}

/// solver(S, M, area, options) returns u (#V,).
EigenSolver eigen_solver(const std::shared_ptr<py::object>& solver) {
  return [solver](const EigenProblem& problem, const EigenOptions& options) {
    const py::gil_scoped_acquire lock;
    py::dict how("tolerance"_a = options.residual_tolerance(), "max_iterations"_a = options.max_iterations,
                 "seed"_a = options.seed);
    using Matrix = SparseMatrix<Complex<double>>;
    const py::object u = (*solver)(sparse(Matrix(problem.S)), sparse(Matrix(problem.M)), problem.area, how);
    EigenResult result;
    result.u = complex_of(u, "u");
    return result;
  };
}

/// A registration that can be ended.
struct Registered {
  std::optional<BackendRegistration> registration;
};

}  // namespace

void bind_backends(py::module_& m) {
  py::class_<Registered>(m, "Registration", "Keeps the name of a backend registered; a context manager.")
      .def(
          "close", [](Registered& r) { r.registration.reset(); }, "Takes the name out again.")
      .def("__enter__", [](const py::object& self) { return self; })
      .def("__exit__", [](Registered& r, const py::args&) { r.registration.reset(); });
  m.def("register_linear_solver", [](const std::string& name, py::object factory) {
    const auto shared_factory = held(std::move(factory));
    return Registered{register_linear_solver(name, factory_of<Complex<double>>(name, shared_factory),
                                             factory_of<double>(name, shared_factory))};
  });
  m.def("register_eigen_solver", [](const std::string& name, py::object solver) {
    return Registered{register_eigen_solver(name, eigen_solver(held(std::move(solver))))};
  });
}

}  // namespace alcap::python
