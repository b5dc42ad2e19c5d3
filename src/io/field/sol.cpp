// SPDX-License-Identifier: MIT
//
// sol.cpp: one number per vertex as a solution file of Medit, text: what mmgs and mmg3d take as a size map.
#include "src/io/field/rows.h"
#include "src/io/field/table.h"

namespace alcap::detail {
namespace {

/// Of one column per vertex: write_scalars() has no other.
void write_sol(AtomicFile& file, const Table& table) {
  file.write("MeshVersionFormatted 2\n\nDimension 3\n\nSolAtVertices\n" + std::to_string(table.rows) + "\n1 1\n\n");
  write_table(file, table.rows, longest_number + 1, [&](std::int64_t i, char* to) {
    double x = 0;
    table.row(i, &x);
    to = put_text(to, x);
    *to++ = '\n';
    return to;
  });
  file.write("\nEnd\n");
}

}  // namespace

const TableFormat sol_table = {"sol", write_sol};

}  // namespace alcap::detail
