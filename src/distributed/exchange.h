// SPDX-License-Identifier: MIT
//
// exchange.h: values across ranks by PETSc's star forests: every leaf of this rank is a copy of one root of some rank.
// Internal to src/distributed.
#pragma once

#include <petscsf.h>

#include <array>
#include <complex>
#include <type_traits>
#include <vector>

#include "alcap/distributed.h"
#include "solvers/petsc/session.h"
#include "src/distributed/together.h"

namespace alcap::detail::distributed {

using petsc::check;

/// A place on some rank.
using Node = PetscSFNode;
static_assert(std::is_same_v<PetscInt, Index>);

/// MPI's name of a number, or of an array of them.
template <class T>
struct Unit {
  static MPI_Datatype scalar() {
    if constexpr (std::is_same_v<T, double>) {
      return MPI_DOUBLE;
    } else if constexpr (std::is_same_v<T, Index>) {
      return MPIU_INT;
    } else {
      static_assert(std::is_same_v<T, std::complex<double>>);
      return MPIU_SCALAR;
    }
  }
  Unit() : type(scalar()) {}
  MPI_Datatype type;
};
template <class T, std::size_t K>
struct Unit<std::array<T, K>> {
  Unit() {
    MPI_Type_contiguous(static_cast<int>(K), Unit<T>::scalar(), &type);
    MPI_Type_commit(&type);
  }
  Unit(const Unit&) = delete;
  Unit& operator=(const Unit&) = delete;
  ~Unit() { MPI_Type_free(&type); }
  MPI_Datatype type = MPI_DATATYPE_NULL;
};

class Exchange {
 public:
  Exchange() = default;
  /// `roots` of this rank; leaf k is a copy of the root at leaves[k].
  Exchange(Index roots, const std::vector<Node>& leaves) : roots_(roots), leaves_(static_cast<Index>(leaves.size())) {
    check(PetscSFCreate(PETSC_COMM_WORLD, forest_.out()));
    check(PetscSFSetGraph(forest_.get(), roots, leaves_, nullptr, PETSC_COPY_VALUES, const_cast<Node*>(leaves.data()),
                          PETSC_COPY_VALUES));
    check(PetscSFSetUp(forest_.get()));
  }

  /// Leaves get their roots' values.
  template <class T>
  void fetch(const T* roots, T* leaves) const {
    const Unit<T> unit;
    check(PetscSFBcastBegin(forest_.get(), unit.type, roots, leaves, MPI_REPLACE));
    check(PetscSFBcastEnd(forest_.get(), unit.type, roots, leaves, MPI_REPLACE));
  }
  template <class T>
  [[nodiscard]] std::vector<T> fetch(const std::vector<T>& roots) const {
    std::vector<T> leaves(static_cast<std::size_t>(leaves_));
    fetch(roots.data(), leaves.data());
    return leaves;
  }

  /// Roots take in their leaves' values: MPI_REPLACE, MPI_SUM, MPI_MIN, MPI_MAX.
  template <class T>
  void reduce(const T* leaves, T* roots, MPI_Op op) const {
    const Unit<T> unit;
    check(PetscSFReduceBegin(forest_.get(), unit.type, leaves, roots, op));
    check(PetscSFReduceEnd(forest_.get(), unit.type, leaves, roots, op));
  }

  /// How many leaves each root has.
  [[nodiscard]] std::vector<Index> degrees() const {
    const PetscInt* degree = nullptr;
    check(PetscSFComputeDegreeBegin(forest_.get(), &degree));
    check(PetscSFComputeDegreeEnd(forest_.get(), &degree));
    return {degree, degree + roots_};
  }

  /// The values of all leaves of root 0, then of root 1, ...
  template <class T>
  [[nodiscard]] std::vector<T> gather(const std::vector<T>& leaves, std::size_t total) const {
    std::vector<T> all(total);
    const Unit<T> unit;
    check(PetscSFGatherBegin(forest_.get(), unit.type, leaves.data(), all.data()));
    check(PetscSFGatherEnd(forest_.get(), unit.type, leaves.data(), all.data()));
    return all;
  }

 private:
  petsc::Owned<PetscSF, PetscSFDestroy> forest_;
  Index roots_ = 0, leaves_ = 0;
};

/// Slices of [0, count), and where a number lies in them.
class Slices {
 public:
  explicit Slices(std::int64_t count) : count_(count), ranks_(ranks()) {}
  [[nodiscard]] Index begin(int rank) const { return static_cast<Index>(slice_begin(count_, rank, ranks_)); }
  [[nodiscard]] Index size(int rank) const { return begin(rank + 1) - begin(rank); }
  [[nodiscard]] Node find(Index number) const {
    int r = static_cast<int>(std::int64_t{number} * ranks_ / count_);
    while (begin(r + 1) <= number) ++r;
    while (begin(r) > number) --r;
    return {r, number - begin(r)};
  }
  [[nodiscard]] std::vector<Node> find(const std::vector<Index>& numbers) const {
    std::vector<Node> nodes;
    nodes.reserve(numbers.size());
    for (const Index i : numbers) nodes.push_back(find(i));
    return nodes;
  }

 private:
  std::int64_t count_;
  int ranks_;
};

}  // namespace alcap::detail::distributed
