// SPDX-License-Identifier: MIT
//
// view_scene.cpp: a result as the arrays that the page shows.
#include "apps/alcap/page/view_scene.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "alcap/operators.h"
#include "alcap/streamlines.h"
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

void add_lines(ViewPack& pack, const std::string& name, const std::string& offsets_name, const CurveSet& curves,
               const Eigen::RowVector3d& center) {
  pack.add(name, relative(curves.points, center));
  const std::vector<std::uint32_t> offsets(curves.offsets.begin(), curves.offsets.end());
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

void add_scalar(ViewPack& pack, const char* name, const char* label, const char* help, bool diverging,
                const VectorX<double>& values) {
  std::vector<float> numbers(static_cast<std::size_t>(values.size()));
  Eigen::Map<VectorX<float>>(numbers.data(), values.size()) = values.cast<float>();
  // A few faces around singularities would otherwise use up all colours.
  double low = quantile(numbers, 0.02), high = quantile(numbers, 0.98);
  if (diverging) {
    high = std::max(std::abs(low), std::abs(high));
    low = -high;
  }
  pack.meta["scalars"].push_back(
      {{"name", name}, {"label", label}, {"help", help}, {"diverging", diverging}, {"low", low}, {"high", high}});
  pack.add_short(std::string("scalar.") + name, numbers);
}

}  // namespace

void add_mesh(ViewPack& pack, const Surface& surface) {
  const Positions<double>& V = surface.V();
  const Eigen::RowVector3d center = center_of(V);
  pack.meta["center"] = {center.x(), center.y(), center.z()};
  pack.meta["diagonal"] = diagonal_of(V);
  pack.add("positions", relative(V, center));
  const std::vector<std::uint32_t> faces(surface.F().data(), surface.F().data() + surface.F().size());
  pack.add("faces", faces);
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

PageCurves page_curves(const FieldOutput& source) {
  PageCurves out;
  // Some sixty curves across, so that they stay apart on a small screen too; on coarse meshes not many more than they
  // have edges.
  out.spacing =
      std::clamp(0.7 * source.surface.geometry().lengths().mean() / diagonal_of(source.surface.V()), 0.0095, 0.02);
  out.even = streamlines(source.surface, source.field, {.spacing = out.spacing});
  // Shorter than the surface is wide: where they end in the middle, the pattern around the singularity is what counts.
  out.separatrices = separatrices(source.surface, source.field, source.singularities, {.max_length = 0.5});
  return out;
}

void add_curves(ViewPack& pack, const FieldOutput& source, const PageCurves& curves) {
  const Eigen::RowVector3d center = center_of(source.surface.V());
  pack.meta["spacing"] = curves.spacing * diagonal_of(source.surface.V());
  pack.meta["curves_complete"] = curves.complete();
  add_lines(pack, "curves", "curve_offsets", curves.even, center);
  add_lines(pack, "separatrices", "separatrix_offsets", curves.separatrices, center);
}

void add_scalars(ViewPack& pack, const FieldOutput& source) {
  const Mesh& mesh = source.surface.mesh();
  const Field& field = source.field;
  const auto operators = first_order_operators(source.surface, {.n = field.n});
  const VectorX<double>& area = source.surface.geometry().areas();
  const ComplexVectorX<double> p = apply(mesh, operators.p, field.u), q = apply(mesh, operators.q, field.u);
  pack.meta["scalars"] = Json::array();
  if (field.n == 1) {
    add_scalar(pack, "div", "Divergence", "mean of div u over each face", true, p.real().cwiseQuotient(area));
    add_scalar(pack, "curl", "Curl", "mean of curl u over each face, counter-clockwise positive", true,
               p.imag().cwiseQuotient(area));
  } else {
    add_scalar(pack, "d", "|∂u|", "holomorphic derivative, half of |div + i curl|", false,
               p.cwiseAbs().cwiseQuotient(area) / 2);
  }
  add_scalar(pack, "dbar", "|∂̄u|", "Cauchy–Riemann derivative, half of the reflected pair", false,
             q.cwiseAbs().cwiseQuotient(area) / 2);
  VectorX<double> length(mesh.faces());
  for (Index t = 0; t < mesh.faces(); ++t) {
    length[t] = 0;
    for (Index c = 0; c < 3; ++c) length[t] += std::abs(field.u[mesh.F()(t, c)]) / 3;
  }
  add_scalar(pack, "u", "|u|", "length of the n-vector; zero at singularities", false, length);
  add_scalar(pack, "K", "Curvature K", "curvature of the connection per area", true,
             source.surface.connection().K.cwiseQuotient(area));
}

Figures figures(const Json& report) {
  Figures rows;
  const auto find = [&](const char* pointer) -> const Json* {
    const Json::json_pointer path(pointer);
    return report.contains(path) && !report.at(path).is_null() ? &report.at(path) : nullptr;
  };
  const auto real = [&](const char* label, const char* pointer, const char* unit = "") {
    if (const Json* x = find(pointer)) rows.emplace_back(label, fmt::format("{:.4g}{}", x->get<double>(), unit));
  };
  if (const Json* x = find("/connection/kind")) {
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
  add_scalars(pack, source);
  pack.meta["euler"] = source.surface.topology().euler();
  pack.meta["figures"] = figures(report);
  if (report.contains("certificate")) {
    pack.meta["met"] = report.value("met", true);
    pack.meta["holds"] = report.value("ok", false) || report.value("certified", false);
  }
  return pack;
}

ViewPack make_scene(const FieldOutput& source, const std::string& title, const Json& report) {
  return make_scene(source, page_curves(source), title, report);
}

}  // namespace alcap::app
