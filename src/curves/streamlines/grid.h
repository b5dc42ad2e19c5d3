// SPDX-License-Identifier: MIT
//
// grid.h: points of curves by place, to find those near a point. Internal to streamlines.
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>
#include <vector>

#include "alcap/conventions.h"
#include "src/base/array.h"
#include "src/base/numbers.h"

namespace alcap::detail {

/// A point of a curve in space. Directions and normals have length 1 (or 0: unknown).
struct CurveSample {
  Eigen::RowVector3d x, direction, normal;
  double arc = 0;
  std::int64_t curve = -1;  ///< number of a curve that is taken over from an earlier set; -1: another one
};

/// A hashed grid of cubes. Queries are const, fit for several threads, and counted by what they look at.
class SampleGrid {
 public:
  explicit SampleGrid(double cell) : cell_(cell), table_(64) {}

  void insert(const CurveSample& sample) {
    if (2 * samples_.size() >= table_.size()) grow();
    samples_.push_back(sample);
    places_.push_back({{sample.x[0], sample.x[1], sample.x[2]}, -1});
    link(samples_.size() - 1);
  }
  void clear() {
    samples_.clear();
    places_.clear();
    table_.assign(64, Slot{});
  }

  /// Whether hit(sample) holds for one of the samples closer than `radius` to x.
  template <class Hit>
  [[nodiscard]] bool any_near(const Eigen::RowVector3d& x, double radius, Hit&& hit) const {
    std::int64_t low[3], high[3];
    for (int c = 0; c < 3; ++c) {
      low[c] = cell_of(x[c] - radius);
      high[c] = cell_of(x[c] + radius);
    }
    std::int64_t looks = 0;
    const auto search = [&] {
      for (std::int64_t i = low[0]; i <= high[0]; ++i)
        for (std::int64_t j = low[1]; j <= high[1]; ++j)
          for (std::int64_t k = low[2]; k <= high[2]; ++k)
            for (std::int64_t s = slot(key(i, j, k)).head; s >= 0; s = places_[at(s)].next) {
              const Place& place = places_[at(s)];
              const double dx = place.x[0] - x[0], dy = place.x[1] - x[1], dz = place.x[2] - x[2];
              ++looks;
              if (dx * dx + dy * dy + dz * dz < radius * radius && hit(samples_[at(s)])) return true;
            }
      return false;
    };
    const bool found = search();
    looks_.fetch_add(looks, std::memory_order_relaxed);
    return found;
  }
  /// How many samples all queries so far have looked at. The same for any number of threads once they are done.
  [[nodiscard]] std::int64_t looks() const { return looks_.load(std::memory_order_relaxed); }

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::int64_t head = -1;  // of the list of the cell's samples; none: a free slot
  };

  /// What every query reads, close together.
  struct Place {
    double x[3];
    std::int64_t next;  // in the list of its cell
  };

  // Places beyond the range share a cell.
  [[nodiscard]] std::int64_t cell_of(double x) const {
    constexpr std::int64_t most = std::int64_t{1} << 52;
    return to_integer(std::floor(x / cell_), -most, most);
  }
  // 21 bits for each coordinate; cells that share a key are only a little slower.
  [[nodiscard]] static std::uint64_t key(std::int64_t i, std::int64_t j, std::int64_t k) {
    constexpr std::uint64_t mask = (1U << 21) - 1;
    return (static_cast<std::uint64_t>(i) & mask) << 42 | (static_cast<std::uint64_t>(j) & mask) << 21 |
           (static_cast<std::uint64_t>(k) & mask);
  }
  [[nodiscard]] const Slot& slot(std::uint64_t key) const { return table_[position(key)]; }
  [[nodiscard]] std::size_t position(std::uint64_t key) const {
    const std::size_t mask = table_.size() - 1;
    std::size_t p = at((key * 0x9E3779B97F4A7C15ULL) >> 20) & mask;
    while (table_[p].head >= 0 && table_[p].key != key) p = (p + 1) & mask;
    return p;
  }
  void link(std::size_t sample) {
    const Eigen::RowVector3d& x = samples_[sample].x;
    const std::uint64_t here = key(cell_of(x[0]), cell_of(x[1]), cell_of(x[2]));
    Slot& s = table_[position(here)];
    places_[sample].next = s.head;
    s = {here, static_cast<std::int64_t>(sample)};
  }
  void grow() {
    table_.assign(2 * table_.size(), Slot{});
    for (std::size_t k = 0; k < samples_.size(); ++k) link(k);
  }

  double cell_;
  std::vector<CurveSample> samples_;
  std::vector<Place> places_;
  std::vector<Slot> table_;  // a power of two, at most half full
  mutable std::atomic<std::int64_t> looks_{0};
};

}  // namespace alcap::detail
