// SPDX-License-Identifier: MIT
//
// registry.cpp: the list of output formats, the choice by extension, and the checks that all of them share.
#include <algorithm>
#include <cmath>
#include <exception>
#include <set>

#include "alcap/output.h"
#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/base/parallel.h"
#include "src/io/field/format.h"

namespace alcap {
namespace detail {
namespace {

// One line registers a format. Where one extension ends with another, the longer comes first.
const OutputFormat* const formats[] = {
    &vertex_rawfield_format,  //
    &rawfield_format,         //
    &rosy_format,             //
    &ply_field_format,        //
    &vtp_format,              //
    &vertex_csv_format,       //
    &csv_format,              //
    &vertex_npy_format,       //
    &npy_format,              //
    &vertex_dmat_format,      //
    &dmat_format,
};

bool same_letter(char a, char b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return lower(a) == lower(b);
}

const OutputFormat* find_format(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  const auto found = std::find_if(std::begin(formats), std::end(formats),
                                  [&](const OutputFormat* f) { return has_extension(name, f->extension); });
  return found == std::end(formats) ? nullptr : *found;
}

const OutputFormat& choose_format(const std::filesystem::path& file) {
  if (const OutputFormat* format = find_format(file)) return *format;
  std::string known;
  for (const OutputFormat* f : formats) known += (known.empty() ? "." : ", .") + std::string(f->extension);
  throw FileError(file.string() + ": the extension names no format for fields; use one of " + known, file.string());
}

void check_size(const char* what, std::int64_t size, std::int64_t expected) {
  if (size != expected) {
    throw OptionError(what, std::to_string(size) + " rows", "must have " + std::to_string(expected) + " for this mesh");
  }
}

void check_finite(const FieldOutput& out) {
  const auto finite = [&](Index v) {
    return std::isfinite(out.field.u[v].real()) && std::isfinite(out.field.u[v].imag()) &&
           out.surface.V().row(v).allFinite();
  };
  const Index first = parallel_reduce(
      std::int64_t{out.surface.mesh().vertices()}, none,
      [&](std::int64_t begin, std::int64_t end) {
        for (auto v = static_cast<Index>(begin); v < end; ++v)
          if (!finite(v)) return v;
        return none;
      },
      [](Index a, Index b) { return a == none ? b : a; });
  if (first == none) return;
  const std::string vertex = "vertex " + std::to_string(first) + " must have a finite ";
  if (out.surface.V().row(first).allFinite()) throw OptionError("field.u", "not finite", vertex + "value");
  throw OptionError("V", "not finite", vertex + "position");
}

void check(const FieldOutput& out) {
  const Index vertices = out.surface.mesh().vertices(), faces = out.surface.mesh().faces();
  if (out.field.n < 1) throw OptionError("field.n", out.field.n, "must be at least 1");
  (void)out.surface.positions();  // throws where there are none
  check_size("field.u", out.field.u.size(), vertices);
  if (!out.field.frames) throw OptionError("field.frames", "none", "vectors in space need frames: see vertex_frames()");
  check_size("field.frames.X", out.field.frames->X.rows(), vertices);
  check_size("field.frames.N", out.field.frames->N.rows(), vertices);
  check_finite(out);
  for (const Singularity& s : out.singularities) {
    if (s.face < 0 || s.face >= faces) {
      throw OptionError("singularities", "face " + std::to_string(s.face), "must be a face of this mesh");
    }
  }
  std::set<std::string_view> names = {"K", "index", "index_rgb"};
  for (const FaceScalars& s : out.face_scalars) {
    if (s.name.empty() || !names.insert(s.name).second) {
      throw OptionError("face_scalars", "\"" + s.name + "\"",
                        "names must be distinct, not empty, and neither K nor index");
    }
    check_size(s.name.c_str(), static_cast<std::int64_t>(s.values.size()), faces);
  }
}

}  // namespace

bool has_extension(std::string_view name, std::string_view extension) {
  if (name.size() < extension.size() + 2) return false;
  const std::string_view end = name.substr(name.size() - extension.size());
  return name[name.size() - extension.size() - 1] == '.' &&
         std::equal(end.begin(), end.end(), extension.begin(), same_letter);
}

FieldJob::FieldJob(const FieldOutput& output, bool with_faces) : out(output) {
  if (!with_faces) return;
  at_faces_ = alcap::at_faces(out.surface, out.field);
  if (!out.unit) return;
  at_faces_ = normalised(std::move(at_faces_));
  for (Index t = 0; t < out.surface.mesh().faces(); ++t)
    if (at_faces_.u[t] == Complex<double>(0)) at_faces_.u[t] = 1;
}

WrittenFiles open_files(const std::vector<std::filesystem::path>& paths) {
  WrittenFiles files;
  for (const auto& path : paths) files.push_back(std::make_unique<AtomicFile>(path));
  return files;
}

}  // namespace detail

namespace {

// Files are written side by side: while the system takes the bytes of one, another one's numbers are formatted. The
// error of the first file in order counts, whichever came first.
std::vector<detail::WrittenFiles> write_side_by_side(const detail::FieldJob& job,
                                                     std::span<const std::filesystem::path> files) {
  std::vector<detail::WrittenFiles> written(files.size());
  std::vector<std::exception_ptr> errors(files.size());
  parallel_for(
      static_cast<std::int64_t>(files.size()),
      [&](std::int64_t i) {
        const std::size_t k = detail::at(i);
        try {
          const detail::OutputFormat& format = detail::choose_format(files[k]);
          const std::string name = files[k].filename().string();
          const std::string stem = name.substr(0, name.size() - format.extension.size() - 1);
          written[k] = format.write(job, {files[k], files[k].parent_path() / stem});
          for (const auto& file : written[k]) file->complete();
        } catch (...) {
          errors[k] = std::current_exception();
        }
      },
      1);
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
  return written;
}

}  // namespace

std::vector<std::filesystem::path> write_field(const FieldOutput& output, std::span<const std::filesystem::path> files,
                                               const RunControl& control) {
  bool with_faces = false;
  for (const auto& file : files)
    with_faces |= detail::choose_format(file).uses_faces;  // throws before anything is done
  return controlled(control, [&] {
    detail::report_phase("write");
    detail::check(output);
    const detail::FieldJob job(output, with_faces);
    const std::vector<detail::WrittenFiles> written = write_side_by_side(job, files);
    std::vector<std::filesystem::path> paths;
    for (const detail::WrittenFiles& group : written)
      for (const auto& file : group) {
        file->commit();
        paths.push_back(file->target());
      }
    return paths;
  });
}

std::vector<std::filesystem::path> write_field(const FieldOutput& output, const std::filesystem::path& file,
                                               const RunControl& control) {
  return write_field(output, std::span(&file, 1), control);
}

std::vector<std::string> field_formats() {
  std::vector<std::string> names;
  for (const detail::OutputFormat* f : detail::formats) names.emplace_back(f->extension);
  return names;
}

std::vector<std::string> usual_field_formats() {
  std::vector<std::string> names;
  for (const detail::OutputFormat* f : detail::formats)
    if (!f->only_on_request) names.emplace_back(f->extension);
  return names;
}

std::string field_format(const std::filesystem::path& file) {
  const detail::OutputFormat* format = detail::find_format(file);
  return format ? std::string(format->extension) : std::string();
}

}  // namespace alcap
