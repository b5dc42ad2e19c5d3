// SPDX-License-Identifier: MIT
//
// tables_published.cpp: LTGD 2016, Tables I and II, copied digit by digit.
#include "apps/alcap/tables/tables_published.h"

#include <limits>

namespace alcap::app::published {
namespace {

constexpr double unpublished = std::numeric_limits<double>::quiet_NaN();
constexpr std::int64_t vertex_counts[] = {162, 642, 2562, 10242};

// Columns: polar map, locally optimal, globally optimal. Rows: the four spheres.
constexpr double l2_div[4][3] = {
    {0.2447, 0.2239, 0.1809}, {0.1586, 0.1054, 0.0361}, {0.2742, 0.1297, 0.0084}, {0.7746, 0.2749, 0.0020}};
constexpr double l2_curl[4][3] = {
    {0.2453, 0.2251, 0.1823}, {0.1563, 0.1039, 0.0361}, {0.2760, 0.1300, 0.0083}, {0.7765, 0.2752, 0.0020}};
constexpr double linf_div[4][3] = {
    {0.5752, 0.3690, 0.2978}, {1.0984, 0.5613, 0.1280}, {1.6928, 0.9602, 0.0602}, {3.6589, 3.2195, 0.0240}};
constexpr double linf_curl[4][3] = {
    {0.4898, 0.5130, 0.3294}, {0.8183, 0.5225, 0.1321}, {2.0324, 1.0027, 0.0604}, {3.9119, 2.0779, 0.0240}};
constexpr double energy[4][3] = {
    {2.1906, 2.2470, 2.4016}, {0.2306, 0.3613, 0.6258}, {0.8679, 0.3259, 0.1581}, {3.0080, 1.0464, 0.0396}};
// Columns: polar rho, optimal rho.
constexpr double stiffness[4][2] = {{2.4161, 2.4153}, {0.6300, 0.6298}, {0.1592, 0.1591}, {0.0399, 0.0398}};
// Three spheres. Columns: polar map, locally optimal, globally optimal, Knoeppel et al. 2013, and globally optimal by
// edges.
constexpr Euler area_based[3][4] = {{{3.9730, 0.923e-3}, {3.9756, 0.623e-3}, {3.9756, 0.619e-3}, {3.9756, 0.620e-3}},
                                    {{3.9878, 0.341e-3}, {3.9897, 0.102e-3}, {3.9898, 0.103e-3}, {3.9898, 0.103e-3}},
                                    {{3.9948, 0.455e-3}, {3.9970, 0.057e-3}, {3.9970, 0.057e-3}, {3.9970, 0.057e-3}}};
constexpr Euler edge_based = {4.0000, 0.0};

int row_of(std::string_view sphere, std::int64_t vertices) {
  if (sphere != "clean") return -1;
  for (int i = 0; i < 4; ++i)
    if (vertex_counts[i] == vertices) return i;
  return -1;
}
int column_of(std::string_view connection) { return connection == "local" ? 1 : connection == "global" ? 2 : 0; }

}  // namespace

Operators operators(std::string_view sphere, std::int64_t vertices, std::string_view connection,
                    std::string_view kind) {
  const int row = row_of(sphere, vertices), column = column_of(connection);
  if (row < 0 || kind != "edge") return {unpublished, unpublished, unpublished, unpublished, unpublished};
  return {l2_div[row][column], l2_curl[row][column], linf_div[row][column], linf_curl[row][column],
          energy[row][column]};
}

double stiffness_energy(std::string_view sphere, std::int64_t vertices, std::string_view connection) {
  const int row = row_of(sphere, vertices);
  if (row < 0 || connection == "polar-barycenter" || connection == "local")
    return unpublished;  // they share the polar rho
  return stiffness[row][connection == "global" ? 1 : 0];
}

Euler euler(std::string_view surface, std::int64_t vertices, std::string_view connection, std::string_view kind) {
  const int row = row_of(surface, vertices);
  if (row < 0 || row > 2) return {unpublished, unpublished};
  if (kind == "edge") return connection == "global" ? edge_based : Euler{unpublished, unpublished};
  if (kind == "basis") return connection == "polar" ? area_based[row][3] : Euler{unpublished, unpublished};
  return area_based[row][column_of(connection)];
}

}  // namespace alcap::app::published
