// SPDX-License-Identifier: MIT
//
// field_files.h: -o and --formats of the commands that compute a field: one file, or a folder of several formats with a
// report.json.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "alcap/handoff.h"
#include "alcap/output.h"
#include "apps/alcap/report/outputs.h"

namespace alcap::app {

struct FilesChoice {
  std::filesystem::path output = {};      ///< empty: nothing is written
  std::vector<std::string> formats = {};  ///< of the files in a folder; empty: the usual ones
  std::optional<Reader> reader = {};      ///< what write_for() writes instead
};

/// Adds -o, --formats and --for.
void add_files_options(cli::App& app, FilesChoice& choice);

/// The formats asked for, or the usual ones. Throws Failure(usage) for an unknown one.
[[nodiscard]] std::vector<std::string> chosen_formats(const FilesChoice& choice);

/// Throws Failure as plan_output and chosen_formats do, when --formats comes with a file, and when --for comes with
/// --formats or without a folder.
[[nodiscard]] OutputPlan plan_files(const FilesChoice& choice);

/// Throws Failure(usage) when what is written as planned, and the `others`, are not all different files, or one of them
/// is an input.
void check_names(const OutputPlan& plan, const FilesChoice& choice, const std::vector<NamedPath>& others,
                 const std::vector<NamedPath>& inputs);

/// What is written of a run, a FieldRun or a DesignRun; refers to it. `unit`: its field is one of unit directions.
template <class Run>
[[nodiscard]] FieldOutput output_of(const Run& run, bool unit) {
  return {
      .surface = run.surface, .field = run.field, .singularities = run.singularities, .face_scalars = {}, .unit = unit};
}

/// Writes the field as planned. Into a folder go also what `extra` writes there (it returns the names of its files),
/// the feature edges, if any, as field.sharp, and report.json: what `finish` returns when it is told the files of the
/// run. It is called once, whatever is written.
void write_files(const OutputPlan& plan, const FilesChoice& choice, const FieldOutput& output,
                 const FeatureGraph* features,
                 const std::function<std::vector<std::string>(const std::filesystem::path& folder)>& extra,
                 const std::function<const Json&(const std::vector<std::string>& files)>& finish);

}  // namespace alcap::app
