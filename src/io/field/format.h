// SPDX-License-Identifier: MIT
//
// format.h: what an output format has to offer. One file per format defines one of these; registry.cpp lists them.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "alcap/output.h"
#include "src/base/atomic_file.h"

namespace alcap::detail {

/// What is written, checked, with what several formats need of it. Formats run side by side.
class FieldJob {
 public:
  /// With `with_faces`, at_faces() may be called.
  FieldJob(const FieldOutput& output, bool with_faces);

  const FieldOutput& out;

  /// The field at the barycenters in face frames.
  [[nodiscard]] const Field& at_faces() const { return at_faces_; }

 private:
  Field at_faces_;
};

/// Whether `name` is something, a dot and the extension; case does not matter.
[[nodiscard]] bool has_extension(std::string_view name, std::string_view extension);

/// Files with all of their bytes that do not have their names yet.
using WrittenFiles = std::vector<std::unique_ptr<AtomicFile>>;
[[nodiscard]] WrittenFiles open_files(const std::vector<std::filesystem::path>& paths);

/// Where a format writes: `file` as given, `stem` without the extension, for files beside it.
struct Target {
  std::filesystem::path file;
  std::filesystem::path stem;

  /// The stem with something appended to the last part of its name.
  [[nodiscard]] std::filesystem::path beside(std::string_view suffix) const {
    std::filesystem::path path = stem;
    return path += suffix;
  }
};

struct OutputFormat {
  std::string_view extension;  ///< without the leading dot; where one ends with another, the longer comes first
  bool uses_faces;             ///< whether write() calls job.at_faces()
  WrittenFiles (*write)(const FieldJob& job, const Target& target);
  bool only_on_request = false;  ///< not one of usual_field_formats()
};

extern const OutputFormat vertex_rawfield_format;
extern const OutputFormat rawfield_format;
extern const OutputFormat rosy_format;
extern const OutputFormat ply_field_format;
extern const OutputFormat vtp_format;
extern const OutputFormat csv_format;
extern const OutputFormat vertex_csv_format;
extern const OutputFormat npy_format;
extern const OutputFormat vertex_npy_format;
extern const OutputFormat dmat_format;
extern const OutputFormat vertex_dmat_format;

}  // namespace alcap::detail
