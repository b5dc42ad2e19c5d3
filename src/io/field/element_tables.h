// SPDX-License-Identifier: MIT
//
// element_tables.h: the direction and the orthonormal frame of every face or vertex as a table: what finite-element
// codes take as orientations of elements.
#pragma once

#include "src/io/field/format.h"
#include "src/io/field/table.h"

namespace alcap::detail {

/// Refers to the job.
[[nodiscard]] Table element_table(const FieldJob& job, bool faces);

/// The writer of an OutputFormat, made of that of a TableFormat.
template <void (*write)(AtomicFile& file, const Table& table), bool faces>
WrittenFiles write_elements(const FieldJob& job, const Target& target) {
  WrittenFiles files = open_files({target.file});
  write(*files[0], element_table(job, faces));
  return files;
}

}  // namespace alcap::detail
