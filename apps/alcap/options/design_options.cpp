// SPDX-License-Identifier: MIT
//
// design_options.cpp: the flags of `alcap design`.
#include "apps/alcap/options/design_options.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "apps/alcap/options/cli.h"
#include "apps/alcap/options/shared_options.h"
#include "src/base/input_file.h"

namespace alcap::app {
namespace {

/// The parts of TEXT between colons, numbers read strictly.
class Parts {
 public:
  Parts(const char* option, const char* form, std::string text)
      : option_(option), form_(form), whole_(std::move(text)) {
    for (std::size_t from = 0; from <= whole_.size();) {
      const std::size_t to = std::min(whole_.find(':', from), whole_.size());
      parts_.push_back(whole_.substr(from, to - from));
      from = to + 1;
    }
  }
  [[nodiscard]] std::size_t size() const { return parts_.size(); }
  [[nodiscard]] const std::string& text(std::size_t k) const { return parts_[k]; }
  void expect(std::size_t least, std::size_t most) const {
    if (size() < least || size() > most) fail();
  }
  template <class T>
  [[nodiscard]] T number(std::string_view text) const {
    T value{};
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || stop != text.data() + text.size() || !std::isfinite(double(value))) fail();
    return value;
  }
  template <class Whole = Index>
  [[nodiscard]] Whole index(std::size_t k) const {
    const auto value = number<Whole>(parts_[k]);
    if (value < 0) fail();
    return value;
  }
  [[nodiscard]] double angle(std::size_t k) const { return k < size() ? number<double>(parts_[k]) : 0.0; }
  [[noreturn]] void fail() const { throw cli::ValidationError(option_, fmt::format("{} should be {}", whole_, form_)); }

 private:
  const char* option_;
  const char* form_;
  std::string whole_;
  std::vector<std::string> parts_;
};

DesignFixed parse_fixed(const std::string& text) {
  const Parts parts("--fix", "VERTEX:ANGLE or VERTEX:X,Y,Z, such as 12:30 or 12:1,0,0", text);
  parts.expect(2, 2);
  DesignFixed fixed{.name = "--fix " + text, .vertex = parts.index(0)};
  std::vector<double> numbers;
  const std::string& list = parts.text(1);
  for (std::size_t from = 0; from <= list.size();) {
    const std::size_t to = std::min(list.find(',', from), list.size());
    numbers.push_back(parts.number<double>(std::string_view(list).substr(from, to - from)));
    from = to + 1;
  }
  if (numbers.size() == 1) {
    fixed.angle = numbers[0];
  } else if (numbers.size() == 3) {
    fixed.direction = Vector3{numbers[0], numbers[1], numbers[2]};
  } else {
    parts.fail();
  }
  return fixed;
}

/// FILE or FILE:WEIGHT. A point "x y z" a line; empty lines separate strokes, # starts a comment.
std::vector<DesignStroke> read_strokes(const std::string& text) {
  double weight = 1;
  std::string path = text;
  if (const std::size_t colon = text.rfind(':'); colon != std::string::npos) {
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + colon + 1, end, weight);
    if (error == std::errc() && stop == end) path = text.substr(0, colon);
  }
  if (path.empty())
    throw Failure(Exit::usage, "--stroke: the name is empty", {{"option", "--stroke"}, {"value", text}});
  if (!(weight > 0) || !std::isfinite(weight))
    throw Failure(Exit::usage, "--stroke: " + text + " should be FILE or FILE:WEIGHT with a weight above 0",
                  {{"option", "--stroke"}, {"value", text}});
  const detail::InputFile input(path, {.what = "file of points", .largest = std::int64_t{1} << 30});
  std::istringstream file{std::string(input.bytes())};
  std::vector<DesignStroke> strokes(1);
  std::string line;
  for (std::int64_t number = 1; std::getline(file, line); ++number) {
    line.resize(std::min(line.find('#'), line.size()));
    std::vector<double> point;
    const char *at = line.data(), *const end = line.data() + line.size();
    while (at != end) {
      if (*at == ' ' || *at == '\t' || *at == '\r' || *at == ',') {
        ++at;
        continue;
      }
      double value = 0;
      const auto [stop, error] = std::from_chars(at, end, value);
      if (error != std::errc() || !std::isfinite(value))
        throw FileError(fmt::format("{}:{}: not a number: {}", path, number, std::string(at, end)), path, number);
      point.push_back(value);
      at = stop;
    }
    if (point.empty()) {
      if (!strokes.back().path.empty()) strokes.emplace_back();
    } else if (point.size() == 3) {
      strokes.back().path.push_back({point[0], point[1], point[2]});
    } else {
      throw FileError(fmt::format("{}:{}: {} numbers instead of a point x y z", path, number, point.size()), path,
                      number);
    }
  }
  if (strokes.back().path.empty()) strokes.pop_back();
  if (strokes.empty()) throw FileError(path + ": holds no stroke", path);
  for (std::size_t k = 0; k < strokes.size(); ++k) {
    if (strokes[k].path.size() < 2)
      throw FileError(fmt::format("{}: stroke {} has one point; at least two are needed", path, k), path);
    strokes[k].name = strokes.size() == 1 ? "--stroke " + text : fmt::format("--stroke {} ({})", text, k);
    strokes[k].weight = weight;
  }
  return strokes;
}

