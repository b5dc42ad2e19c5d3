// SPDX-License-Identifier: MIT
//
// curves.cpp: polylines as VTK's PolyData, as lines of an OBJ, and as JSON.
#include <algorithm>
#include <array>

#include "alcap/output.h"
#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/io/field/polydata.h"

namespace alcap {
namespace {

using detail::append_text;
using detail::AtomicFile;
using detail::write_rows;

std::int64_t first(const CurveSet& curves, std::int64_t k) { return curves.offsets[detail::at(k)]; }

void write_vtp(AtomicFile& file, const CurveSet& curves, int n) {
  using namespace detail::polydata;
  const std::int64_t points = curves.points.rows(), count = curves.size();
  const auto reason = [&](std::string title, const std::vector<CurveEnd>& ends) {
    return array<std::int32_t, 1>(std::move(title), count, [&ends](std::int64_t k, std::int32_t* x) {
      x[0] = static_cast<std::int32_t>(ends[detail::at(k)]);
    });
  };
  const auto vectors = [&](std::string title, const Positions<double>& rows) {
    return array<double, 3>(std::move(title), points,
                            [&rows](std::int64_t i, double* x) { put_vector(x, rows.row(i)); });
  };
  const Section cells{"CellData", "", {reason("start", curves.start_reason), reason("end", curves.end_reason)}};
  const std::int64_t last = points == 0 ? 0 : *std::max_element(curves.faces.begin(), curves.faces.end());
  const Section data{"PointData",
                     "",
                     {whole_numbers("face", points, last, [&](std::int64_t i) { return curves.faces[detail::at(i)]; }),
                      vectors("barycentric", curves.barycentric)}};
  const Section places{"Points", "", {vectors("Points", curves.points)}};
  const Section lines{
      "Lines",
      "",
      {array<std::int64_t, 1>("connectivity", points, [](std::int64_t i, std::int64_t* x) { x[0] = i; }),
       array<std::int64_t, 1>("offsets", count,
                              [&](std::int64_t k, std::int64_t* x) { x[0] = first(curves, k + 1); })}};
  write_polydata(file, n,
                 "NumberOfPoints=\"" + std::to_string(points) + "\" NumberOfVerts=\"0\" NumberOfLines=\"" +
                     std::to_string(count) + "\" NumberOfStrips=\"0\" NumberOfPolys=\"0\"",
                 {data, cells, places, lines});
}

template <class Row>
void append_row(std::string& text, const Row& row, char separator) {
  for (int c = 0; c < 3; ++c) {
    if (c > 0) text += separator;
    append_text(text, static_cast<double>(row[c]));
  }
}

void write_obj(AtomicFile& file, const CurveSet& curves, int) {
  write_rows(file, curves.points.rows(), [&](std::int64_t i, std::string& text) {
    text += "v ";
    append_row(text, curves.points.row(i), ' ');
    text += '\n';
  });
  write_rows(file, curves.size(), [&](std::int64_t k, std::string& text) {
    if (first(curves, k + 1) - first(curves, k) < 2) return;  // a line has two ends
    text += 'l';
    for (std::int64_t i = first(curves, k); i < first(curves, k + 1); ++i) text += ' ', append_text(text, i + 1);
    text += '\n';
  });
}

void write_json(AtomicFile& file, const CurveSet& curves, int n) {
  file.write("{\n\"n\": " + std::to_string(n) + ",\n\"curves\": [\n");
  write_rows(file, curves.size(), [&](std::int64_t k, std::string& text) {
    const auto list = [&](const char* title, auto&& append_item) {
      text += std::string(", \"") + title + "\": [";
      for (std::int64_t i = first(curves, k); i < first(curves, k + 1); ++i) {
        if (i > first(curves, k)) text += ',';
        append_item(i);
      }
      text += ']';
    };
    const auto rows = [&](const Positions<double>& values) {
      return [&](std::int64_t i) {
        text += '[';
        append_row(text, values.row(i), ',');
        text += ']';
      };
    };
    text.append("{\"start\": \"").append(name(curves.start_reason[detail::at(k)]));
    text.append("\", \"end\": \"").append(name(curves.end_reason[detail::at(k)])).append("\"");
    list("points", rows(curves.points));
    list("faces", [&](std::int64_t i) { append_text(text, curves.faces[detail::at(i)]); });
    list("barycentric", rows(curves.barycentric));
    text += k + 1 < curves.size() ? "},\n" : "}\n";
  });
  file.write("]\n}\n");
}

struct CurveFormat {
  const char* extension;
  void (*write)(AtomicFile& file, const CurveSet& curves, int n);
};
// One line registers a format.
constexpr std::array formats{
    CurveFormat{"vtp", write_vtp},
    CurveFormat{"obj", write_obj},
    CurveFormat{"json", write_json},
};

}  // namespace

std::vector<std::string> curve_formats() {
  std::vector<std::string> out;
  for (const CurveFormat& f : formats) out.emplace_back(f.extension);
  return out;
}

void write_curves(const CurveSet& curves, int n, const std::filesystem::path& file, const RunControl& control) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  std::string known;
  for (const CurveFormat& f : formats) {
    const std::string own = std::string(".") + f.extension;
    known += (known.empty() ? "" : ", ") + own;
    if (extension != own) continue;
    controlled(control, [&] {
      detail::report_phase("write");
      AtomicFile out(file);
      f.write(out, curves, n);
      out.commit();
    });
    return;
  }
  throw FileError(file.string() + ": the extension names no format for curves; use one of " + known, file.string());
}

}  // namespace alcap
