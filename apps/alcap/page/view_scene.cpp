// SPDX-License-Identifier: MIT
//
// view_scene.cpp: a result as the arrays that the page shows.
#include "apps/alcap/page/view_scene.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>

#include "alcap/operators.h"
#include "alcap/streamlines.h"
#include "alcap/topology.h"
#include "src/base/numbers.h"

namespace alcap::app {
namespace {

Eigen::RowVector3d center_of(const Positions<double>& V) {
  return (V.colwise().minCoeff() + V.colwise().maxCoeff()) / 2;
}

double diagonal_of(const Positions<double>& V) { return (V.colwise().maxCoeff() - V.colwise().minCoeff()).norm(); }

std::vector<float> relative(const Positions<double>& points, const Eigen::RowVector3d& center) {
  std::vector<float> out(static_cast<std::size_t>(points.size()));
  Eigen::Map<Positions<float>>(out.data(), points.rows(), 3) = (points.rowwise() - center).cast<float>();
  return out;
}

/// Rows of the points that draw a curve, to within a distance that nobody sees: those that lie that close to a chord
/// are left out.
void keep_corners(const Positions<double>& points, std::int64_t first, std::int64_t end, double distance,
                  std::vector<Eigen::Index>& kept) {
  constexpr std::int64_t longest = 64;  // points that a chord stands for, so that time stays linear
  kept.push_back(first);
  for (std::int64_t from = first, to = first + 1; to < end; ++to) {
    bool fits = to + 1 < end && to - from < longest;
    if (fits) {
      const Eigen::RowVector3d chord = points.row(to + 1) - points.row(from);
      const double length = chord.squaredNorm();
      for (std::int64_t i = from + 1; fits && i <= to; ++i) {
        const Eigen::RowVector3d way = points.row(i) - points.row(from);
        const double along = way.dot(chord);
        fits =
            along >= 0 && along <= length && way.squaredNorm() * length - along * along <= distance * distance * length;
      }
    }
    if (fits) continue;
    kept.push_back(to);
    from = to;
  }
}

void add_lines(ViewPack& pack, const std::string& name, const std::string& offsets_name, const CurveSet& curves,
               double distance, const Eigen::RowVector3d& center) {
  std::vector<Eigen::Index> kept;
  std::vector<std::uint32_t> offsets{0};
  for (std::size_t k = 0; k + 1 < curves.offsets.size(); ++k) {
    keep_corners(curves.points, curves.offsets[k], curves.offsets[k + 1], distance, kept);
    offsets.push_back(static_cast<std::uint32_t>(kept.size()));
  }
  pack.add(name, relative(curves.points(kept, Eigen::all), center));
  pack.add(offsets_name, offsets);
}

/// The value below which `fraction` of the finite values lie.
float quantile(std::vector<float> values, double fraction) {
  std::erase_if(values, [](float x) { return !std::isfinite(x); });
  if (values.empty()) return 0;
  const auto k = static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

/// `entry` is one of scalar_list().
void add_scalar(ViewPack& pack, Json entry, const VectorX<double>& values) {
  std::vector<float> numbers(static_cast<std::size_t>(values.size()));
  Eigen::Map<VectorX<float>>(numbers.data(), values.size()) = values.cast<float>();
  // A few faces around singularities would otherwise use up all colours.
  double low = quantile(numbers, 0.02), high = quantile(numbers, 0.98);
  if (entry.at("diverging").get<bool>()) {
    high = std::max(std::abs(low), std::abs(high));
    low = -high;
  }
  entry["low"] = low;
  entry["high"] = high;
  pack.add_short("scalar." + entry.at("name").get<std::string>(), numbers);
  pack.meta["scalars"].push_back(std::move(entry));
}

}  // namespace

void add_mesh(ViewPack& pack, const Surface& surface) {
  const Positions<double>& V = surface.V();
  // What a page has of them it numbers with 32 bits.
  if (V.rows() > std::numeric_limits<std::uint32_t>::max() ||
      surface.F().rows() > std::numeric_limits<std::uint32_t>::max())
    throw OptionError("html", std::to_string(surface.F().rows()) + " faces", "are more than a page can number");
  const Eigen::RowVector3d center = center_of(V);
  pack.meta["center"] = {center.x(), center.y(), center.z()};
  pack.meta["diagonal"] = diagonal_of(V);
  pack.add("positions", relative(V, center));
  const std::vector<std::uint32_t> faces(surface.F().data(), surface.F().data() + surface.F().size());
  pack.add("faces", faces);
}

void add_loops(ViewPack& pack, const Surface& surface) {
  const Positions<double>& V = surface.V();
  const Eigen::RowVector3d center = center_of(V);
  std::vector<float> points;
  std::vector<std::uint32_t> offsets{0};
  for (const Loop& loop : homology_generators(surface)) {
    for (std::size_t k = 0; k <= loop.halfedges.size(); ++k) {
      const Index h = loop.halfedges[k % loop.halfedges.size()];
      const Eigen::RowVector3d middle = (V.row(surface.mesh().tail(h)) + V.row(surface.mesh().tip(h))) / 2 - center;
      for (Eigen::Index c = 0; c < 3; ++c) points.push_back(static_cast<float>(middle[c]));
    }
    offsets.push_back(static_cast<std::uint32_t>(points.size() / 3));
  }
  pack.add("loops", points);
  pack.add("loop_offsets", offsets);
}

void add_field(ViewPack& pack, const FieldOutput& source) {
  const Positions<double> vectors = source.field.vectors(0);
  std::vector<std::int16_t> branch(static_cast<std::size_t>(vectors.size()));
  std::vector<float> length(static_cast<std::size_t>(vectors.rows()));
  for (Eigen::Index v = 0; v < vectors.rows(); ++v) {
    const double norm = vectors.row(v).norm();
    length[static_cast<std::size_t>(v)] = static_cast<float>(norm);
    for (Eigen::Index c = 0; c < 3; ++c) {
      branch[static_cast<std::size_t>(3 * v + c)] =
          norm > 0 ? detail::rounded<std::int16_t>(32767 * vectors(v, c) / norm).value_or(0) : std::int16_t{0};
    }
  }
  pack.meta["n"] = source.field.n;
  pack.add("branch", branch);
  pack.add_short("length", length);
}

void add_singularities(ViewPack& pack, const FieldOutput& source) {
  const Frames frames = face_frames(source.surface);
  const Eigen::RowVector3d center = center_of(source.surface.V());
  std::vector<float> singular, arms;
  std::vector<std::uint32_t> faces;
  for (const Singularity& s : source.singularities) {
    const Eigen::RowVector3d p = position(source.surface, s) - center, normal = frames.N.row(s.face);
    const auto number = static_cast<float>(faces.size());
    faces.push_back(static_cast<std::uint32_t>(s.face));
    for (const auto& x : {p, normal}) {
      for (Eigen::Index c = 0; c < 3; ++c) singular.push_back(static_cast<float>(x[c]));
    }
    singular.push_back(static_cast<float>(s.index));
    singular.push_back(static_cast<float>(s.orientation));
    // As Singularity::orientation: the first of n - 1 or n + 1 straight branches.
    const int count = source.field.n - (s.index > 0 ? 1 : -1);
    for (int k = 0; k < count; ++k) {
      const Eigen::RowVector3d d = frames.vector(s.face, std::polar(1.0, s.orientation + 2 * pi<double> * k / count));
      for (const double x : {static_cast<double>(number), d.x(), d.y(), d.z()}) arms.push_back(static_cast<float>(x));
    }
  }
  pack.add("singular", singular);
  pack.add("singular_faces", faces);
  pack.add("arms", arms);
}

PageCurves page_even_curves(const FieldOutput& source, double apart, const RunControl& control,
                            const CurveSet* earlier) {
  PageCurves out;
  // Some sixty curves across, so that they stay apart on a small screen too; on coarse meshes not many more than they
  // have edges.
  out.spacing = apart * std::clamp(0.7 * source.surface.geometry().lengths().mean() / diagonal_of(source.surface.V()),
                                   0.0095, 0.02);
  const StreamlineOptions options{.spacing = out.spacing, .control = control};
  out.even = earlier == nullptr ? streamlines(source.surface, source.field, options)
                                : update_streamlines(source.surface, source.field, *earlier, options);
  return out;
}

PageCurves page_separatrices(const FieldOutput& source, const RunControl& control) {
  PageCurves out;
  // Shorter than the surface is wide: where they end in the middle, the pattern around the singularity is what counts.
  out.separatrices =
      separatrices(source.surface, source.field, source.singularities, {.max_length = 0.5, .control = control});
  return out;
}

PageCurves page_curves(const FieldOutput& source) {
  PageCurves out = page_even_curves(source);
  out.separatrices = page_separatrices(source).separatrices;
  return out;
}

// A tenth of a pixel in a picture a thousand pixels wide.
constexpr double unseen = 1e-4;

void add_curves(ViewPack& pack, const FieldOutput& source, const PageCurves& curves) {
  const double diagonal = diagonal_of(source.surface.V());
  pack.meta["spacing"] = curves.spacing * diagonal;
  pack.meta["curves_complete"] = curves.complete();
  add_lines(pack, "curves", "curve_offsets", curves.even, unseen * diagonal, center_of(source.surface.V()));
}

void add_separatrices(ViewPack& pack, const FieldOutput& source, const PageCurves& curves) {
  add_lines(pack, "separatrices", "separatrix_offsets", curves.separatrices, unseen * diagonal_of(source.surface.V()),
            center_of(source.surface.V()));
}

Json scalar_list(int n) {
  const auto one = [](const char* name, const char* label, const char* help, bool diverging) {
    return Json{{"name", name}, {"label", label}, {"help", help}, {"diverging", diverging}};
  };
  Json list = Json::array();
  if (n == 1) {
    list.push_back(one("div", "Divergence", "mean of div u over each face", true));
    list.push_back(one("curl", "Curl", "mean of curl u over each face, counter-clockwise positive", true));
  } else {
    list.push_back(one("d", "|∂u|", "holomorphic derivative, half of |div + i curl|", false));
  }
  list.push_back(one("dbar", "|∂̄u|", "Cauchy–Riemann derivative, half of the reflected pair", false));
  list.push_back(one("u", "|u|", "length of the n-vector; zero at singularities", false));
  list.push_back(one("K", "Curvature K", "curvature of the connection per area", true));
  return list;
}

void add_scalars(ViewPack& pack, const FieldOutput& source) {
  const Mesh& mesh = source.surface.mesh();
  const Field& field = source.field;
  const auto operators = first_order_operators(source.surface, {.n = field.n});
  const VectorX<double>& area = source.surface.geometry().areas();
  const ComplexVectorX<double> p = apply(mesh, operators.p, field.u), q = apply(mesh, operators.q, field.u);
  VectorX<double> length(mesh.faces());
  for (Index t = 0; t < mesh.faces(); ++t) {
    length[t] = 0;
    for (Index c = 0; c < 3; ++c) length[t] += std::abs(field.u[mesh.F()(t, c)]) / 3;
  }
  const std::map<std::string, VectorX<double>> values{{"div", p.real().cwiseQuotient(area)},
                                                      {"curl", p.imag().cwiseQuotient(area)},
                                                      {"d", p.cwiseAbs().cwiseQuotient(area) / 2},
                                                      {"dbar", q.cwiseAbs().cwiseQuotient(area) / 2},
                                                      {"u", length},
                                                      {"K", source.surface.connection().K.cwiseQuotient(area)}};
  pack.meta["scalars"] = Json::array();
  for (const Json& entry : scalar_list(field.n)) add_scalar(pack, entry, values.at(entry.at("name")));
}

Figures figures(const Json& report) {
  Figures rows;
  const auto find = [&](const char* pointer) -> const Json* {
    const Json::json_pointer path(pointer);
    return report.contains(path) && !report.at(path).is_null() ? &report.at(path) : nullptr;
  };
  const auto real = [&](const char* label, const char* pointer, const char* unit = "") {
    if (const Json* x = find(pointer); x != nullptr && x->is_number())
      rows.emplace_back(label, fmt::format("{:.4g}{}", x->get<double>(), unit));
  };
  if (const Json* x = find("/connection/kind"); x != nullptr && x->is_string()) {
    std::string kind = x->get<std::string>();
    if (!kind.empty() && kind[0] >= 'a') kind[0] = static_cast<char>(kind[0] - 'a' + 'A');
    rows.emplace_back("Connection", kind);
  }
  real("Smallest eigenvalue", "/eigen/lambda");
  real("Residual", "/eigen/residual");
  real("Residual", "/solve/residual");
  real("D_T", "/connection/D_T");
  real("D_E", "/connection/D_E");
  real("Time", "/times/total", " s");
  return rows;
}

ViewPack make_scene(const FieldOutput& source, const PageCurves& curves, const std::string& title, const Json& report) {
  ViewPack pack;
  pack.meta["title"] = title;
  add_mesh(pack, source.surface);
  add_field(pack, source);
  add_singularities(pack, source);
  add_curves(pack, source, curves);
  add_separatrices(pack, source, curves);
  add_scalars(pack, source);
  pack.meta["euler"] = source.surface.topology().euler();
  pack.meta["figures"] = figures(report);
  if (report.contains("certificate")) {
    const auto says = [&](const char* key) { return report.contains(key) && report[key] == true; };
    pack.meta["met"] = !report.contains("met") || says("met");
    pack.meta["holds"] = says("ok") || says("certified");
  }
  return pack;
}

ViewPack make_scene(const FieldOutput& source, const std::string& title, const Json& report) {
  return make_scene(source, page_curves(source), title, report);
}

}  // namespace alcap::app