/// "smoothest", "zero:0.1", "out/field.ply:2"
DesignGuidance parse_guidance(const std::string& text) {
  DesignGuidance guidance;
  std::string what = text;
  if (const std::size_t colon = text.rfind(':'); colon != std::string::npos) {
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + colon + 1, end, guidance.weight);
    if (error == std::errc() && stop == end) what = text.substr(0, colon);
  }
  if (!(guidance.weight > 0) || !std::isfinite(guidance.weight) || what.empty())
    throw cli::ValidationError("--guidance",
                               text + " should be FIELD.ply, smoothest, curvature or zero, then :WEIGHT above 0");
  if (what == "smoothest") {
    guidance.source = DesignGuidance::Source::smoothest;
  } else if (what == "curvature") {
    guidance.source = DesignGuidance::Source::curvature;
  } else if (what == "least-curvature") {
    guidance.source = DesignGuidance::Source::least_curvature;
  } else if (what == "strongest-curvature") {
    guidance.source = DesignGuidance::Source::strongest_curvature;
  } else if (what == "zero") {
    guidance.source = DesignGuidance::Source::zero;
  } else {
    guidance.source = DesignGuidance::Source::file;
    guidance.file = what;
  }
  return guidance;
}

using Texts = std::vector<std::string>;

cli::Option* add_list(cli::App& app, const char* option, const char* form, const char* help,
                      std::function<void(const std::string&)> take) {
  return app
      .add_option_function<Texts>(
          option,
          [take = std::move(take)](const Texts& texts) {
            for (const std::string& t : texts) take(t);
          },
          help)
      ->type_name(form)
      ->allow_extra_args(false)
      ->group("Controls");
}

void add_singularities(cli::App& app, DesignFlags& flags, const char* option, SingularityKind kind, const char* help) {
  add_list(app, option, "FACE[:ANGLE]", help, [&flags, option, kind](const std::string& text) {
    const Parts parts(option, "FACE or FACE:ANGLE, such as 12:30 (degrees)", text);
    parts.expect(1, 2);
    flags.singularities.push_back(
        {.name = std::string(option) + " " + text, .face = parts.index(0), .kind = kind, .angle = parts.angle(1)});
  });
}

