// SPDX-License-Identifier: MIT
//
// registry.cpp: the table of mesh formats, and the choice of one by name, content or extension. A new format is one
// file that defines a Format, and one line here.
#include <array>

#include "alcap/mesh_io.h"
#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/base/input_file.h"
#include "src/base/numbers.h"
#include "src/io/mesh/format.h"

namespace alcap {
namespace detail {
namespace {

// In the order in which they are asked to recognise a content.
const std::array<const Format*, 4> formats = {
    &ply_format,
    &off_format,
    &stl_format,
    &obj_format,
};

// How files start that are often taken for meshes we read.
struct Stranger {
  std::string_view start;
  const char* what;
};
constexpr std::array<Stranger, 12> strangers = {{
    {"\x1F\x8B", "compressed with gzip; unpack it"},
    {"PK\x03\x04", "a zip archive (or 3MF); unpack it or save it as PLY"},
    {"glTF", "a binary glTF; save it as PLY"},
    {"Kaydara", "an FBX file; save it as PLY"},
    {"# vtk DataFile", "a legacy VTK file; save it as PLY"},
    {"<", "XML or HTML (VTP, X3D, Collada, a web page); save it as PLY"},
    {"{", "JSON (perhaps glTF); save it as PLY"},
    {"$MeshFormat", "a Gmsh mesh; save it as STL or PLY"},
    {"MeshVersionFormatted", "an INRIA Medit mesh; save it as PLY"},
    {"version https://git-lfs", "a Git LFS pointer; fetch the file itself with 'git lfs pull'"},
    {"\xFF\xFE", "text in UTF-16; save it as UTF-8"},
    {"\xFE\xFF", "text in UTF-16; save it as UTF-8"},
}};

const Format* by_name(std::string_view name) {
  for (const Format* format : formats) {
    if (equal_ignoring_case(format->name, name)) return format;
  }
  return nullptr;
}

std::string all_names() {
  std::string all;
  for (const Format* format : formats) all += (all.empty() ? "" : ", ") + std::string(format->name);
  return all;
}

std::string extension(const std::filesystem::path& path) {
  const std::string dotted = path.extension().string();
  return dotted.empty() ? dotted : dotted.substr(1);
}

const Format& choose(const Source& source, const ReadOptions& options, const std::string& extension) {
  if (!options.format.empty()) {
    if (const Format* format = by_name(options.format)) return *format;
    throw OptionError("format", "'" + options.format + "'", "must be empty or one of " + all_names());
  }
  for (const Format* format : formats) {
    if (format->recognise(source.bytes)) return *format;
  }
  for (const Stranger& stranger : strangers) {
    if (source.bytes.starts_with(stranger.start)) fail(source, std::string("this is ") + stranger.what);
  }
  if (const Format* format = by_name(extension)) return *format;
  fail(source, "neither the content nor the extension is that of a known mesh format (" + all_names() + ")");
}

MeshFile read(const Source& source, const ReadOptions& options, const std::string& extension) {
  if (source.bytes.empty()) fail(source, "the file is empty");
  return choose(source, options, extension).read(source, options);
}

void check(const Positions<double>& V, const Faces& F) {
  if (V.rows() == 0 || F.rows() == 0) {
    const Element what = V.rows() == 0 ? Element::vertex : Element::face;
    throw MeshError("a mesh without vertices or faces is not written: readers refuse it", Defect::empty, what, 0, {});
  }
  for (Eigen::Index t = 0; t < F.rows(); ++t) {
    check_cancelled_at(t);
    if (F.row(t).minCoeff() < 0 || F.row(t).maxCoeff() >= V.rows()) {
      throw MeshError(
          "not written: face " + std::to_string(t) + " names a vertex outside 0 ... " + std::to_string(V.rows() - 1),
          Defect::index_out_of_range, Element::face, 1, {static_cast<Index>(t)});
    }
  }
  for (Eigen::Index v = 0; v < V.rows(); ++v) {
    check_cancelled_at(v);
    if (!V.row(v).allFinite()) {
      throw MeshError("not written: vertex " + std::to_string(v) + " is not finite", Defect::not_finite,
                      Element::vertex, 1, {static_cast<Index>(v)});
    }
  }
}

template <class Number>
void write_text(AtomicFile& file, Number value) {
  std::array<char, longest_number> text;
  const char* const end = put_text(text.data(), value);
  file.write({text.data(), at(end - text.data())});
}

}  // namespace

void write_number(AtomicFile& file, double value) { write_text(file, value); }
void write_number(AtomicFile& file, std::int64_t value) { write_text(file, value); }

}  // namespace detail

MeshFile read_mesh(const std::filesystem::path& path, const ReadOptions& options) {
  return controlled(options.control, [&] {
    detail::report_phase("read");
    const detail::InputFile file(path, {.what = "mesh file"});
    return detail::read({path.string(), file.bytes()}, options, detail::extension(path));
  });
}

MeshFile read_mesh_from_memory(std::string_view bytes, std::string_view format, const ReadOptions& options) {
  ReadOptions named = options;
  if (!format.empty()) named.format = format;
  return controlled(options.control, [&] {
    detail::report_phase("read");
    return detail::read({"<memory>", bytes}, named, "");
  });
}

void write_mesh(const std::filesystem::path& path, const Positions<double>& V, const Faces& F,
                const RunControl& control) {
  const detail::Format* format = detail::by_name(detail::extension(path));
  if (format == nullptr || format->write == nullptr) {
    throw FileError(path.string() + ": the extension must be .off, .obj or .ply to write a mesh", path.string());
  }
  controlled(control, [&] {
    detail::report_phase("write");
    detail::check(V, F);
    detail::AtomicFile file(path);
    format->write(file, V, F);
    file.commit();
  });
}

std::vector<std::string> mesh_formats() {
  std::vector<std::string> names;
  for (const detail::Format* format : detail::formats) names.emplace_back(format->name);
  return names;
}

}  // namespace alcap
