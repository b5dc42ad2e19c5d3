// SPDX-License-Identifier: MIT
//
// write.cpp: designs as JSON text. Keys whose value is the default are left out.
#include <array>
#include <charconv>
#include <cmath>

#include "alcap/design_file.h"
#include "src/base/atomic_file.h"
#include "src/design/file/json_tree.h"
#include "src/design/file/problem.h"

namespace alcap {
namespace {

using Json = detail::JsonTree;

void write_place(Json& json, const char* element, Index number, const std::optional<Vector3>& at) {
  if (at)
    json["at"] = *at;
  else
    json[element] = number;
}

Json json_of(const DesignSingularity& s) {
  Json json = Json::object();
  if (!s.name.empty()) json["name"] = s.name;
  write_place(json, "face", s.face, s.at);
  json["kind"] = name(s.kind);
  if (s.angle != 0 || s.kind == SingularityKind::spiral) json["angle"] = s.angle;
  if (s.relative_to) json["relative_to"] = *s.relative_to;
  if (s.count != 1) json["count"] = s.count;
  if (s.strength != 1) json["strength"] = s.strength;
  if (s.barycentric)
    json["pin"] = *s.barycentric;
  else if (s.pin)
    json["pin"] = true;
  return json;
}

Json json_of(const DesignFixed& f) {
  Json json = Json::object();
  if (!f.name.empty()) json["name"] = f.name;
  write_place(json, "vertex", f.vertex, f.at);
  if (f.direction) json["direction"] = *f.direction;
  if (f.angle) json["angle"] = *f.angle;
  if (f.relative_to) json["relative_to"] = *f.relative_to;
  if (f.free_length)
    json["length"] = "free";
  else if (f.length != 1)
    json["length"] = f.length;
  return json;
}

Json json_of(const DesignStroke& s) {
  Json json = Json::object();
  if (!s.name.empty()) json["name"] = s.name;
  if (!s.vertices.empty()) json["vertices"] = s.vertices;
  if (!s.path.empty()) json["path"] = s.path;
  Json points = Json::list();
  for (const DesignPoint& p : s.points) {
    Json point = Json::object();
    write_place(point, "face", p.face, p.at);
    if (!p.at) point["barycentric"] = p.barycentric;
    points.push_back(std::move(point));
  }
  if (!s.points.empty()) json["points"] = std::move(points);
  if (s.weight != 1) json["weight"] = s.weight;
  if (s.radius != 0) json["radius"] = s.radius;
  return json;
}

Json json_of(const DesignFeatures& f) {
  Json json = Json::object();
  const DesignFeatures standard;
  const auto number = [&](const char* key, double value, double usual) {
    if (value != usual) json[key] = value;
  };
  const auto flag = [&](const char* key, bool value) {
    if (value) json[key] = true;
  };
  if (!f.file.empty()) {
    json["file"] = f.file.string();
  } else if (f.edges.empty()) {
    json["angle"] = f.angle;
  } else {
    for (const auto& edge : f.edges) json["edges"].push_back(edge);
  }
  number("weight", f.weight, standard.weight);
  flag("hold", f.hold);
  flag("across", f.across);
  flag("boundary", f.boundary);
  number("corner_angle", f.corner_angle, standard.corner_angle);
  number("low_angle", f.low_angle, standard.low_angle);
  number("gap", f.gap, standard.gap);
  number("spur", f.spur, standard.spur);
  return json;
}

Json json_of(const DesignConnection& c) {
  Json json = Json::object();
  json["kind"] = name(ConnectionChoice{c.kind, c.center});
  const DesignConnection standard;
  if (c.detail != standard.detail) json["detail"] = c.detail;
  if (c.length_factor != standard.length_factor) json["length_factor"] = name(c.length_factor);
  if (c.tan_cap != standard.tan_cap) json["tan_cap"] = c.tan_cap;
  for (const Cone& cone : c.cones) {
    Json& one = json["cones"].push_back(Json::object());
    one["vertex"] = cone.vertex;
    one["index"] = cone.index;
  }
  for (const DesignConeAt& cone : c.cones_at) {
    Json& one = json["cones"].push_back(Json::object());
    one["at"] = cone.at;
    one["index"] = cone.index;
  }
  if (c.balance) json["balance"] = true;
  if (!c.holonomy.empty()) json["holonomy"] = c.holonomy;
  if (!c.loops.empty()) json["loops"] = c.loops;
  const auto array = [&](const char* key, const VectorX<double>& values) {
    if (values.size() > 0) json["target"][key] = std::vector<double>(values.begin(), values.end());
  };
  array("rotation", c.target.rotation);
  array("adjustment", c.target.adjustment);
  array("vertex_curvature", c.target.vertex_curvature);
  array("face_curvature", c.target.face_curvature);
  if (!c.spread) json["spread"] = false;
  return json;
}

Json json_of(const DesignEdit& e) {
  Json json = Json::object();
  switch (e.type) {
    case DesignEdit::Type::move:
      json["move"] = e.which;
      json["to"] = e.to;
      break;
    case DesignEdit::Type::merge:
      json["merge"] = std::array{e.which, e.other};
      break;
    case DesignEdit::Type::split:
      json["split"] = e.which;
      json["to"] = e.to;
      json["count"] = e.count;
      break;
  }
  return json;
}

template <class T>
void write_list(Json& json, const char* key, const std::vector<T>& list) {
  for (const T& x : list) json[key].push_back(json_of(x));
}

}  // namespace

std::string design_text(const DesignFile& design) {
  check_design(design);
  Json json = Json::object();
  json["alcap_design"] = design_version;
  if (!design.comment.empty()) json["comment"] = design.comment;
  if (design.mesh) {
    json["mesh"]["vertices"] = design.mesh->vertices;
    json["mesh"]["faces"] = design.mesh->faces;
  }
  json["n"] = design.n;
  if (design.method == DesignMethod::eigen) json["method"] = "eigen";
  if (design.s != 0) json["s"] = design.s;
  json["connection"] = json_of(design.connection);
  if (design.guidance.source != DesignGuidance::Source::nothing) {
    Json& g = json["guidance"] = Json::object();
    if (design.guidance.source == DesignGuidance::Source::file)
      g["file"] = design.guidance.file.string();
    else
      g["field"] = name(design.guidance.source);
    if (design.guidance.t)
      g["t"] = *design.guidance.t;
    else if (design.guidance.weight != 1)
      g["weight"] = design.guidance.weight;
    if (!design.guidance.weights.empty()) g["weights"] = design.guidance.weights;
  }
  write_list(json, "singularities", design.singularities);
  write_list(json, "fixed", design.fixed);
  write_list(json, "strokes", design.strokes);
  if (design.boundary.wanted) {
    json["boundary"]["align"] = design.boundary.normal ? "normal" : "tangent";
    if (design.boundary.weight != 1) json["boundary"]["weight"] = design.boundary.weight;
  }
  if (design.features.wanted) json["features"] = json_of(design.features);
  write_list(json, "edits", design.edits);
  // Texts from outside JSON may hold anything; what is not UTF-8 is replaced.
  return json.text(2) + "\n";
}

void write_design(const std::filesystem::path& path, const DesignFile& design) {
  const std::string text = design_text(design);
  detail::AtomicFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace alcap