void add_singularity_options(cli::App& app, DesignFlags& flags) {
  add_singularities(app, flags, "--source", SingularityKind::source,
                    "Singularity of index +1/n in this face. n = 1: a source that ANGLE (degrees) turns into a "
                    "spiral; otherwise ANGLE is the direction of a branch, from the face's first edge");
  add_singularities(app, flags, "--sink", SingularityKind::sink, "A sink (n = 1)");
  add_singularities(app, flags, "--vortex", SingularityKind::vortex,
                    "A counter-clockwise vortex (n = 1); ANGLE 180 makes it clockwise");
  add_singularities(app, flags, "--saddle", SingularityKind::saddle,
                    "Singularity of index -1/n; ANGLE is the direction of a branch, from the face's first edge");
  add_list(app, "--singularity", "FACE:+-K[:ANGLE]",
           "Index +K/n or -K/n in this face: K zeros side by side, in it and in the nearest faces",
           [&flags](const std::string& text) {
             const Parts parts("--singularity", "FACE:+1 or FACE:-1 (or more), then :ANGLE if wanted", text);
             parts.expect(2, 3);
             const int index = parts.number<int>(parts.text(1));
             if (index == 0 || std::abs(index) > 1000) parts.fail();
             flags.singularities.push_back({.name = "--singularity " + text,
                                            .face = parts.index(0),
                                            .kind = index > 0 ? SingularityKind::source : SingularityKind::saddle,
                                            .angle = parts.angle(2),
                                            .count = std::abs(index)});
           });
  const auto edit = [&app, &flags](const char* option, const char* form, const char* help, DesignEdit::Type type) {
    add_list(app, option, form, help, [&flags, option, form, type](const std::string& text) {
      const Parts parts(option, form, text);
      parts.expect(2, type == DesignEdit::Type::split ? 3 : 2);
      DesignEdit e{.type = type, .which = static_cast<std::size_t>(parts.index(0))};
      if (type == DesignEdit::Type::merge)
        e.other = static_cast<std::size_t>(parts.index(1));
      else
        e.to = parts.index(1);
      if (parts.size() == 3) e.count = parts.index<int>(2);
      flags.edits.push_back(e);
    });
  };
  edit("--move", "NUMBER:FACE", "Move a singularity, counted from 0 through the design file and then the flags",
       DesignEdit::Type::move);
  edit("--merge", "NUMBER:NUMBER", "Add the index of the second singularity to the first, and take it away",
       DesignEdit::Type::merge);
  edit("--split", "NUMBER:FACE[:COUNT]", "COUNT n-ths (1) of a singularity go to another face",
       DesignEdit::Type::split);
  app.add_option("--relative-to", flags.relative_to,
                 "Angles of the singularities given as flags start from this direction of space, projected to the face")
      ->type_name("X,Y,Z")
      ->delimiter(',')
      ->expected(3)
      ->group("Controls");
  app.add_option("--strength", flags.strength, "Of the singularities given as flags; 1 holds against unit guidance")
      ->type_name("X")
      ->capture_default_str()
      ->check(cli::PositiveNumber)
      ->group("Controls");
  app.add_flag("--pin", flags.pin, "Zeros of the singularities given as flags lie at the centers of their faces")
      ->group("Controls");
}

void add_constraint_options(cli::App& app, DesignFlags& flags) {
  add_list(
      app, "--fix", "VERTEX:DIRECTION",
      "The field at a vertex: VERTEX:X,Y,Z a direction of space, VERTEX:ANGLE degrees from the vertex frame's axis",
      [&flags](const std::string& text) { flags.fixed.push_back(parse_fixed(text)); });
  app.add_option_function<std::string>(
         "--guidance", [&flags](const std::string& text) { flags.guidance = parse_guidance(text); },
         "What the field stays close to: FIELD.ply written by alcap, smoothest, curvature or strongest-curvature "
         "(n even), least-curvature (n = 2) or zero; then :WEIGHT, default 1")
      ->type_name("FIELD[:WEIGHT]")
      ->group("Controls");
  add_list(app, "--stroke", "FILE[:WEIGHT]",
           "The field follows polylines of points \"x y z\", one a line, empty lines between strokes; default weight 1",
           [&flags](const std::string& text) { flags.strokes.push_back(text); });
}

void add_alignment_options(cli::App& app, DesignFlags& flags) {
  app.add_option_function<double>(
         "--align-curvature",
         [&flags](double t) { flags.guidance = DesignGuidance{.source = DesignGuidance::Source::curvature, .t = t}; },
         "Principal directions (n even) as guidance with lambda_t = T times lambda_min of a sphere of this area: 0 "
         "balances, negative follows them closer, towards lambda_1 the field is only smooth")
      ->type_name("T")
      ->group("Controls");
  app.add_option_function<double>(
         "--t", [&flags](double t) { flags.t = t; },
         "Weigh the guidance field by lambda_t, as --align-curvature does, instead of :WEIGHT")
      ->type_name("T")
      ->group("Controls");
  app.add_flag_function(
         "--align-boundary", [&flags](std::int64_t) { flags.boundary = {.wanted = true}; },
         "The field runs along the boundary")
      ->group("Controls");
  app.add_flag_function(
         "--align-boundary-normal", [&flags](std::int64_t) { flags.boundary = {.wanted = true, .normal = true}; },
         "The field runs into the boundary at a right angle")
      ->group("Controls");
}

