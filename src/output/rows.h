// SPDX-License-Identifier: MIT
//
// rows.h: tables of numbers, as text or little-endian binary, formatted in parallel and written in order.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <string>
#include <vector>

#include "alcap/detail/atomic_file.h"
#include "alcap/field.h"
#include "alcap/parallel.h"
#include "io/bytes.h"

namespace alcap::detail {

/// Appends the shortest decimal number that reads back as the same value.
template <class Number>
void append_text(std::string& text, Number value) {
  std::array<char, 32> digits;  // the longest double takes 24
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  text.append(digits.data(), end);
}

/// Appends the bytes of a number, least significant first.
template <class Number>
void append_binary(std::string& bytes, Number value) {
  const auto raw = little_endian(value);
  bytes.append(raw.data(), raw.size());
}

/// Appends the rows [0, rows) to the file: row(i, bytes) appends row i to `bytes` and runs on several threads.
template <class Row>
void write_rows(AtomicFile& file, std::int64_t rows, Row&& row) {
  constexpr std::int64_t chunk = 1024;  // rows formatted by one task: a task outweighs its start
  constexpr std::int64_t batch = 32;    // chunks held in memory: a few MB
  std::vector<std::string> bytes(batch);
  for (std::int64_t first = 0; first < rows; first += chunk * batch) {
    const std::int64_t chunks = std::min(batch, (rows - first + chunk - 1) / chunk);
    parallel_for(
        chunks,
        [&](std::int64_t c) {
          std::string& out = bytes[static_cast<std::size_t>(c)];
          out.clear();
          const std::int64_t begin = first + c * chunk;
          for (std::int64_t i = begin; i < std::min(rows, begin + chunk); ++i) row(i, out);
        },
        1);
    for (std::int64_t c = 0; c < chunks; ++c) file.write(bytes[static_cast<std::size_t>(c)]);
  }
}

/// Branch k of element i as a vector in space; exactly +0 where the field is zero.
[[nodiscard]] inline Eigen::RowVector3d branch_vector(const Field<double>& field, Index i, int k) {
  if (field.u[i] == 0.0) return Eigen::RowVector3d::Zero();
  return field.frames->vector(i, field.branch(i, k));
}

}  // namespace alcap::detail
