// SPDX-License-Identifier: MIT
//
// register.cpp: the names of PETSc's backends, one line each.
#include <memory>
#include <utility>

#include "alcap/petsc.h"
#include "solvers/petsc/eigen.h"
#include "solvers/petsc/session.h"

namespace alcap {
namespace {

using detail::petsc::Kind;
using detail::petsc::Method;

BackendRegistration add(const std::string& name, Kind kind, const std::string& options) {
  return register_linear_solver(name, [=](const SolverOptions& solver_options) {
    return detail::petsc::make_solver(kind, name, options, solver_options);
  });
}

BackendRegistration add(const std::string& name, Method method) {
  return register_eigen_solver(name, [=](const EigenProblem& problem, const EigenOptions& options) {
    return detail::petsc::smallest(method, problem, options);
  });
}

}  // namespace

std::vector<BackendRegistration> register_petsc_backends(const std::string& options) {
  std::vector<BackendRegistration> all;
  all.push_back(add("petsc-cg-gamg", Kind::cg_gamg, ""));
  all.push_back(add("petsc-mumps", Kind::mumps, ""));
  all.push_back(add("petsc", Kind::options, options));
  all.push_back(add("slepc-krylovschur", Method::krylovschur));
  all.push_back(add("slepc-lobpcg", Method::lobpcg));
  all.push_back(add("slepc-gd", Method::gd));
  all.push_back(add("slepc-jd", Method::jd));
  return all;
}

BackendRegistration register_petsc_solver(const std::string& name, const std::string& options) {
  return add(name, Kind::options, options);
}

}  // namespace alcap