void add_features(cli::App& app, DesignFlags& flags) {
  app.add_option_function<std::string>(
         "--align-features",
         [&flags](const std::string& text) { flags.features_angle = feature_angle(text) * 180 / pi<double>; },
         "A field of even n drawn along all edges that fold by ANGLE degrees (default 40), by a stroke along each "
         "line; "
         "after MESH, or with =ANGLE")
      ->type_name("ANGLE")
      ->expected(0, 1)
      ->group("Alignment");
  app.add_flag("--align-hold", flags.hold, "Hold the directions at the vertices of features, instead of drawing alone")
      ->group("Alignment");
  app.add_flag("--feature-boundary", flags.feature_boundary, "Edges of the boundary are features too")
      ->group("Alignment");
  add_feature_options(app, flags.features,
                      "How strongly features draw; with --align-hold, how strongly lengths along them are drawn to 1");
}

/// What the flags say of features, on top of the design file's.
void take_features(const DesignFlags& flags, DesignFeatures& features) {
  const FeatureFlags& f = flags.features;
  if (!flags.features_angle && !flags.hold && !flags.feature_boundary && !f.any()) return;
  features.wanted = true;
  if (flags.features_angle || !f.file.empty()) {
    features.file = f.file.empty() ? f.file : std::filesystem::absolute(f.file);
    features.edges.clear();
  }
  if (flags.features_angle) features.angle = *flags.features_angle;
  features.hold = features.hold || flags.hold;
  features.across = features.across || f.across;
  features.boundary = features.boundary || flags.feature_boundary;
  features.weight = f.weight.value_or(features.weight);
  features.corner_angle = f.corner_angle.value_or(features.corner_angle);
  features.low_angle = f.low_angle.value_or(features.low_angle);
  features.gap = f.gap.value_or(features.gap);
  features.spur = f.spur.value_or(features.spur);
}

void add_method_options(cli::App& app, DesignFlags& flags) {
  app.add_option_function<std::string>(
         "--method",
         [&flags](const std::string& method) {
           flags.method = method == "eigen" ? DesignMethod::eigen : DesignMethod::variational;
         },
         "variational: one linear solve, every control; eigen: the smoothest field with these singularities and "
         "strokes. Default: the design file's, or variational")
      ->type_name("METHOD")
      ->check(cli::IsMember({"variational", "eigen"}))
      ->group("Solver");
  app.add_option("-s,--energy", flags.s, "Energy family in [-1, 1]: 0 Dirichlet, 1 holomorphic, -1 antiholomorphic")
      ->type_name("S")
      ->check(cli::Range(-1.0, 1.0))
      ->group("Solver");
}

/// What the flags say of the connection, on top of the design file's.
void take_connection(const DesignFlags& flags, DesignConnection& connection) {
  const ConnectionOptions& given = flags.connection;
  const auto any = [&](std::initializer_list<const char*> options) {
    return std::any_of(options.begin(), options.end(), [&](const char* o) { return flags.count(o) > 0; });
  };
  if (any({"--connection", "--cone", "--cones", "--holonomy", "--loop-index", "--target"})) {
    const bool kept = given.kind == ConnectionKind::trivial || given.kind == ConnectionKind::metric;
    if (!kept) {
      connection.cones.clear();
      connection.cones_at.clear();
      connection.holonomy.clear();
      connection.loops.clear();
      connection.target = {};
    }
    // Cones added to those of a metric connection leave it one.
    if (any({"--connection", "--target", "--cones"}) || connection.kind != ConnectionKind::metric)
      connection.kind = given.kind;
    connection.center = given.polar.center;
  }
  for (const Cone& cone : given.cones) connection.cones.push_back(cone);
  if (any({"--holonomy"})) connection.holonomy = given.generator_holonomy;
  if (any({"--loop-index"})) connection.loops = given.loop_index;
  if (any({"--target"})) connection.target = given.target;
  if (any({"--hold-curvature"})) connection.spread = false;
  if (any({"--detail"})) connection.detail = given.global.detail;
  if (any({"--length-factor"})) connection.length_factor = given.global.length_factor;
  if (any({"--tan-cap"})) connection.tan_cap = given.global.tan_cap;
}

}  // namespace

