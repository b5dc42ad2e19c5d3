// SPDX-License-Identifier: MIT
#include "src/design/eigen/pins.h"

#include <cmath>

namespace alcap::detail {
namespace {

using C = Complex<double>;

// What is left of a pin's coefficients, which are about 1, when the others imply it.
constexpr double implied = 1e-9;

std::vector<RealRow> pinned(const std::vector<RealRow>& rows, const SparseMatrix<C>& transposed) {
  std::vector<RealRow> out;
  for (const RealRow& row : rows) {
    // Re(conj(a) t v) = Re(conj(a conj(t)) v)
    std::map<Index, C> sum;
    for (std::size_t k = 0; k < row.vertex.size(); ++k)
      for (SparseMatrix<C>::InnerIterator it(transposed, row.vertex[k]); it; ++it)
        sum[static_cast<Index>(it.row())] += row.coefficient[k] * std::conj(it.value());
    RealRow& next = out.emplace_back();
    for (const auto& [v, coefficient] : sum) next.add(v, coefficient);
  }
  return out;
}

}  // namespace

template <class Scalar>
void ZeroSpace<Scalar>::demand(const std::vector<Term>& terms) {
  Sum row;
  for (const auto& [unknown, coefficient] : terms) {
    const auto known = solved_.find(unknown);
    if (known == solved_.end()) {
      row[unknown] += coefficient;
      continue;
    }
    for (const auto& [v, factor] : known->second) row[v] += coefficient * factor;
  }
  auto largest = row.end();
  for (auto it = row.begin(); it != row.end(); ++it)
    if (largest == row.end() || std::abs(it->second) > std::abs(largest->second)) largest = it;
  if (largest == row.end() || !(std::abs(largest->second) > implied)) return;
  const auto [eliminated, pivot] = *largest;
  row.erase(largest);
  for (auto& [v, factor] : row) {
    factor /= -pivot;
    used_.insert(v);
  }
  if (used_.erase(eliminated) > 0)
    for (auto& [v, sum] : solved_) {
      const auto here = sum.find(eliminated);
      if (here == sum.end()) continue;
      const Scalar factor = here->second;
      sum.erase(here);
      for (const auto& [other, part] : row) sum[other] += factor * part;
    }
  solved_[eliminated] = std::move(row);
}

template <class Scalar>
SparseMatrix<Scalar> ZeroSpace<Scalar>::basis() const {
  std::vector<Index> column(static_cast<std::size_t>(unknowns_), none);
  Index columns = 0;
  for (Index v = 0; v < unknowns_; ++v)
    if (solved_.count(v) == 0) column[static_cast<std::size_t>(v)] = columns++;
  std::vector<Eigen::Triplet<Scalar, Index>> entries;
  for (Index v = 0; v < unknowns_; ++v)
    if (column[static_cast<std::size_t>(v)] != none)
      entries.emplace_back(v, column[static_cast<std::size_t>(v)], Scalar(1));
  for (const auto& [v, sum] : solved_)
    for (const auto& [other, factor] : sum) entries.emplace_back(v, column[static_cast<std::size_t>(other)], factor);
  SparseMatrix<Scalar> T(unknowns_, columns);
  T.setFromTriplets(entries.begin(), entries.end());
  return T;
}

template class ZeroSpace<double>;
template class ZeroSpace<Complex<double>>;

DesignRows pinned_rows(const DesignRows& rows, const SparseMatrix<C>& basis) {
  SparseMatrix<C> transposed;  // assigned: Eigen's constructors leak where memory runs out in the middle of them
  transposed = basis.transpose();
  DesignRows out{.across = pinned(rows.across, transposed), .along = pinned(rows.along, transposed)};
  if (rows.follow.size() > 0) out.follow = basis.adjoint() * rows.follow;
  return out;
}

}  // namespace alcap::detail
