// SPDX-License-Identifier: MIT
//
// tables_print.cpp: the measured tables as aligned plain text, one block per quantity, one column per connection.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ostream>

#include "apps/alcap/tables/tables.h"

namespace alcap::app {
namespace {

constexpr std::array connections = {"polar", "polar-barycenter", "local", "global"};
constexpr int cell_width = 24;

template <class... Args>
std::string text(const char* format, Args... args) {
  char buffer[160];
  std::snprintf(buffer, sizeof buffer, format, args...);
  return buffer;
}

std::string padded(std::string s, int width) {
  s.resize(std::max(s.size(), static_cast<std::size_t>(width)), ' ');
  return s;
}

/// "0.03142  1.99 [0.0361]": value, observed order, the paper's number.
std::string error_cell(double value, double order, double paper) {
  std::string s = text("%8.5f ", value);
  s += std::isnan(order) ? "     " : text("%5.2f", order);
  if (!std::isnan(paper)) s += text(" [%.4f]", paper);
  return s;
}

/// Without the padding of its last cell.
void print_line(std::ostream& out, std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  out << line << "\n";
}

void print_header(std::ostream& out, const std::string& title) {
  out << "\n" << title << "\n";
  std::string line = padded("  vertices", 12);
  for (const char* c : connections) line += padded(std::string("   ") + c, cell_width);
  print_line(out, line);
}

/// Rows of equal sphere and kind, one line per level; cell(row) is the text of one.
template <class R, class Keep, class Cell>
void print_block(std::ostream& out, const std::string& title, const std::vector<R>& rows, Keep&& keep, Cell&& cell) {
  std::vector<std::int64_t> sizes;
  for (const R& r : rows)
    if (keep(r) && (sizes.empty() || sizes.back() != r.vertices)) sizes.push_back(r.vertices);
  if (sizes.empty()) return;
  print_header(out, title);
  for (const std::int64_t size : sizes) {
    std::string line = padded(text("%10lld", static_cast<long long>(size)), 12);
    for (const char* c : connections) {
      for (const R& r : rows)
        if (keep(r) && r.vertices == size && r.connection == c) line += padded(cell(r), cell_width);
    }
    print_line(out, line);
  }
}

struct Quantity {
  const char* name;
  double OperatorRow::*value;
  double OperatorRow::*order;
  double OperatorRow::*paper;
};
constexpr Quantity quantities[] = {
    {"L2 error of div", &OperatorRow::l2_div, &OperatorRow::order_l2_div, &OperatorRow::paper_l2_div},
    {"L2 error of curl", &OperatorRow::l2_curl, &OperatorRow::order_l2_curl, &OperatorRow::paper_l2_curl},
    {"Linf error of div", &OperatorRow::linf_div, &OperatorRow::order_linf_div, &OperatorRow::paper_linf_div},
    {"Linf error of curl", &OperatorRow::linf_curl, &OperatorRow::order_linf_curl, &OperatorRow::paper_linf_curl},
    {"error of E_D", &OperatorRow::energy, &OperatorRow::order_energy, &OperatorRow::paper_energy}};

}  // namespace

void print_tables(std::ostream& out, const TablesResult& result) {
  const TablesOptions& o = result.options;
  out << "Table I: errors of " << o.fields << " random fields of unit L2 norm, grad Y and n x grad Y of the first "
      << o.harmonics << " harmonics; means.\n"
      << "  Each cell: error, observed order of convergence, [the paper's number].\n"
      << "  L2: sqrt(sum over faces of (integral - exact integral)^2), exact over the spherical triangle.\n"
      << "  Linf: largest |integral - exact integral| / area of the face. E_D: |energy - exact energy|.\n"
      << "  Jittered: vertices moved by up to " << text("%g", o.jitter) << " mean edge lengths. Seed " << o.seed
      << ".\n";
  for (const char* sphere : {"clean", "jittered"}) {
    for (const char* kind : {"edge", "triangle"}) {
      for (const Quantity& q : quantities) {
        print_block(
            out, std::string(q.name) + ", " + kind + "-based, " + sphere + " spheres", result.operators,
            [&](const OperatorRow& r) { return r.sphere == sphere && r.kind == kind; },
            [&](const OperatorRow& r) { return error_cell(r.*q.value, r.*q.order, r.*q.paper); });
      }
    }
    print_block(
        out, std::string("error of E_D of the closed-form basis (matrix S), ") + sphere + " spheres", result.stiffness,
        [&](const StiffnessRow& r) { return r.sphere == sphere; },
        [](const StiffnessRow& r) { return error_cell(r.energy, r.order_energy, r.paper_energy); });
  }

  out << "\n\nTable II: (E_A - E_H) / pi of " << o.fields << " random fields scaled to unit length at every vertex.\n"
      << "  Each cell: mean, standard deviation, [the paper's]. 2 chi is 4 on spheres, 0 on tori.\n"
      << "  'basis' is the exact integral of K |u|^2 over the closed-form basis.\n";
  for (const char* surface : {"clean", "jittered", "torus"}) {
    for (const char* kind : {"edge", "triangle", "basis"}) {
      print_block(
          out,
          std::string(kind) + (std::string_view(kind) == "basis" ? ", " : "-based, ") + surface +
              (std::string_view(surface) == "torus" ? "" : " spheres"),
          result.euler, [&](const EulerRow& r) { return r.surface == surface && r.kind == kind; },
          [](const EulerRow& r) {
            std::string s = text("%8.5f %7.1e", r.mean, r.deviation);
            if (!std::isnan(r.paper_mean)) s += text(" [%.4f]", r.paper_mean);
            return s;
          });
    }
  }
  out << "\n" << text("%.1f s", result.seconds) << "\n";
}

}  // namespace alcap::app
