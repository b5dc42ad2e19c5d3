// SPDX-License-Identifier: MIT
//
// rows.h: tables of numbers, as text or little-endian binary, formatted in parallel and written in order.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "src/base/array.h"
#include "src/base/atomic_file.h"
#include "src/base/bytes.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"

namespace alcap::detail {

/// Writes the bytes of a number, least significant first; returns their end.
template <class Number>
char* put_binary(char* to, Number value) {
  const auto raw = little_endian(value);
  std::memcpy(to, raw.data(), raw.size());
  return to + raw.size();
}

/// Appends the rows [0, rows) to the file: rows_to(begin, end, to) writes rows at `to`, at most `most` bytes each, and
/// returns the end of what it wrote, or nothing if that is always `most`. Called on several threads.
template <class Rows>
void write_ranges(AtomicFile& file, std::int64_t rows, std::size_t most, Rows&& rows_to) {
  constexpr std::size_t chunk_bytes = std::size_t{1} << 17;  // of one task: it outweighs its start and fits a cache
  constexpr std::int64_t batch = 16;                         // chunks held in memory
  const std::int64_t chunk = std::max<std::int64_t>(1, static_cast<std::int64_t>(chunk_bytes / most));
  const std::size_t room = at(chunk) * most;
  const std::int64_t all = (rows + chunk - 1) / chunk;
  Array<char> bytes(std::min(all, batch) * static_cast<std::int64_t>(room));
  const auto start = [&](std::int64_t c) { return bytes.data() + at(c) * room; };
  std::array<char*, batch> stop = {};
  for (std::int64_t first = 0; first < all; first += batch) {
    const std::int64_t chunks = std::min(batch, all - first);
    parallel_for(
        chunks,
        [&](std::int64_t c) {
          const std::int64_t begin = (first + c) * chunk, end = std::min(rows, begin + chunk);
          char*& to = stop[at(c)];
          if constexpr (std::is_void_v<decltype(rows_to(begin, end, start(c)))>) {
            rows_to(begin, end, start(c));
            to = start(c) + at(end - begin) * most;
          } else {
            to = rows_to(begin, end, start(c));
          }
        },
        1);
    for (std::int64_t c = 0; c < chunks; ++c) file.write({start(c), stop[at(c)]});
  }
}

/// The same row by row: row(i, to) writes row i and returns its end.
template <class Row>
void write_table(AtomicFile& file, std::int64_t rows, std::size_t most, Row&& row) {
  write_ranges(file, rows, most, [&](std::int64_t begin, std::int64_t end, char* to) {
    for (std::int64_t i = begin; i < end; ++i) to = row(i, to);
    return to;
  });
}

/// The same for rows of any length: row(i, bytes) appends row i to `bytes`.
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
          std::string& out = bytes[at(c)];
          out.clear();
          const std::int64_t begin = first + c * chunk;
          for (std::int64_t i = begin; i < std::min(rows, begin + chunk); ++i) row(i, out);
        },
        1);
    for (std::int64_t c = 0; c < chunks; ++c) file.write(bytes[at(c)]);
  }
}

}  // namespace alcap::detail
