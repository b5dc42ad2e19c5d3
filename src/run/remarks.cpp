// SPDX-License-Identifier: MIT
#include "src/run/remarks.h"

#include <cmath>

#include "solvers/eigenpair/problem.h"
#include "src/base/numbers.h"

namespace alcap::detail {
namespace {

constexpr std::size_t most_named = 8;

// Two smallest eigenvalues this close together (relative) leave the choice within their span to chance.
constexpr double degenerate_gap = 1e-6;

// So close to each other they are two fields, but noise or another triangulation may exchange them.
constexpr double small_gap = 1e-3;

void remark_smallest(std::span<const EigenReport> eigen, std::vector<Remark>& remarks) {
  Remark refuted{.code = "not_smallest"}, replaced{.code = "solved_again", .warning = false};
  std::string said;
  for (std::size_t c = 0; c < eigen.size(); ++c) {
    const EigenReport& e = eigen[c];
    const bool wrong = e.smallest == Smallest::refuted;
    if (!wrong && (e.smallest == Smallest::not_checked || e.smallest_note.empty())) continue;
    if (!wrong && e.smallest == Smallest::searched) continue;
    Remark& remark = wrong ? refuted : replaced;
    if (remark.count++ == 0 && !wrong) said = e.smallest_note;
    if (remark.first.size() < most_named) remark.first.push_back(static_cast<Index>(c));
  }
  if (refuted.count > 0) {
    refuted.message = "a smoother field exists on " + counted(refuted.count, "component", "components") +
                      ", and was not found; please report this mesh";
    remarks.push_back(std::move(refuted));
  }
  if (replaced.count > 0) {
    replaced.message = said + (replaced.count > 1 ? "; so on " + std::to_string(replaced.count) + " components" : "");
    remarks.push_back(std::move(replaced));
  }
}

void remark_eigen(const FieldOutcome& run, std::vector<Remark>& remarks) {
  Remark failed{.code = "eigen_not_converged"}, degenerate{.code = "not_unique", .warning = false},
      close{.code = "small_gap", .warning = false};
  std::string said;
  for (std::size_t c = 0; c < run.eigen.size(); ++c) {
    const EigenReport& e = run.eigen[c];
    if (!e.converged || !run.reached(e)) {
      if (failed.count++ == 0) said = e.message;
      if (failed.first.size() < most_named) failed.first.push_back(static_cast<Index>(c));
    }
    if (!e.next || *e.next - e.lambda > small_gap * std::abs(*e.next)) continue;
    Remark& remark = *e.next - e.lambda <= degenerate_gap * std::abs(*e.next) ? degenerate : close;
    if (static_cast<std::size_t>(remark.count++) < most_named) remark.first.push_back(static_cast<Index>(c));
  }
  if (failed.count > 0) {
    failed.message = "the eigensolver did not reach the tolerance on " +
                     counted(failed.count, "component", "components") + ": " +
                     (said.empty() ? std::string(not_reached) : said);
    remarks.push_back(std::move(failed));
  }
  if (degenerate.count > 0) {
    degenerate.message =
        "the smallest eigenvalue is multiple (a symmetric surface): the field is one of many equally smooth ones";
    remarks.push_back(std::move(degenerate));
  }
  if (close.count > 0) {
    close.message =
        "a second field is nearly as smooth, to a part in a thousand: which of the two, or of their mixtures, comes "
        "out "
        "hangs on details of the mesh";
    remarks.push_back(std::move(close));
  }
}

}  // namespace

void outcome_remarks(const FieldOutcome& run, std::vector<Remark>& remarks) {
  if (!run.parallel) remarks.push_back(not_parallel(run.n));
  const ConnectionReport& connection = run.connection;
  if (!connection.converged) {
    remarks.push_back({.code = "connection_not_converged",
                       .message = "the connection did not reach its tolerance" +
                                  (connection.message.empty() ? "" : " (" + connection.message + ")") +
                                  "; small GlobalOptions::detail and slivers make it hard"});
  }
  remark_eigen(run, remarks);
  remark_smallest(run.eigen, remarks);
  Remark sums{.code = "index_sum_mismatch"};
  for (std::size_t c = 0; c < run.index_sums.size(); ++c) {
    if (run.index_sums[c].sum == run.index_sums[c].expected) continue;
    if (static_cast<std::size_t>(sums.count++) < most_named) sums.first.push_back(static_cast<Index>(c));
  }
  if (sums.count > 0 && run.finite) {
    sums.message = "the indices do not sum to what topology demands on " +
                   counted(sums.count, "component", "components") + "; please report this mesh";
    remarks.push_back(std::move(sums));
  }
  if (!run.finite) {
    remarks.push_back({.code = "not_finite", .message = "the field has values that are not finite numbers"});
  }
}

}  // namespace alcap::detail
