// SPDX-License-Identifier: MIT
//
// parse.cpp: reads designs from JSON. Here types and keys are checked; what the values must be is the business of
// design_file_check.cpp.
#include "alcap/design_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <limits>

#include "alcap/errors.h"
#include "src/base/input_file.h"
#include "src/design/file/json_tree.h"
#include "src/design/file/problem.h"

namespace alcap {
namespace {

using Json = detail::JsonTree;
using detail::Problem;

constexpr std::size_t deepest = 16;                      // a design nests four levels
constexpr std::int64_t largest = std::int64_t{1} << 28;  // bytes; a design of a million stroke points is smaller

std::string shortened(const Json& json) {
  if (json.is_object()) return "an object";
  if (json.is_list() && json.size() > 8) return "a list of " + std::to_string(json.size());
  std::string text = json.text();
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

/// A value of the file and its path.
class Node {
 public:
  Node(const Json& json, std::string path) : json_(&json), path_(std::move(path)) {}

  [[noreturn]] void fail(const std::string& rule) const {
    throw Problem{path_.empty() ? "/" : path_, shortened(*json_), rule};
  }

  /// Must be an object with no other keys than these.
  void keys(std::initializer_list<const char*> known) const {
    if (!json_->is_object()) fail("must be an object");
    for (std::size_t k = 0; k < json_->size(); ++k) {
      const std::string& key = json_->key(k);
      if (std::find(known.begin(), known.end(), key) != known.end()) continue;
      std::string list;
      for (const char* name : known) list += (list.empty() ? "" : ", ") + std::string(name);
      Node((*json_)[k], path_ + "/" + key).fail("unknown key; known are " + list);
    }
  }
  [[nodiscard]] std::optional<Node> find(const char* key) const {
    const Json* const at = json_->find(key);
    if (at == nullptr) return std::nullopt;
    return Node(*at, path_ + "/" + key);
  }
  [[nodiscard]] Node at(const char* key) const {
    if (const auto node = find(key)) return *node;
    fail(std::string("needs the key ") + key);
  }
  [[nodiscard]] std::vector<Node> list() const {
    if (!json_->is_list()) fail("must be a list");
    std::vector<Node> nodes;
    for (std::size_t k = 0; k < json_->size(); ++k) nodes.emplace_back((*json_)[k], path_ + "/" + std::to_string(k));
    return nodes;
  }
  [[nodiscard]] double number() const {
    if (!json_->scalar().is_number()) fail("must be a number");
    return json_->scalar().get<double>();
  }
  template <class I>
  [[nodiscard]] I whole() const {
    // 12.0 is a whole number too, as in JSON Schema.
    const double value =
        json_->scalar().is_number() ? json_->scalar().get<double>() : std::numeric_limits<double>::quiet_NaN();
    const double limit = std::min(double(std::numeric_limits<I>::max()), 9e15);  // exact in double
    if (!(std::abs(value) <= limit) || value != std::floor(value)) fail("must be a whole number");
    return static_cast<I>(value);
  }
  [[nodiscard]] std::string text() const {
    if (!json_->scalar().is_string()) fail("must be a text");
    return json_->scalar().get<std::string>();
  }
  [[nodiscard]] std::array<double, 3> triple() const {
    if (!json_->is_list() || json_->size() != 3) fail("must be a list of three numbers");
    const std::vector<Node> nodes = list();
    return {nodes[0].number(), nodes[1].number(), nodes[2].number()};
  }
  [[nodiscard]] bool is_string() const { return json_->scalar().is_string(); }
  [[nodiscard]] bool is_bool() const { return json_->scalar().is_boolean(); }
  [[nodiscard]] bool boolean() const { return json_->scalar().get<bool>(); }

 private:
  const Json* json_;
  std::string path_;
};

/// What the text of a node stands for, by rows of value and name, in the order in which the message lists them.
template <class Names>
auto pick(const Node& node, const Names& names) {
  const std::string text = node.text();
  std::string list;
  for (const auto& [value, name] : names) {
    if (text == name) return value;
    list += (list.empty() ? "" : ", ") + std::string(name);
  }
  node.fail("must be one of " + list);
}

/// The enumerators with their names.
template <class E, std::size_t N>
constexpr auto named(const E (&values)[N]) {
  std::array<std::pair<E, std::string_view>, N> names;
  for (std::size_t k = 0; k < N; ++k) names[k] = {values[k], name(values[k])};
  return names;
}

/// 0.25 or "1/4".
double cone_index(const Node& node) {
  if (!node.is_string()) return node.number();
  const std::string text = node.text();
  double over = 1, under = 1;
  const char* const end = text.data() + text.size();
  auto [stop, error] = std::from_chars(text.data() + text.starts_with('+'), end, over);
  if (error == std::errc() && stop != end && *stop == '/') {
    const auto rest = std::from_chars(stop + 1, end, under);
    error = rest.ec;
    stop = rest.ptr;
  }
  if (error != std::errc() || stop != end || !(under > 0))
    node.fail("must be a number, or a fraction such as \"-1/4\"");
  return over / under;
}

void read_place(const Node& node, const char* element, Index& number, std::optional<Vector3>& at) {
  if (const auto x = node.find(element)) number = x->whole<Index>();
  if (const auto x = node.find("at")) at = x->triple();
}

std::string read_name(const Node& node) {
  const auto x = node.find("name");
  return x ? x->text() : "";
}

DesignSingularity read_singularity(const Node& node) {
  node.keys({"name", "face", "at", "kind", "angle", "relative_to", "count", "strength", "pin"});
  DesignSingularity s{.name = read_name(node)};
  read_place(node, "face", s.face, s.at);
  s.kind = pick(node.at("kind"), names_of<SingularityKind>());
  if (const auto x = node.find("angle")) {
    s.angle = x->number();
  } else if (s.kind == SingularityKind::spiral) {
    node.fail("a spiral needs the key angle");
  }
  if (const auto x = node.find("relative_to")) s.relative_to = x->triple();
  if (const auto x = node.find("count")) s.count = x->whole<int>();
  if (const auto x = node.find("strength")) s.strength = x->number();
  if (const auto x = node.find("pin")) {
    if (x->is_bool()) {
      s.pin = x->boolean();
    } else {
      s.pin = true;
      s.barycentric = x->triple();
    }
  }
  return s;
}

DesignFixed read_fixed(const Node& node) {
  node.keys({"name", "vertex", "at", "direction", "angle", "relative_to", "length"});
  DesignFixed f{.name = read_name(node)};
  read_place(node, "vertex", f.vertex, f.at);
  if (const auto x = node.find("direction")) f.direction = x->triple();
  if (const auto x = node.find("angle")) f.angle = x->number();
  if (const auto x = node.find("relative_to")) f.relative_to = x->triple();
  if (const auto x = node.find("length")) {
    if (x->is_string()) {
      f.free_length = pick(*x, std::to_array<std::pair<bool, std::string_view>>({{true, "free"}}));
    } else {
      f.length = x->number();
    }
  }
  return f;
}

DesignStroke read_stroke(const Node& node) {
  node.keys({"name", "points", "vertices", "path", "weight", "radius"});
  DesignStroke s{.name = read_name(node)};
  const auto points = node.find("points"), vertices = node.find("vertices"), path = node.find("path");
  if (int(points.has_value()) + int(vertices.has_value()) + int(path.has_value()) != 1)
    node.fail("needs one of the keys points, vertices and path");
  if (vertices)
    for (const Node& v : vertices->list()) s.vertices.push_back(v.whole<Index>());
  if (path)
    for (const Node& p : path->list()) s.path.push_back(p.triple());
  for (const Node& p : points ? points->list() : std::vector<Node>{}) {
    p.keys({"face", "barycentric", "at"});
    DesignPoint point;
    read_place(p, "face", point.face, point.at);
    const auto b = p.find("barycentric");
    if (b.has_value() == point.at.has_value()) p.fail("needs either face and barycentric, or at");
    if (b) point.barycentric = b->triple();
    s.points.push_back(point);
  }
  if (const auto x = node.find("weight")) s.weight = x->number();
  if (const auto x = node.find("radius")) s.radius = x->number();
  return s;
}

std::string file_name(const Node& node) {
  std::string text = node.text();
  if (text.empty() || text.find('\0') != std::string::npos) node.fail("must be the name of a file");
  return text;
}

DesignFeatures read_features(const Node& node, const std::filesystem::path& folder) {
  node.keys(
      {"angle", "weight", "hold", "across", "file", "edges", "boundary", "corner_angle", "low_angle", "gap", "spur"});
  DesignFeatures f{.wanted = true};
  const auto number = [&](const char* key, double& value) {
    if (const auto x = node.find(key)) value = x->number();
  };
  const auto flag = [&](const char* key, bool& value) {
    const auto x = node.find(key);
    if (x && !x->is_bool()) x->fail("must be true or false");
    if (x) value = x->boolean();
  };
  number("angle", f.angle);
  number("weight", f.weight);
  number("corner_angle", f.corner_angle);
  number("low_angle", f.low_angle);
  number("gap", f.gap);
  number("spur", f.spur);
  flag("hold", f.hold);
  flag("across", f.across);
  flag("boundary", f.boundary);
  const auto file = node.find("file"), edges = node.find("edges");
  if (file) f.file = folder / file_name(*file);
  for (const Node& pair : edges ? edges->list() : std::vector<Node>{}) {
    const std::vector<Node> ends = pair.list();
    if (ends.size() != 2) pair.fail("must be a list of two vertices");
    f.edges.push_back({ends[0].whole<Index>(), ends[1].whole<Index>()});
  }
  if (edges && f.edges.empty()) edges->fail("needs an edge at least");
  if ((file || edges) && node.find("angle")) node.at("angle").fail("cannot be combined with file and edges");
  return f;
}

DesignBoundary read_boundary(const Node& node) {
  node.keys({"align", "weight"});
  constexpr auto names = std::to_array<std::pair<bool, std::string_view>>({{false, "tangent"}, {true, "normal"}});
  DesignBoundary b{.wanted = true, .normal = pick(node.at("align"), names)};
  if (const auto x = node.find("weight")) b.weight = x->number();
  return b;
}

/// Turns: numbers or fractions.
std::vector<double> read_turns(const Node& node) {
  std::vector<double> turns;
  for (const Node& x : node.list()) turns.push_back(cone_index(x));
  return turns;
}

VectorX<double> read_array(const Node& node) {
  const std::vector<Node> list = node.list();
  VectorX<double> values(static_cast<Eigen::Index>(list.size()));
  for (std::size_t k = 0; k < list.size(); ++k) values[static_cast<Eigen::Index>(k)] = list[k].number();
  return values;
}

ConnectionTarget read_target(const Node& node) {
  node.keys({"rotation", "adjustment", "vertex_curvature", "face_curvature"});
  ConnectionTarget target;
  int given = 0;
  const auto take = [&](const char* key, VectorX<double>& values) {
    const auto x = node.find(key);
    if (!x) return;
    values = read_array(*x);
    ++given;
  };
  take("rotation", target.rotation);
  take("adjustment", target.adjustment);
  take("vertex_curvature", target.vertex_curvature);
  take("face_curvature", target.face_curvature);
  if (given != 1 || target.levi_civita())
    node.fail(
        "needs one of the keys rotation, adjustment, vertex_curvature and face_curvature, with a list of numbers");
  return target;
}

void read_weights(const Node& node, DesignConnection& c) {
  if (const auto x = node.find("detail")) c.detail = x->number();
  if (const auto x = node.find("length_factor")) c.length_factor = pick(*x, names_of<LengthFactor>());
  if (const auto x = node.find("tan_cap")) c.tan_cap = x->number();
  if (const auto x = node.find("target")) c.target = read_target(*x);
  if (const auto x = node.find("spread")) {
    if (!x->is_bool()) x->fail("must be true or false");
    c.spread = x->boolean();
  }
}

DesignConnection read_connection(const Node& node) {
  node.keys(
      {"kind", "detail", "length_factor", "tan_cap", "cones", "balance", "holonomy", "loops", "target", "spread"});
  DesignConnection c;
  constexpr auto named_choice = [](ConnectionChoice choice) { return std::pair{choice, name(choice)}; };
  constexpr std::array names{
      named_choice({ConnectionKind::global}),  named_choice({ConnectionKind::local}),
      named_choice({ConnectionKind::polar}),   named_choice({ConnectionKind::polar, PolarCenter::barycenter}),
      named_choice({ConnectionKind::trivial}), named_choice({ConnectionKind::metric})};
  const ConnectionChoice choice = pick(node.at("kind"), names);
  c.kind = choice.kind;
  c.center = choice.center;
  read_weights(node, c);
  if (const auto x = node.find("cones")) {
    for (const Node& cone : x->list()) {
      cone.keys({"vertex", "at", "index"});
      const double index = cone_index(cone.at("index"));
      const auto vertex = cone.find("vertex"), at = cone.find("at");
      if (vertex.has_value() == at.has_value()) cone.fail("needs either vertex or at");
      if (vertex)
        c.cones.push_back({.vertex = vertex->whole<Index>(), .index = index});
      else
        c.cones_at.push_back({.at = at->triple(), .index = index});
    }
  }
  if (const auto x = node.find("balance")) {
    if (!x->is_bool()) x->fail("must be true or false");
    c.balance = x->boolean();
  }
  if (const auto x = node.find("holonomy")) c.holonomy = read_turns(*x);
  if (const auto x = node.find("loops")) c.loops = read_turns(*x);
  return c;
}

DesignGuidance read_guidance(const Node& node, const std::filesystem::path& folder) {
  node.keys({"field", "file", "weight", "t", "weights"});
  DesignGuidance g;
  const auto field = node.find("field"), file = node.find("file");
  if (field.has_value() == file.has_value()) node.fail("needs either field or file");
  if (field) {
    using enum DesignGuidance::Source;
    g.source = pick(*field, named({smoothest, curvature, least_curvature, strongest_curvature, zero}));
  } else {
    g.source = DesignGuidance::Source::file;
    g.file = folder / file_name(*file);
  }
  if (const auto x = node.find("weight")) g.weight = x->number();
  if (const auto x = node.find("t")) {
    g.t = x->number();
    if (node.find("weight")) x->fail("cannot be combined with weight");
  }
  if (const auto x = node.find("weights"))
    for (const Node& w : x->list()) g.weights.push_back(w.number());
  return g;
}

/// {"move": 0, "to": 12}, {"merge": [0, 1]} or {"split": 0, "to": 12, "count": 1}.
DesignEdit read_edit(const Node& node) {
  DesignEdit edit;
  const auto move = node.find("move"), merge = node.find("merge"), split = node.find("split");
  if (int(move.has_value()) + int(merge.has_value()) + int(split.has_value()) != 1)
    node.fail("needs one of the keys move, merge and split");
  const auto number = [](const Node& x) {
    const auto k = x.whole<std::int64_t>();
    if (k < 0) x.fail("must not be negative");
    return static_cast<std::size_t>(k);
  };
  if (merge) {
    node.keys({"merge"});
    const std::vector<Node> both = merge->list();
    if (both.size() != 2) merge->fail("must be a list of two singularities");
    return {.type = DesignEdit::Type::merge, .which = number(both[0]), .other = number(both[1])};
  }
  edit.type = move ? DesignEdit::Type::move : DesignEdit::Type::split;
  if (move)
    node.keys({"move", "to"});
  else
    node.keys({"split", "to", "count"});
  edit.which = number(move ? *move : *split);
  edit.to = node.at("to").whole<Index>();
  if (const auto x = node.find("count")) edit.count = x->whole<int>();
  return edit;
}

DesignFile read_all(const Node& node, const std::filesystem::path& folder) {
  node.keys({"$schema", "alcap_design", "comment", "mesh", "n", "method", "s", "connection", "guidance",
             "singularities", "fixed", "strokes", "boundary", "features", "edits"});
  if (const auto version = node.at("alcap_design"); version.whole<int>() != design_version)
    version.fail("this alcap reads version " + std::to_string(design_version));
  if (const auto x = node.find("$schema")) (void)x->text();
  DesignFile design;
  if (const auto x = node.find("comment")) design.comment = x->text();
  if (const auto x = node.find("mesh")) {
    x->keys({"vertices", "faces"});
    design.mesh = DesignMesh{x->at("vertices").whole<std::int64_t>(), x->at("faces").whole<std::int64_t>()};
  }
  design.n = node.at("n").whole<int>();
  if (const auto x = node.find("method")) {
    design.method = pick(*x, names_of<DesignMethod>());
  }
  if (const auto x = node.find("s")) design.s = x->number();
  if (const auto x = node.find("boundary")) design.boundary = read_boundary(*x);
  if (const auto x = node.find("features")) design.features = read_features(*x, folder);
  if (const auto x = node.find("connection")) design.connection = read_connection(*x);
  if (const auto x = node.find("guidance")) design.guidance = read_guidance(*x, folder);
  if (const auto x = node.find("singularities"))
    for (const Node& s : x->list()) design.singularities.push_back(read_singularity(s));
  if (const auto x = node.find("fixed"))
    for (const Node& f : x->list()) design.fixed.push_back(read_fixed(f));
  if (const auto x = node.find("strokes"))
    for (const Node& s : x->list()) design.strokes.push_back(read_stroke(s));
  if (const auto x = node.find("edits"))
    for (const Node& e : x->list()) design.edits.push_back(read_edit(e));
  return design;
}

/// The text of a file, and its name for messages.
std::string read_text(const std::filesystem::path& path) {
  const detail::InputFile file(path, {.what = "design file", .largest = largest});
  if (file.bytes().empty())
    throw FileError(path.string() + ": is empty; give a design file (docs/design.md)", path.string());
  return std::string(file.bytes());
}

}  // namespace

DesignFile parse_design(std::string_view text, const std::string& name, const std::filesystem::path& folder) {
  const Json json = detail::parse_json(text, name, deepest);
  try {
    DesignFile design = read_all(Node(json, ""), folder);
    detail::check_design_values(design);
    return design;
  } catch (const Problem& p) {
    throw FileError(name + ": " + p.path + " = " + p.value + ": " + p.rule, name);
  }
}

DesignFile read_design(const std::filesystem::path& path) {
  return parse_design(read_text(path), path.string(), path.parent_path());
}

ConnectionTarget read_connection_target(const std::filesystem::path& path) {
  const std::string name = path.string();
  const Json json = detail::parse_json(read_text(path), name, deepest);
  try {
    return read_target(Node(json, ""));
  } catch (const Problem& p) {
    throw FileError(name + ": " + p.path + " = " + p.value + ": " + p.rule, name);
  }
}

}  // namespace alcap
