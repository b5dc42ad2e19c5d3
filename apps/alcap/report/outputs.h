// SPDX-License-Identifier: MIT
//
// outputs.h: output files and folders that are complete or not there.
//
// A folder is written as a hidden temporary folder beside it. When everything is in it, it is renamed to its final
// name; if the folder exists already, its old report.json is removed, the new files replace the old ones one by one,
// and the new report.json comes last. So a report.json always belongs to complete files, and a run that fails while
// computing or writing leaves no trace. Ctrl-C ends the program at once while it computes, when there is nothing to
// clean up; while it writes, what was written is removed first. Names of temporary folders are random and created by
// nobody else; everything is on the disk before it gets its name.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "alcap/field_run.h"
#include "apps/alcap/commands/command.h"

namespace alcap::app {

/// Throws Failure(output) when a file cannot be created there: no such folder, no permission, it is a folder. Called
/// before long work.
void check_writable(const std::filesystem::path& file);

/// The temporary files and folders beside `target` that runs which were killed have left: a warning each. Nothing is
/// deleted.
[[nodiscard]] std::vector<Remark> leftover_remarks(const std::filesystem::path& target);

/// A file by the flag that names it, or by what it is.
using NamedPath = std::pair<std::string, std::filesystem::path>;

/// Throws Failure(usage) when two outputs are the same file, or an output is an input. Empty paths do not count.
void check_distinct(const std::vector<NamedPath>& outputs, const std::vector<NamedPath>& inputs);

/// Writes a text file that appears complete or not at all. Throws Failure(output).
void write_text(const std::filesystem::path& file, std::string_view text);

/// What -o means: a folder, or one file whose extension picks the format.
struct OutputPlan {
  enum class Kind { nothing, file, folder };
  Kind kind = Kind::nothing;
  std::filesystem::path target = {};
};

/// A name that ends with one of `extensions` is a file, unless it is an existing folder. A name without an extension,
/// one with a slash at the end, or an existing folder is a folder. Throws Failure: usage for an unknown extension,
/// output when it cannot be written.
[[nodiscard]] OutputPlan plan_output(const std::filesystem::path& path, const std::vector<std::string>& extensions);

/// Calls write(folder), which writes files into the (temporary) folder, then moves them to `target` as described above.
/// Returns the names of the files. Throws Failure(output) or Failure(interrupted), or what `write` throws otherwise.
std::vector<std::string> write_folder(const std::filesystem::path& target,
                                      const std::function<void(const std::filesystem::path& folder)>& write);

/// Calls write() with failures to write turned into Failure(output), and Ctrl-C into Failure(interrupted).
void write_guarded(const std::function<void()>& write);

}  // namespace alcap::app
