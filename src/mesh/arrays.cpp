// SPDX-License-Identifier: MIT
#include "alcap/arrays.h"

#include <limits>

#include "src/base/limits.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"

namespace alcap::detail {

void refuse_columns(const char* name, std::int64_t columns) {
  throw OptionError(name, std::to_string(columns) + " columns", "needs three, one point or triangle a row");
}

void refuse_count(const char* name, std::int64_t numbers) {
  throw OptionError(name, std::to_string(numbers) + " numbers", "needs three per row");
}

template <class T>
Positions<double> copy_positions(const ThreeColumns<T>& V) {
  Positions<double> out(V.rows, 3);
  parallel_for(V.rows, [&](std::int64_t i) {
    for (Eigen::Index k = 0; k < 3; ++k) out(i, k) = double(V.data[i * V.row_stride + k * V.column_stride]);
  });
  return out;
}

template Positions<double> copy_positions(const ThreeColumns<float>&);
template Positions<double> copy_positions(const ThreeColumns<double>&);

namespace {

template <class T>
bool fits(T index) {
  if constexpr (std::is_signed_v<T>) {
    return index >= 0 && index <= std::int64_t{std::numeric_limits<Index>::max()};
  } else {
    return index <= static_cast<T>(std::numeric_limits<Index>::max());
  }
}

// Names the first faces whose indices do not fit.
template <class T>
[[noreturn]] void refuse_indices(const ThreeColumns<T>& F) {
  constexpr std::size_t most_named = 8;
  std::vector<Index> first;
  std::int64_t count = 0;
  std::string example;
  for (std::int64_t t = 0; t < F.rows; ++t) {
    const T* const row = F.data + t * F.row_stride;
    for (std::int64_t k = 0; k < 3; ++k) {
      if (fits(row[k * F.column_stride])) continue;
      if (count++ == 0)
        example = "face " + std::to_string(t) + " has the index " + std::to_string(row[k * F.column_stride]);
      if (first.size() < most_named) first.push_back(static_cast<Index>(t));
      break;
    }
  }
  throw MeshError(counted(count, "face has", "faces have") + " an index that is negative or not below 2^" +
                      std::to_string(index_digits) + ": " + example,
                  Defect::index_out_of_range, Element::face, count, std::move(first));
}

}  // namespace

template <class T>
Faces copy_faces(const ThreeColumns<T>& F) {
  if (F.rows > detail::most_faces)
    throw OptionError("F", std::to_string(F.rows) + " rows",
                      "must be below 2^" + std::to_string(index_digits) + " / 3: halfedges have " +
                          std::to_string(index_digits + 1) + "-bit numbers");
  Faces out(F.rows, 3);
  const bool good = parallel_reduce(
      F.rows, true,
      [&](std::int64_t begin, std::int64_t end) {
        bool all = true;
        for (std::int64_t t = begin; t < end; ++t) {
          for (Eigen::Index k = 0; k < 3; ++k) {
            const T index = F.data[t * F.row_stride + k * F.column_stride];
            all &= fits(index);
            out(t, k) = static_cast<Index>(index);
          }
        }
        return all;
      },
      [](bool a, bool b) { return a && b; });
  if (!good) refuse_indices(F);
  return out;
}

template Faces copy_faces(const ThreeColumns<std::int32_t>&);
template Faces copy_faces(const ThreeColumns<std::uint32_t>&);
template Faces copy_faces(const ThreeColumns<std::int64_t>&);
template Faces copy_faces(const ThreeColumns<std::uint64_t>&);

}  // namespace alcap::detail
