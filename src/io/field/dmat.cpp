// SPDX-License-Identifier: MIT
//
// dmat.cpp: tables as libigl's matrices, binary: a line "0 0", a line with the numbers of columns and rows, then the
// numbers column by column, as igl::readDMAT and gptoolbox read them.
#include "src/io/field/element_tables.h"
#include "src/io/field/rows.h"

namespace alcap::detail {
namespace {

void write_dmat(AtomicFile& file, const Table& table) {
  const auto columns = static_cast<std::int64_t>(table.columns.size());
  file.write("0 0\n" + std::to_string(columns) + " " + std::to_string(table.rows) + "\n");
  for (std::int64_t c = 0; c < columns; ++c) {
    write_ranges(file, table.rows, sizeof(double), [&](std::int64_t begin, std::int64_t end, char* to) {
      std::vector<double> numbers(at(columns));
      for (std::int64_t i = begin; i < end; ++i) {
        table.row(i, numbers.data());
        to = put_binary(to, numbers[at(c)]);
      }
      return to;
    });
  }
}

}  // namespace

const TableFormat dmat_table = {"dmat", write_dmat};
const OutputFormat dmat_format = {"dmat", true, write_elements<write_dmat, true>, true};
const OutputFormat vertex_dmat_format = {"vertex.dmat", false, write_elements<write_dmat, false>, true};

}  // namespace alcap::detail
