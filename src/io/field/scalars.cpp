// SPDX-License-Identifier: MIT
//
// scalars.cpp: numbers of vertices as tables of one column.
#include <algorithm>
#include <cmath>

#include "alcap/output.h"
#include "src/base/cancel.h"
#include "src/io/field/format.h"
#include "src/io/field/table.h"

namespace alcap {
namespace {

// One line registers a format.
const detail::TableFormat* const scalar_tables[] = {
    &detail::sol_table,  //
    &detail::csv_table,  //
    &detail::npy_table,  //
    &detail::dmat_table,
};

const detail::TableFormat& table_format(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  std::string known;
  for (const detail::TableFormat* format : scalar_tables) {
    if (detail::has_extension(name, format->extension)) return *format;
    known += (known.empty() ? "." : ", .") + std::string(format->extension);
  }
  throw FileError(file.string() + ": the extension names no format for numbers of vertices; use one of " + known,
                  file.string());
}

}  // namespace

void write_scalars(const VectorX<double>& values, const std::string& name, const std::filesystem::path& file,
                   const RunControl& control) {
  const detail::TableFormat& format = table_format(file);
  for (Eigen::Index v = 0; v < values.size(); ++v)
    if (!std::isfinite(values[v]))
      throw OptionError(name, values[v], "vertex " + std::to_string(v) + " must have a finite number");
  controlled(control, [&] {
    detail::report_phase("write");
    detail::AtomicFile out(file);
    format.write(out, {"vertex", values.size(), {name}, [&](std::int64_t i, double* to) { *to = values[i]; }});
    out.commit();
  });
}

std::vector<std::string> scalar_formats() {
  std::vector<std::string> names;
  for (const detail::TableFormat* format : scalar_tables) names.emplace_back(format->extension);
  return names;
}

}  // namespace alcap
