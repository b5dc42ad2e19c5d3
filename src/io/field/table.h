// SPDX-License-Identifier: MIT
//
// table.h: tables of numbers, one row per vertex or face, and the formats that hold them. A format is a file that
// defines a TableFormat, which scalars.cpp lists, and OutputFormats for the frames of elements (element_tables.h).
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "src/base/atomic_file.h"

namespace alcap::detail {

/// What is written: `row(i, to)` writes row i, one number per column; it is called on several threads.
struct Table {
  std::string_view element;               ///< what a row belongs to: "vertex" or "face"
  std::int64_t rows;                      ///< how many
  std::vector<std::string_view> columns;  ///< their names
  std::function<void(std::int64_t i, double* to)> row;
};

struct TableFormat {
  std::string_view extension;  ///< without the leading dot
  void (*write)(AtomicFile& file, const Table& table);
};

extern const TableFormat csv_table;
extern const TableFormat npy_table;
extern const TableFormat dmat_table;
extern const TableFormat sol_table;

}  // namespace alcap::detail
