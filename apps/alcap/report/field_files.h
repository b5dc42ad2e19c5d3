// SPDX-License-Identifier: MIT
//
// field_files.h: -o and --formats of the commands that compute a field: one file, or a folder of all formats with a
// report.json.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "alcap/output.h"
#include "apps/alcap/report/outputs.h"

namespace alcap::app {

struct FilesChoice {
  std::filesystem::path output = {};      ///< empty: nothing is written
  std::vector<std::string> formats = {};  ///< of the files in a folder; empty: all
};

/// Adds -o and --formats.
void add_files_options(cli::App& app, FilesChoice& choice);

/// The formats asked for, or all of them. Throws Failure(usage) for an unknown one.
[[nodiscard]] std::vector<std::string> chosen_formats(const FilesChoice& choice);

/// Throws Failure as plan_output and chosen_formats do, and when --formats comes with a file.
[[nodiscard]] OutputPlan plan_files(const FilesChoice& choice);

/// Throws Failure(usage) when what is written as planned, and the `others`, are not all different files, or one of them
/// is an input.
void check_names(const OutputPlan& plan, const std::vector<NamedPath>& others, const std::vector<NamedPath>& inputs);

/// What is written of a run, a FieldRun or a DesignRun; refers to it.
template <class Run>
[[nodiscard]] FieldOutput output_of(const Run& run) {
  return {.surface = run.surface, .field = run.field, .singularities = run.singularities};
}

/// Writes the field as planned. Into a folder go also what `extra` writes there (it returns the names of its files) and
/// report.json: what `finish` returns when it is told the files of the run. It is called once, whatever is written.
void write_files(const OutputPlan& plan, const FilesChoice& choice, const FieldOutput& output,
                 const std::function<std::vector<std::string>(const std::filesystem::path& folder)>& extra,
                 const std::function<const Json&(const std::vector<std::string>& files)>& finish);

}  // namespace alcap::app
