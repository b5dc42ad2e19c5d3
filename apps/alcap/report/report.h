// SPDX-License-Identifier: MIT
//
// report.h: results as JSON. The keys are an interface: docs/report.md lists every one, and a change of meaning raises
// `report_version`. Numbers that are not finite become null.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "alcap/errors.h"
#include "alcap/field_run.h"
#include "alcap/mesh_check.h"
#include "alcap/mesh_io.h"
#include "alcap/streamlines.h"
#include "apps/alcap/commands/command.h"

namespace alcap::app {

inline constexpr int report_version = 1;

/// null for NaN and infinities.
[[nodiscard]] Json number(double value);

/// What every report begins with: program, version, command, ok.
[[nodiscard]] Json report_head(const std::string& command, bool ok);

/// The whole answer to a failed command.
[[nodiscard]] Json error_report(const std::string& command, Exit exit, const std::string& message, const Json& details);
[[nodiscard]] Json file_details(const FileError& error);
[[nodiscard]] Json mesh_details(const MeshError& error);

/// Stable names.
[[nodiscard]] const char* name(Exit exit);

[[nodiscard]] Json input_json(const std::filesystem::path& path, const MeshFile& file);
[[nodiscard]] Json mesh_json(const Surface& surface);
/// The triangles that a run was solved on, and the connection that was asked for, which is made there.
[[nodiscard]] Json triangulation_json(const SolvedTriangulation& t, const ConnectionOptions& options);
[[nodiscard]] Json connection_json(const ConnectedSurface& surface, const ConnectionOptions& options);
[[nodiscard]] Json remarks_json(const std::vector<Remark>& remarks, bool warnings);
/// What was found: counts, sums and the list. `n` is the field's.
[[nodiscard]] Json singularities_json(const Surface& surface, int n, const std::vector<IndexSum>& sums,
                                      const std::vector<Singularity>& singularities);
/// How many curves, points, and why they end.
[[nodiscard]] Json curves_json(const CurveSet& curves);
/// The warning that curves are missing or end early because they would have too many points.
[[nodiscard]] Remark curves_cut_short();
[[nodiscard]] Json defects_json(const std::vector<DefectReport>& defects);

/// How features were asked for.
struct AlignmentAsked {
  double angle_degrees = 0;
  bool boundary = false, across = false;
  double weight = 0;
  bool hold = false;
};

/// What a field was aligned with, and how well.
[[nodiscard]] Json alignment_json(const FieldFeatures& features, const AlignmentAsked& asked);

struct RunSeconds {
  double read = 0, write = 0, total = 0;
};

/// The report of `alcap field` without its `files`.
[[nodiscard]] Json field_report(const std::filesystem::path& path, const MeshFile& file, const FieldRun& run,
                                const FieldRunOptions& options);
/// Lines of the summary about the triangles that a field was solved on.
[[nodiscard]] std::string triangulation_summary(const Json& triangulation);

/// The lines of a summary that say how features are followed.
[[nodiscard]] std::string alignment_summary(const Json& alignment);
/// Its `times`.
[[nodiscard]] Json times_json(const FieldTimes& times, const RunSeconds& seconds);

/// A line of a summary.
[[nodiscard]] std::string summary_line(std::string_view label, const std::string& value);

/// What is known about a field being the smoothest: the word of its certificate and, on a surface in one piece, what
/// the report of its eigenpair adds.
[[nodiscard]] std::string smallest_text(const Json& certificate, const Json& eigen, bool one_piece);

/// A number in four digits.
[[nodiscard]] std::string short_text(const Json& value);

/// The last lines of a summary in words: warnings, notes, files, whether the certificate holds.
[[nodiscard]] std::string summary_end(const Json& report);

/// The head and the warnings, for stderr.
[[nodiscard]] std::string complaint(const std::string& head, const std::vector<Remark>& remarks);

/// 69451 -> "69,451".
[[nodiscard]] std::string grouped(std::int64_t value);

}  // namespace alcap::app
