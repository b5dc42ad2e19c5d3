// SPDX-License-Identifier: MIT
//
// csv.cpp: tables as comma-separated text: a line of names, then one line per element that begins with its number.
#include "src/io/field/element_tables.h"
#include "src/io/field/rows.h"

namespace alcap::detail {
namespace {

void write_csv(AtomicFile& file, const Table& table) {
  const std::size_t columns = table.columns.size();
  std::string head(table.element);
  for (const std::string_view name : table.columns) (head += ',') += name;
  file.write(head + "\n");
  write_ranges(file, table.rows, (columns + 1) * (longest_number + 1),
               [&](std::int64_t begin, std::int64_t end, char* to) {
                 std::vector<double> numbers(columns);
                 for (std::int64_t i = begin; i < end; ++i) {
                   table.row(i, numbers.data());
                   to = put_text(to, i);
                   for (const double x : numbers) {
                     *to++ = ',';
                     to = put_text(to, x);
                   }
                   *to++ = '\n';
                 }
                 return to;
               });
}

}  // namespace

const TableFormat csv_table = {"csv", write_csv};
const OutputFormat csv_format = {"csv", true, write_elements<write_csv, true>, true};
const OutputFormat vertex_csv_format = {"vertex.csv", false, write_elements<write_csv, false>, true};

}  // namespace alcap::detail
