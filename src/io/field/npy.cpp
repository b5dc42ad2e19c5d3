// SPDX-License-Identifier: MIT
//
// npy.cpp: tables as NumPy arrays of float64, one row per element; a table of one column is an array of one dimension.
#include "src/base/npy.h"
#include "src/io/field/element_tables.h"
#include "src/io/field/rows.h"

namespace alcap::detail {
namespace {

void write_npy(AtomicFile& file, const Table& table) {
  const std::size_t columns = table.columns.size();
  file.write(
      npy_head("<f8", "(" + std::to_string(table.rows) + (columns == 1 ? ",)" : ", " + std::to_string(columns) + ")")));
  write_ranges(file, table.rows, columns * sizeof(double), [&](std::int64_t begin, std::int64_t end, char* to) {
    std::vector<double> numbers(columns);
    for (std::int64_t i = begin; i < end; ++i) {
      table.row(i, numbers.data());
      for (const double x : numbers) to = put_binary(to, x);
    }
    return to;
  });
}

}  // namespace

const TableFormat npy_table = {"npy", write_npy};
const OutputFormat npy_format = {"npy", true, write_elements<write_npy, true>, true};
const OutputFormat vertex_npy_format = {"vertex.npy", false, write_elements<write_npy, false>, true};

}  // namespace alcap::detail
