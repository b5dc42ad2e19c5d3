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
    {"Linf error by face of div", &OperatorRow::face_div, nullptr, &OperatorRow::paper_linf_div},
    {"Linf error by face of curl", &OperatorRow::face_curl, nullptr, &OperatorRow::paper_linf_curl},
    {"error of E_D", &OperatorRow::energy, &OperatorRow::order_energy, &OperatorRow::paper_energy}};

/// "clean spheres", "ellipsoid"
std::string surface_name(const std::string& name) {
  return name == "clean" || name == "jittered" ? name + " spheres" : name;
}

void print_baselines(std::ostream& out, const std::vector<BaselineRow>& rows) {
  if (rows.empty()) return;
  out << "\n\nBaselines: mean relative error of E_A by 1-forms on edges (Fisher et al. 2007), by our operators (edge,\n"
         "  triangle) and by the closed-form basis; and the mean angle in degrees between the cross field per face of "
         "a\n"
         "  trivial connection (Crane et al. 2010) and ours, away from the cones.\n\n"
      << "  vertices  spheres     1-forms     edge      triangle  basis     degrees\n";
  for (const BaselineRow& r : rows)
    out << text("%10lld  %-10s  %8.5f  %8.5f  %8.5f  %8.5f  %8.1e\n", static_cast<long long>(r.vertices),
                r.sphere.c_str(), r.fisher, r.edge, r.triangle, r.basis, r.crane_degrees);
}

void print_operators(std::ostream& out, const TablesResult& result) {
  const TablesOptions& o = result.options;
  out << "Table I: errors of " << o.fields << " random fields of unit L2 norm, grad Y and n x grad Y of the first "
      << o.harmonics << " harmonics; means.\n"
      << "  Each cell: error, observed order of convergence, [the paper's number].\n"
      << "  L2: sqrt(sum over faces of (integral - exact integral)^2), exact over the spherical triangle.\n"
      << "  Linf: largest |integral - exact integral| / area of the face. E_D: |energy - exact energy|.\n"
      << "  By face: the same with the root mean square over the fields taken first, face by face. The paper's Linf "
         "is\n"
      << "  of this size (2562 vertices: 0.0605 here, 0.0602 there) and half of the Linf above it.\n"
      << "  The paper's growing polar columns are not seen with either center: polar, local and global have equal "
         "errors\n"
      << "  here to three digits, on spheres.\n"
      << "  Jittered: vertices moved by up to " << text("%g", o.jitter) << " mean edge lengths. Seed " << o.seed
      << ".\n";
  std::vector<std::string> spheres;
  for (const OperatorRow& row : result.operators)
    if (std::find(spheres.begin(), spheres.end(), row.sphere) == spheres.end()) spheres.push_back(row.sphere);
  for (const std::string& sphere : spheres) {
    for (const char* kind : {"edge", "triangle"}) {
      for (const Quantity& q : quantities) {
        const bool known = std::any_of(result.operators.begin(), result.operators.end(), [&](const OperatorRow& r) {
          return r.sphere == sphere && r.kind == kind && !std::isnan(r.*q.value);
        });
        if (!known) continue;
        print_block(
            out, std::string(q.name) + ", " + kind + "-based, " + surface_name(sphere), result.operators,
            [&](const OperatorRow& r) { return r.sphere == sphere && r.kind == kind; },
            [&](const OperatorRow& r) {
              return error_cell(r.*q.value, q.order ? r.*q.order : std::nan(""), r.*q.paper);
            });
      }
    }
    print_block(
        out,
        "error of E_D of the closed-form basis (matrix S; with polar that of Knoeppel et al. 2013), " +
            surface_name(sphere),
        result.stiffness, [&](const StiffnessRow& r) { return r.sphere == sphere; },
        [](const StiffnessRow& r) { return error_cell(r.energy, r.order_energy, r.paper_energy); });
  }
}

void print_euler(std::ostream& out, const TablesResult& result) {
  out << "\n\nTable II: (E_A - E_H) / pi of " << result.options.fields
      << " random fields scaled to unit length at every vertex.\n"
      << "  Each cell: mean, standard deviation, [the paper's]. 2 chi is 4 on spheres, 0 on tori.\n"
      << "  'basis' is the exact integral of K |u|^2 over the closed-form basis. The paper's area-based columns are\n"
      << "  nearer to 4 than this integral is for any unit field with its zeros: interpolated values are shorter than "
         "1\n"
      << "  around them. Fields of degree l = 1 alone, one level finer, come nearest: 3.964, 3.989, 3.997.\n";
  std::vector<std::string> surfaces;
  for (const EulerRow& row : result.euler)
    if (std::find(surfaces.begin(), surfaces.end(), row.surface) == surfaces.end()) surfaces.push_back(row.surface);
  for (const std::string& surface : surfaces) {
    for (const char* kind : {"edge", "triangle", "basis"}) {
      print_block(
          out, std::string(kind) + (std::string_view(kind) == "basis" ? ", " : "-based, ") + surface_name(surface),
          result.euler, [&](const EulerRow& r) { return r.surface == surface && r.kind == kind; },
          [](const EulerRow& r) {
            std::string s = text("%8.5f %7.1e", r.mean, r.deviation);
            if (!std::isnan(r.paper_mean)) s += text(" [%.4f]", r.paper_mean);
            return s;
          });
    }
  }
}

}  // namespace

void print_tables(std::ostream& out, const TablesResult& result) {
  print_operators(out, result);
  print_euler(out, result);
  print_baselines(out, result.baselines);
  out << "\n" << text("%.1f s", result.seconds) << "\n";
}

}  // namespace alcap::app
