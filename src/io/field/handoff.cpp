// SPDX-License-Identifier: MIT
#include "alcap/handoff.h"

#include "alcap/mesh_io.h"
#include "src/base/atomic_file.h"
#include "src/base/cancel.h"

namespace alcap {
namespace {

std::filesystem::path with(const std::filesystem::path& stem, const char* extension) {
  std::filesystem::path path = stem;
  return path += extension;
}

/// QuadWild's setup has these four lines, in this order. What it would remesh, find or repair is in the files already;
/// alpha and scaleFact are its own defaults.
constexpr const char* quadwild_setup = "do_remesh 0\nsharp_feature_thr -1\nalpha 0.02\nscaleFact 1\n";

std::vector<std::filesystem::path> write_quadwild(const FieldOutput& output, const FeatureGraph* features,
                                                  const std::filesystem::path& stem) {
  if (output.field.n != 4) throw OptionError("n", output.field.n, "must be 4 for QuadWild, which takes crosses");
  std::vector<std::filesystem::path> files{with(stem, ".obj"), with(stem, ".rosy"), with(stem, ".sharp"),
                                           with(stem, ".txt")};
  write_field(output, files[1]);
  write_mesh(files[0], output.surface.V(), output.surface.F());
  write_sharp(output.surface, features != nullptr ? *features : FeatureGraph{}, files[2]);
  detail::AtomicFile setup(files[3]);
  setup.write(quadwild_setup);
  setup.commit();
  return files;
}

std::vector<std::filesystem::path> write_directional(const FieldOutput& output, const std::filesystem::path& stem) {
  std::vector<std::filesystem::path> files = write_field(output, with(stem, ".rawfield"));
  files.insert(files.begin(), with(stem, ".off"));
  write_mesh(files[0], output.surface.V(), output.surface.F());
  return files;
}

}  // namespace

std::vector<std::filesystem::path> write_for(Reader reader, const FieldOutput& output, const FeatureGraph* features,
                                             const std::filesystem::path& stem, const RunControl& control) {
  FieldOutput unit = output;
  unit.unit = true;
  return controlled(control, [&] {
    return reader == Reader::quadwild ? write_quadwild(unit, features, stem) : write_directional(unit, stem);
  });
}

std::string command_for(Reader reader, const std::filesystem::path& stem) {
  const auto file = [&](const char* extension) { return " " + with(stem, extension).string(); };
  if (reader == Reader::quadwild)
    return "quadwild" + file(".obj") + " 3" + file(".rosy") + file(".sharp") + file(".txt");
  return "directional::readOFF" + file(".off") + ", read_raw_field" + file(".rawfield");
}

}  // namespace alcap
