// SPDX-License-Identifier: MIT
//
// check.cpp: what the values of a design must be, with and without a mesh.
#include <cmath>
#include <set>
#include <string>

#include "alcap/design_file.h"
#include "alcap/errors.h"
#include "src/design/file/problem.h"
#include "src/design/singularity_parts.h"
#include "src/design/weight_range.h"

namespace alcap {
namespace {

using detail::number_text;
using detail::Problem;

constexpr int largest_n = 1000;     // as `alcap field`
constexpr double most_turns = 1e6;  // as connections
constexpr double farthest = 1e150;  // of a point: distances are squared

std::string text(const std::array<double, 3>& x) {
  return "[" + number_text(x[0]) + "," + number_text(x[1]) + "," + number_text(x[2]) + "]";
}

void check_positive(const std::string& path, double value) {
  if (!(value > 0) || !std::isfinite(value)) throw Problem{path, number_text(value), "must be positive and finite"};
}

void check_weight(const std::string& path, double value) {
  if (!detail::fit_weight(value)) throw Problem{path, number_text(value), detail::weight_rule};
}

void check_finite(const std::string& path, double value) {
  if (!std::isfinite(value)) throw Problem{path, number_text(value), "must be finite"};
}

void check_finite_vector(const std::string& path, const Vector3& x) {
  for (const double c : x)
    if (!std::isfinite(c)) throw Problem{path, text(x), "must be finite"};
}

void check_point(const std::string& path, const Vector3& x) {
  check_finite_vector(path, x);
  for (const double c : x)
    if (std::abs(c) > farthest) throw Problem{path, text(x), "is too far away; coordinates go up to 1e150"};
}

void check_direction(const std::string& path, const Vector3& x) {
  check_finite_vector(path, x);
  if (x[0] == 0 && x[1] == 0 && x[2] == 0) throw Problem{path, text(x), "a direction must not be zero"};
}

void check_barycentric(const std::string& path, const std::array<double, 3>& b) {
  const double sum = b[0] + b[1] + b[2];
  for (const double x : b)
    if (!(x >= -1e-9) || !(std::abs(sum - 1) <= 1e-6))
      throw Problem{path, text(b), "barycentric coordinates must not be negative and must sum to 1"};
}

void check_place(const std::string& path, const char* element, Index number, const std::optional<Vector3>& at) {
  if ((number != none) == at.has_value()) {
    if (number == none) throw Problem{path, "no place", std::string("needs either ") + element + " or at"};
    throw Problem{path, "two places", std::string("needs either ") + element + " or at, not both"};
  }
  if (at)
    check_point(path + "/at", *at);
  else if (number < 0)
    throw Problem{path + "/" + element, std::to_string(number), "must not be negative"};
}

void check(const std::string& path, const DesignSingularity& s, int n) {
  check_place(path, "face", s.face, s.at);
  const bool of_vectors =
      s.kind == SingularityKind::sink || s.kind == SingularityKind::vortex || s.kind == SingularityKind::spiral;
  const bool of_lines = s.kind == SingularityKind::wedge || s.kind == SingularityKind::trisector;
  const std::string kind = "\"" + std::string(name(s.kind)) + "\"";
  if ((of_vectors && n != 1) || (of_lines && n != 2))
    throw Problem{path + "/kind", kind,
                  std::string("exists for n = ") + (of_lines ? "2" : "1") + " only, and here n = " + std::to_string(n) +
                      "; source and saddle exist for every n"};
  check_finite(path + "/angle", s.angle);
  if (s.relative_to) {
    check_direction(path + "/relative_to", *s.relative_to);
    if (index_of(s.kind) * s.count == n)
      throw Problem{path + "/relative_to", text(*s.relative_to),
                    "the angle of a source, vortex or spiral is its swirl, which has no direction in space"};
  }
  if (s.count < 1 || s.count > detail::largest_count)
    throw Problem{path + "/count", std::to_string(s.count), "must be 1 to " + std::to_string(detail::largest_count)};
  if (s.count > 1 && of_vectors)
    throw Problem{path + "/count", std::to_string(s.count), "is only for source and saddle; " + kind + " has index 1"};
  check_weight(path + "/strength", s.strength);
  if (s.barycentric) {
    check_barycentric(path + "/pin", *s.barycentric);
    if (s.at) throw Problem{path + "/pin", text(*s.barycentric), "needs face; with at, give true"};
    if (!s.pin) throw Problem{path + "/pin", text(*s.barycentric), "coordinates of a pin without a pin"};
  }
}

void check(const std::string& path, const DesignFixed& f) {
  check_place(path, "vertex", f.vertex, f.at);
  if (f.direction.has_value() == f.angle.has_value())
    throw Problem{path, f.angle ? "two directions" : "no direction", "needs either direction or angle"};
  if (f.direction) check_direction(path + "/direction", *f.direction);
  if (f.angle) check_finite(path + "/angle", *f.angle);
  if (f.relative_to) {
    check_direction(path + "/relative_to", *f.relative_to);
    if (!f.angle) throw Problem{path + "/relative_to", text(*f.relative_to), "needs angle"};
  }
  check_weight(path + "/length", f.length);
  if (f.free_length && f.length != 1)
    throw Problem{path + "/length", number_text(f.length), "a length that is free has no value"};
}

void check(const std::string& path, const DesignStroke& s) {
  if (int(!s.points.empty()) + int(!s.vertices.empty()) + int(!s.path.empty()) > 1)
    throw Problem{path, "two courses", "needs one of points, vertices and path"};
  if (!s.vertices.empty()) {
    if (s.vertices.size() < 2) throw Problem{path + "/vertices", "1 vertex", "a stroke has at least two"};
    for (std::size_t k = 0; k < s.vertices.size(); ++k)
      if (s.vertices[k] < 0)
        throw Problem{path + "/vertices/" + std::to_string(k), std::to_string(s.vertices[k]), "must not be negative"};
  } else if (!s.path.empty()) {
    if (s.path.size() < 2) throw Problem{path + "/path", "1 point", "a stroke has at least two"};
    for (std::size_t k = 0; k < s.path.size(); ++k) check_point(path + "/path/" + std::to_string(k), s.path[k]);
  } else if (s.points.size() < 2) {
    throw Problem{path + "/points", std::to_string(s.points.size()) + " points", "a stroke has at least two"};
  }
  for (std::size_t k = 0; k < s.points.size(); ++k) {
    const std::string at = path + "/points/" + std::to_string(k);
    check_place(at, "face", s.points[k].face, s.points[k].at);
    if (!s.points[k].at) check_barycentric(at + "/barycentric", s.points[k].barycentric);
  }
  check_weight(path + "/weight", s.weight);
  if (!(s.radius >= 0) || !std::isfinite(s.radius))
    throw Problem{path + "/radius", number_text(s.radius), "must be finite and not negative"};
}

void check_turns(const std::string& path, double turns) {
  if (!(std::abs(turns) <= most_turns)) throw Problem{path, number_text(turns), "must be in [-1e6, 1e6] turns"};
}

void check_turn(const std::string& path, double turns, int n) {
  const double count = turns * n;
  check_turns(path, turns);
  if (!(std::abs(count - std::round(count)) <= 1e-6))
    throw Problem{path, number_text(turns), "must be a multiple of 1/n = 1/" + std::to_string(n)};
}

void check(const DesignGuidance& g, int n) {
  using Source = DesignGuidance::Source;
  if (g.source == Source::nothing) return;
  check_weight("/guidance/weight", g.weight);
  if (g.source == Source::file && g.file.empty()) throw Problem{"/guidance/file", "\"\"", "must be the name of a file"};
  if (((g.source == Source::curvature || g.source == Source::strongest_curvature) && n % 2 != 0) ||
      (g.source == Source::least_curvature && n != 2))
    throw Problem{"/guidance/field", "\"" + std::string(name(g.source)) + "\"",
                  g.source == Source::least_curvature
                      ? "needs n = 2, and here n = " + std::to_string(n)
                      : "principal directions are lines: n must be even, and here it is " + std::to_string(n)};
  if (g.t) {
    if (!(std::abs(*g.t) <= detail::most_weight))
      throw Problem{"/guidance/t", number_text(*g.t), "must be in [-1e12, 1e12]"};
    if (g.weight != 1) throw Problem{"/guidance/t", number_text(*g.t), "cannot be combined with weight"};
    if (!g.weights.empty())
      throw Problem{"/guidance/t", number_text(*g.t), "cannot be combined with weights per vertex; they need weight"};
  }
  double sum = 0;
  for (std::size_t k = 0; k < g.weights.size(); ++k) {
    if (!detail::fit_weight_or_zero(g.weights[k]))
      throw Problem{"/guidance/weights/" + std::to_string(k), number_text(g.weights[k]), detail::weight_or_zero_rule};
    sum += g.weights[k];
  }
  if (!g.weights.empty() && !(sum > 0)) throw Problem{"/guidance/weights", "all 0", "one at least must be positive"};
}

void check(const DesignFeatures& f, int n) {
  const auto angle = [](const char* path, double value) {
    if (!(value > 0 && value <= 180)) throw Problem{path, number_text(value), "must be in (0, 180]"};
  };
  const auto length = [](const char* path, double value) {
    if (!(value >= 0) || !std::isfinite(value))
      throw Problem{path, number_text(value), "must be finite and not negative"};
  };
  angle("/features/angle", f.angle);
  angle("/features/corner_angle", f.corner_angle);
  check_weight("/features/weight", f.weight);
  if (!(f.low_angle >= 0 && f.low_angle <= f.angle))
    throw Problem{"/features/low_angle", number_text(f.low_angle), "must be 0 (off) or in (0, angle]"};
  length("/features/gap", f.gap);
  length("/features/spur", f.spur);
  const bool named = !f.file.empty() || !f.edges.empty();
  if (!f.file.empty() && !f.edges.empty())
    throw Problem{"/features/edges", std::to_string(f.edges.size()) + " edges", "cannot be combined with file"};
  if (named && f.low_angle > 0)
    throw Problem{"/features/low_angle", number_text(f.low_angle), "goes with angle, not with file and edges"};
  if (named && f.boundary)
    throw Problem{"/features/boundary", "true", "goes with angle; file and edges name the boundary's themselves"};
  if (n % 2 != 0)
    throw Problem{"/features", "n = " + std::to_string(n), "needs an even n: a feature has no sense of direction"};
}

/// In an eigenproblem lambda_t is what the weight of the guidance makes of it.
void check_eigen(const DesignGuidance& g) {
  if (g.source != DesignGuidance::Source::nothing && g.t)
    throw Problem{"/guidance/t", number_text(*g.t), "needs the variational method, and here it is eigen; give weight"};
}

std::string at(const char* list, std::size_t k) { return std::string("/") + list + "/" + std::to_string(k); }

/// Which keys each kind of connection takes, and whether its cones are possible.
void check_connection(const DesignConnection& c, int n) {
  if (!(c.detail >= 1e-12 && c.detail <= 1e12))
    throw Problem{"/connection/detail", number_text(c.detail), "must be in [1e-12, 1e12]"};
  check_positive("/connection/tan_cap", c.tan_cap);
  const bool trivial = c.kind == ConnectionKind::trivial, metric = c.kind == ConnectionKind::metric;
  const auto needs = [](bool fits, const char* key, const std::string& value, const char* rule) {
    if (!fits) throw Problem{std::string("/connection/") + key, value, rule};
  };
  const bool cones = !c.cones.empty() || !c.cones_at.empty();
  const char* const flat = "needs a trivial or metric connection";
  needs(!cones || trivial || metric, "cones", std::to_string(c.cones.size() + c.cones_at.size()) + " cones", flat);
  needs(c.holonomy.empty() || trivial || metric, "holonomy", std::to_string(c.holonomy.size()) + " values", flat);
  needs(c.loops.empty() || trivial || metric, "loops", std::to_string(c.loops.size()) + " values", flat);
  needs(!c.balance || trivial, "balance", "true", "needs a trivial connection");
  const bool target = !c.target.levi_civita();
  needs(!target || metric, "target", "given", "needs a metric connection");
  needs(!target || !(cones || !c.holonomy.empty() || !c.loops.empty()), "target", "given",
        "cannot be combined with cones, holonomy and loops");
  // Of a metric connection any fraction of a turn will do.
  const auto turn = [&](const std::string& path, double turns) {
    if (metric)
      check_turns(path, turns);
    else
      check_turn(path, turns, n);
  };
  for (std::size_t k = 0; k < c.holonomy.size(); ++k) turn(at("connection/holonomy", k), c.holonomy[k]);
  for (std::size_t k = 0; k < c.loops.size(); ++k) turn(at("connection/loops", k), c.loops[k]);
  for (std::size_t k = 0; k < c.cones.size(); ++k) {
    if (c.cones[k].vertex < 0)
      throw Problem{at("connection/cones", k) + "/vertex", std::to_string(c.cones[k].vertex), "must not be negative"};
    turn(at("connection/cones", k) + "/index", c.cones[k].index);
  }
  for (std::size_t k = 0; k < c.cones_at.size(); ++k) {
    const std::string path = at("connection/cones", c.cones.size() + k);
    check_point(path + "/at", c.cones_at[k].at);
    turn(path + "/index", c.cones_at[k].index);
  }
}

/// Edits one after the other: what they name is there, and a split leaves something.
void check_edits(const DesignFile& design) {
  std::vector<int> index;  // of each singularity; 0: gone
  for (const DesignSingularity& s : design.singularities) index.push_back(index_of(s.kind) * s.count);
  for (std::size_t k = 0; k < design.edits.size(); ++k) {
    const DesignEdit& e = design.edits[k];
    const std::string path = at("edits", k), key = path + "/" + std::string(name(e.type));
    const auto there = [&](std::size_t which) {
      if (which >= index.size() || index[which] == 0)
        throw Problem{key, std::to_string(which), "there is no such singularity"};
    };
    there(e.which);
    if (e.type == DesignEdit::Type::merge) {
      there(e.other);
      if (e.other == e.which) throw Problem{key, std::to_string(e.other), "takes two different ones"};
      index[e.which] += index[e.other];
      index[e.other] = 0;
      continue;
    }
    if (e.to < 0) throw Problem{path + "/to", std::to_string(e.to), "must not be negative"};
    if (e.type == DesignEdit::Type::move) continue;
    const int sign = index[e.which] > 0 ? 1 : -1;
    if (e.count < 1 || e.count >= std::abs(index[e.which]))
      throw Problem{path + "/count", std::to_string(e.count),
                    "must be less than the " + std::to_string(std::abs(index[e.which])) + " n-ths that are there"};
    index[e.which] -= sign * e.count;
    index.push_back(sign * e.count);
  }
}

void check_with_mesh(const DesignFile& design, const detail::DesignTarget& mesh) {
  const auto face = [&](const std::string& path, Index t) {
    if (t >= mesh.faces)
      throw Problem{path, std::to_string(t), "there is no such face; the mesh has " + std::to_string(mesh.faces)};
  };
  const auto vertex = [&](const std::string& path, Index v) {
    if (v >= mesh.vertices)
      throw Problem{path, std::to_string(v), "there is no such vertex; the mesh has " + std::to_string(mesh.vertices)};
    if (v >= 0 && !mesh.referenced(v)) throw Problem{path, std::to_string(v), "no face uses this vertex"};
  };
  if (design.mesh) {
    if (design.mesh->vertices != mesh.vertices)
      throw Problem{"/mesh/vertices", std::to_string(design.mesh->vertices),
                    "the design is for another mesh; this one has " + std::to_string(mesh.vertices)};
    if (design.mesh->faces != mesh.faces)
      throw Problem{"/mesh/faces", std::to_string(design.mesh->faces),
                    "the design is for another mesh; this one has " + std::to_string(mesh.faces)};
  }
  for (std::size_t k = 0; k < design.connection.cones.size(); ++k)
    vertex(at("connection/cones", k) + "/vertex", design.connection.cones[k].vertex);
  for (std::size_t k = 0; k < design.singularities.size(); ++k)
    face(at("singularities", k) + "/face", design.singularities[k].face);
  for (std::size_t k = 0; k < design.edits.size(); ++k)
    if (design.edits[k].type != DesignEdit::Type::merge) face(at("edits", k) + "/to", design.edits[k].to);
  std::set<Index> fixed;
  for (std::size_t k = 0; k < design.fixed.size(); ++k) {
    vertex(at("fixed", k) + "/vertex", design.fixed[k].vertex);
    if (design.fixed[k].vertex != none && !fixed.insert(design.fixed[k].vertex).second)
      throw Problem{at("fixed", k) + "/vertex", std::to_string(design.fixed[k].vertex), "is fixed twice"};
  }
  for (std::size_t k = 0; k < design.strokes.size(); ++k) {
    for (std::size_t p = 0; p < design.strokes[k].points.size(); ++p)
      face(at("strokes", k) + "/points/" + std::to_string(p) + "/face", design.strokes[k].points[p].face);
    for (std::size_t v = 0; v < design.strokes[k].vertices.size(); ++v)
      vertex(at("strokes", k) + "/vertices/" + std::to_string(v), design.strokes[k].vertices[v]);
  }
  for (std::size_t k = 0; k < design.features.edges.size(); ++k)
    for (const Index v : design.features.edges[k]) {
      const std::string path = at("features/edges", k);
      if (v < 0) throw Problem{path, std::to_string(v), "must not be negative"};
      vertex(path, v);
    }
  const auto weights = static_cast<std::int64_t>(design.guidance.weights.size());
  if (weights > 0 && weights != mesh.vertices)
    throw Problem{"/guidance/weights", std::to_string(weights) + " values",
                  "needs one per vertex; the mesh has " + std::to_string(mesh.vertices)};
}

}  // namespace

void detail::check_design_values(const DesignFile& design) {
  if (design.n < 1 || design.n > largest_n)
    throw Problem{"/n", std::to_string(design.n), "the degree of a field is 1 to " + std::to_string(largest_n)};
  if (design.mesh && design.mesh->vertices < 3)
    throw Problem{"/mesh/vertices", std::to_string(design.mesh->vertices), "a mesh has at least three"};
  if (design.mesh && design.mesh->faces < 1)
    throw Problem{"/mesh/faces", std::to_string(design.mesh->faces), "a mesh has at least one"};
  check_connection(design.connection, design.n);
  if (!(design.s >= -1 && design.s <= 1)) throw Problem{"/s", number_text(design.s), "must be in [-1, 1]"};
  check(design.guidance, design.n);
  if (design.boundary.wanted) check_weight("/boundary/weight", design.boundary.weight);
  if (design.features.wanted) check(design.features, design.n);
  if (design.method == DesignMethod::eigen) check_eigen(design.guidance);
  for (std::size_t k = 0; k < design.singularities.size(); ++k)
    check(at("singularities", k), design.singularities[k], design.n);
  for (std::size_t k = 0; k < design.fixed.size(); ++k) check(at("fixed", k), design.fixed[k]);
  for (std::size_t k = 0; k < design.strokes.size(); ++k) check(at("strokes", k), design.strokes[k]);
  check_edits(design);
}

void check_design(const DesignFile& design) {
  try {
    detail::check_design_values(design);
  } catch (const Problem& p) {
    throw OptionError(p.path, p.value, p.rule);
  }
}

void check_design(const DesignFile& design, const Mesh& mesh) {
  detail::check_design_on(design, {mesh.vertices(), mesh.faces(), [&](Index v) { return mesh.referenced(v); }});
}

void detail::check_design_on(const DesignFile& design, const DesignTarget& mesh) {
  check_design(design);
  try {
    check_with_mesh(design, mesh);
  } catch (const Problem& p) {
    throw OptionError(p.path, p.value, p.rule);
  }
}

std::vector<Index> detail::vertices_of(const DesignFile& design) {
  std::vector<Index> vertices;
  for (const Cone& c : design.connection.cones) vertices.push_back(c.vertex);
  for (const DesignFixed& f : design.fixed) vertices.push_back(f.vertex);
  for (const DesignStroke& s : design.strokes) vertices.insert(vertices.end(), s.vertices.begin(), s.vertices.end());
  for (const auto& edge : design.features.edges) vertices.insert(vertices.end(), edge.begin(), edge.end());
  return vertices;
}

int index_of(SingularityKind kind) {
  return kind == SingularityKind::saddle || kind == SingularityKind::trisector ? -1 : 1;
}

}  // namespace alcap
