// SPDX-License-Identifier: MIT
//
// handoff.h: everything that another program needs to go on from a field, in one call: files in its formats, that
// belong together. docs/recipes/quads.md goes on from there to a quad mesh.
//
//   alcap::FieldRun run = alcap::run_field(V, F, {.n = 4, .align = alcap::FieldAlignment{}, .normalise = true});
//   alcap::write_for(alcap::Reader::quadwild, {run.surface, run.field, run.singularities}, &run.features->graph,
//                    "out/part");
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "alcap/names.h"
#include "alcap/output.h"

namespace alcap {

/// Programs that take a field.
enum class Reader {
  quadwild,     ///< QuadWild (Pietroni et al. 2021) and its version with the solver of Bi-MDF: crosses to quads
  directional,  ///< the library Directional, face-based: integration, meshing
};

template <>
struct NamesOf<Reader> {
  static constexpr auto table =
      detail::name_table<Reader>({{Reader::quadwild, "quadwild"}, {Reader::directional, "directional"}});
};

/// Writes STEM with the extensions that the reader wants, and returns the files. The mesh is that of the field, repairs
/// included, so that faces and vertices have the same numbers in all of them; directions have length 1.
///   quadwild     .obj, .rosy, .sharp (of `features`, none without), .txt (a setup that keeps the mesh); n = 4
///   directional  .off, .rawfield and .sings per face; `features` are not used
/// Throws OptionError for an n that the reader does not take, and what write_field throws. Each file appears complete
/// or not at all.
std::vector<std::filesystem::path> write_for(Reader reader, const FieldOutput& output, const FeatureGraph* features,
                                             const std::filesystem::path& stem, const RunControl& control = {});

/// The command that reads these files, or what the program's documentation says to call.
[[nodiscard]] std::string command_for(Reader reader, const std::filesystem::path& stem);

}  // namespace alcap