void add_design_options(cli::App& app, DesignFlags& flags) {
  app.add_option("--design", flags.file, "The design as JSON (docs/design.md); flags add to it")->type_name("FILE");
  app.add_option("-n,-r,--degree,--rosy", flags.n,
                 "Symmetry: 1 vectors, 2 lines, 4 crosses, 6 hexagonal. Default: the design file's, or 1")
      ->type_name("N")
      ->check(cli::Range(1, 1000));
  add_singularity_options(app, flags);
  add_constraint_options(app, flags);
  add_alignment_options(app, flags);
  add_features(app, flags);
  add_method_options(app, flags);
  add_connection_options(app, flags.connection);
  flags.count = [&app](const char* option) { return app.get_option(option)->count(); };
}

DesignFile make_design(const DesignFlags& flags) {
  DesignFile design;
  if (!flags.file.empty()) design = read_design(flags.file);
  if (flags.file.empty() || flags.count("-n") > 0) design.n = flags.n;
  if (flags.count("--method") > 0) design.method = flags.method;
  if (flags.count("--energy") > 0) design.s = flags.s;
  if (flags.boundary.wanted) design.boundary = flags.boundary;
  take_features(flags, design.features);
  if (flags.count("--cones") > 0) design.connection.balance = true;
  take_connection(flags, design.connection);
  if (flags.guidance) design.guidance = *flags.guidance;
  if (flags.t) {
    if (design.guidance.source == DesignGuidance::Source::nothing)
      throw Failure(Exit::usage, "--t weighs a guidance field; give one with --guidance", {{"option", "--t"}});
    design.guidance.weight = 1;
    design.guidance.t = flags.t;
  }
  if (const std::vector<double>& x = flags.relative_to; !x.empty() && (!std::all_of(x.begin(), x.end(), [](double c) {
        return std::isfinite(c);
      }) || std::all_of(x.begin(), x.end(), [](double c) { return c == 0; })))
    throw Failure(Exit::usage, fmt::format("--relative-to: {},{},{} is not a direction", x[0], x[1], x[2]),
                  {{"option", "--relative-to"}});
  for (DesignSingularity s : flags.singularities) {
    s.strength = flags.strength;
    s.pin = flags.pin;
    const bool swirl = index_of(s.kind) * s.count == design.n;
    if (flags.relative_to.size() == 3 && !swirl)
      s.relative_to = Vector3{flags.relative_to[0], flags.relative_to[1], flags.relative_to[2]};
    design.singularities.push_back(std::move(s));
  }
  for (const DesignFixed& f : flags.fixed) design.fixed.push_back(f);
  for (const std::string& text : flags.strokes)
    for (DesignStroke& s : read_strokes(text)) design.strokes.push_back(std::move(s));
  for (const DesignEdit& e : flags.edits) design.edits.push_back(e);
  check_design(design);
  const bool nothing = design.singularities.empty() && design.fixed.empty() && design.strokes.empty() &&
                       !design.boundary.wanted && !design.features.wanted && design.method != DesignMethod::eigen &&
                       design.connection.cones.empty() && design.connection.cones_at.empty() &&
                       !design.connection.balance &&
                       (design.guidance.source == DesignGuidance::Source::nothing ||
                        design.guidance.source == DesignGuidance::Source::zero);
  if (nothing)
    throw Failure(
        Exit::usage,
        "nothing is designed; give --design FILE, singularities, fixed vertices, strokes, cones, --align-boundary, or "
        "--guidance smoothest");
  return design;
}

}  // namespace alcap::app
