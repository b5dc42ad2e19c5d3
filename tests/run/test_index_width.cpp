// SPDX-License-Identifier: MIT
//
// Numbers up to the last one that Index holds: half-edges, offsets, entries of real views, products of matrices and the
// relaxation of the connection, and what of them files can say. No memory is needed for what is large: addresses are
// reserved, and only the pages around the numbers in question are ever touched. The same holds with 32 bits, up to
// 2^31, and with 64, beyond 2^32.
#include <doctest/doctest.h>
#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "alcap/arrays.h"
#include "alcap/assembly.h"
#include "alcap/matrix_file.h"
#include "alcap/mesh.h"
#include "alcap/plan.h"
#include "solvers/multigrid/row.h"
#include "src/base/index_pair.h"
#include "src/base/limits.h"
#include "src/base/narrow.h"
#include "src/base/parallel.h"
#include "src/energy/real_places.h"
#include "src/io/field/polydata.h"
#include "src/simd/block_kernels.h"
#include "tests/support/folder.h"

using namespace alcap;

namespace {

constexpr bool wide = sizeof(Index) == 8;
constexpr std::int64_t largest = std::numeric_limits<Index>::max();
/// A row that the products below can have, and one of the exchange, which has a bit more.
constexpr std::int64_t far = wide ? (std::int64_t{1} << 32) + 12345 : largest - 16;
constexpr std::int64_t far_of_exchange = wide ? (std::int64_t{1} << 33) + 12345 : (std::int64_t{1} << 32) - 400;

/// Zeros at addresses for `size` numbers, without memory until they are written to.
template <class T>
class Reserved {
 public:
  explicit Reserved(std::int64_t size) : bytes_(static_cast<std::size_t>(size) * sizeof(T)) {
    void* const at =
        ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    REQUIRE(at != MAP_FAILED);
    data_ = static_cast<T*>(at);
  }
  Reserved(const Reserved&) = delete;
  Reserved& operator=(const Reserved&) = delete;
  ~Reserved() { ::munmap(data_, bytes_); }
  [[nodiscard]] T* data() const { return data_; }
  T& operator[](std::int64_t i) const { return data_[i]; }

 private:
  std::size_t bytes_;
  T* data_ = nullptr;
};

constexpr std::int64_t rows = 3, entries = 7;

/// The columns of three rows that begin at `first`, and where each row begins.
constexpr std::array<std::int64_t, entries> columns_of(std::int64_t first) {
  return {0, first, first + 2, first + 1, 0, first, first + 2};
}
constexpr std::array<std::int64_t, rows + 1> starts = {0, 2, 5, entries};

/// Rows 0 and first ... first + 2 of blocks of `width` numbers.
template <class T>
void fill_vectors(const Reserved<T>& x, std::int64_t first, int width) {
  int k = 0;
  for (const std::int64_t row : {std::int64_t{0}, first, first + 1, first + 2})
    for (int c = 0; c < width; ++c) x[width * row + c] = static_cast<T>(++k % 13 - 5.25);
}

/// Products of rows first ... first + 2, whose entries begin at `entry`.
template <int K>
std::vector<float> products_at(std::int64_t first, std::int64_t entry) {
  const Reserved<long long> start(first + rows + 1);
  const Reserved<Index> column(entry + entries + 1);  // the loops may look at the next one
  const Reserved<float> value(2 * (entry + entries + 1)), x(2 * K * (first + rows)), y(2 * K * (first + rows));
  for (std::int64_t i = 0; i <= rows; ++i) start[first + i] = entry + starts[static_cast<std::size_t>(i)];
  for (std::int64_t e = 0; e < entries; ++e) {
    column[entry + e] = static_cast<Index>(columns_of(first)[static_cast<std::size_t>(e)]);
    value[2 * (entry + e)] = 0.5F + static_cast<float>(e);
    value[2 * (entry + e) + 1] = 0.25F * static_cast<float>(e) - 1;
  }
  fill_vectors(x, first, 2 * K);
  const detail::simd::RawRows A{start.data(), column.data(), value.data()};
  detail::block_kernels<K>().rows(A, first, first + rows, x.data(), 0, nullptr, 0, nullptr, 1, y.data());
  return {y.data() + 2 * K * first, y.data() + 2 * K * (first + rows)};
}

/// The same of two matrices of one pattern, S x and then M x; `T` is the vectors' type.
template <class T, class Products>
std::vector<T> pencil_at(std::int64_t first, std::int64_t entry, int width, Products&& products) {
  const Reserved<Index> start(first + rows + 1), row(entry + entries + 1);
  const Reserved<double> S(2 * (entry + entries + 1)), M(2 * (entry + entries + 1));
  const Reserved<T> x(width * (first + rows));
  for (std::int64_t i = 0; i <= rows; ++i)
    start[first + i] = static_cast<Index>(entry + starts[static_cast<std::size_t>(i)]);
  for (std::int64_t e = 0; e < entries; ++e) {
    row[entry + e] = static_cast<Index>(columns_of(first)[static_cast<std::size_t>(e)]);
    for (std::int64_t part = 0; part < 2; ++part) {
      S[2 * (entry + e) + part] = 1.5 + static_cast<double>(e - part);
      M[2 * (entry + e) + part] = 0.75 * static_cast<double>(e + part) - 1;
    }
  }
  fill_vectors(x, first, width);
  std::vector<T> result(static_cast<std::size_t>(2 * rows * width));
  products(detail::simd::RawPencil{start.data(), row.data(), S.data(), M.data(), 0.5, 3}, first, first + rows, x.data(),
           result.data(), result.data() + rows * width);
  return result;
}

/// Relaxes one block of faces, or of pairs, whose rows of the exchange begin at `first`: the rows, then the sums.
template <class Block, class Relax>
std::vector<double> relaxed_at(std::int64_t first, int rows_of_lane, Relax&& relax) {
  using namespace detail::simd;
  const std::int64_t used = std::int64_t{rows_of_lane} * block_size;
  const Reserved<double> exchange(4 * (first + used));
  for (std::int64_t i = 0; i < 4 * used; ++i) exchange[4 * first + i] = static_cast<double>(i % 17) - 8.5;
  Block block{};
  auto* const all = reinterpret_cast<double*>(&block);  // weights, stiffness and inverses come before the rows
  const auto numbers = (sizeof(Block) - static_cast<std::size_t>(used) * sizeof(ExchangeRow)) / sizeof(double);
  for (std::size_t i = 0; i < numbers; ++i) all[i] = 0.01 * static_cast<double>(i % 23 + 1);
  ExchangeRow* const row = reinterpret_cast<ExchangeRow*>(all + numbers);
  for (std::int64_t i = 0; i < used; ++i) row[i] = static_cast<ExchangeRow>(first + (i * 5) % used);
  std::vector<double> result(block_size, 0);
  relax(block, exchange.data(), result.data());
  result.insert(result.end(), exchange.data() + 4 * first, exchange.data() + 4 * (first + used));
  return result;
}

}  // namespace

TEST_CASE("half-edges of the last faces have numbers, and no more faces are allowed") {
  static_assert(detail::most_faces == largest / 3 && detail::most_entries == largest);
  std::vector<std::int64_t> faces{0, 1, largest / 6, detail::most_faces - 1};
  if (wide)
    for (const std::int64_t t : {std::int64_t{1} << 31, std::int64_t{1} << 32, std::int64_t{1} << 40})
      for (const std::int64_t near : {t / 3 - 1, t / 3, t / 3 + 1, t, t + 1}) faces.push_back(near);
  for (const std::int64_t t : faces)
    for (std::int64_t c = 0; c < 3; ++c) {
      CAPTURE(t);
      const auto h = static_cast<Index>(3 * t + c);
      CHECK(h / 3 == t);
      CHECK(Mesh::face(h) == t);
      CHECK(Mesh::next(h) == 3 * t + (c + 1) % 3);
      CHECK(Mesh::prev(h) == 3 * t + (c + 2) % 3);
    }
}

TEST_CASE("offsets add up to the last entry") {
  constexpr Index step = largest / 4;
  std::vector<Index> counts{step, step, step, 0};
  CHECK(parallel_exclusive_scan(counts.data(), 4) == 3 * step);
  CHECK(counts == std::vector<Index>{0, step, 2 * step, 3 * step});
}

TEST_CASE("the real view has four places for each entry, up to the last one, and is refused beyond") {
  constexpr Index size = 5;
  for (const std::int64_t begin : {std::int64_t{0}, largest / 4 - size, std::min(largest / 4 - size, far)}) {
    CAPTURE(begin);
    const detail::RealPlaces<Index> places{static_cast<Index>(begin), size};
    std::set<std::int64_t> all;
    for (Index k = 0; k < size; ++k)
      for (const std::int64_t upper : {std::int64_t{places.first(k)}, std::int64_t{places.second(k)}}) {
        all.insert(upper);
        all.insert(upper + 1);
      }
    CHECK(all.size() == 4 * size);
    CHECK(*all.begin() == 4 * begin);
    CHECK(*all.rbegin() == 4 * (begin + size) - 1);
  }
  SparseMatrix<Complex<double>> A(1, 1);
  A.outerIndexPtr()[1] = static_cast<Index>(largest / 4 + 1);  // announced, not there
  CHECK_THROWS_AS(static_cast<void>(real_view(A)), OptionError);
  A.outerIndexPtr()[1] = 0;
}

TEST_CASE("products find rows and entries at the far end") {
  constexpr std::int64_t entry = std::int64_t{1} << 32;  // of levels, whose entries have 64-bit numbers in either case
  CHECK(products_at<1>(far, entry + 5) == products_at<1>(4, 0));
  CHECK(products_at<4>(far, entry + 5) == products_at<4>(4, 0));
  CHECK(products_at<8>(far, entry + 5) == products_at<8>(4, 0));
  CHECK(products_at<16>(far, entry + 5) == products_at<16>(4, 0));
  const auto pencil = [](std::int64_t first, std::int64_t at) {
    return pencil_at<float>(first, at, 8, detail::block_kernels<4>().pencil);
  };
  CHECK(pencil(far, far) == pencil(4, 0));
  const auto single = [](std::int64_t first, std::int64_t at) {
    return pencil_at<double>(first, at, 2, detail::vector_kernels<4>().pencil);
  };
  CHECK(single(far, far) == single(4, 0));
  // What is compared is no row of zeros.
  CHECK(std::ranges::count(products_at<4>(4, 0), 0.0F) < 4);
  CHECK(std::ranges::count(single(4, 0), 0.0) < 2);
}

TEST_CASE("the relaxation of the connection finds its rows at the far end") {
  using namespace detail::simd;
  const CorrectionLoops<double>& loops = correction_loops<double>(detail::best_isa());
  const auto faces = [&](std::int64_t first) {
    return relaxed_at<FaceBlock<double>>(first, 3, [&](const FaceBlock<double>& block, double* exchange, double* sums) {
      loops.faces(&block, 1, exchange, sums);
    });
  };
  const auto pairs = [&](std::int64_t first) {
    return relaxed_at<PairBlock<double>>(first, 4, [&](const PairBlock<double>& block, double* exchange, double* sums) {
      loops.pairs(&block, 1, exchange, sums);
    });
  };
  CHECK(faces(far_of_exchange) == faces(0));
  CHECK(pairs(far_of_exchange) == pairs(0));
  CHECK(std::ranges::count(faces(0), 0.0) <= 3 * block_size);  // of each row one number has no meaning
}

TEST_CASE("two indices make one key, whatever their size") {
  using detail::IndexPair;
  const detail::IndexPairHash hash;
  CHECK(hash({3, 5}) == ((std::size_t{3} << 32) | 5));
  CHECK(IndexPair{3, 5} != IndexPair{5, 3});
  if constexpr (wide) {
    constexpr auto beyond = static_cast<Index>(wide ? std::int64_t{1} << 32 : 0);
    CHECK(IndexPair{3, 5} != IndexPair{3, 5 + beyond});
    CHECK(IndexPair{3, 5} != IndexPair{3 + beyond, 5});
    CHECK(hash({3, 5}) != hash({3 + beyond, 5}));
    detail::RowSum row;  // its table knows columns by their lowest bits
    row.add(5, 1, 0);
    row.add(5 + beyond, 2, 0);
    row.add(5, 4, 0);
    REQUIRE(row.size() == 2);
    CHECK(row.sum(0) == detail::ComplexF(5, 0));
    CHECK(row.columns()[1] == 5 + beyond);
  }
}

TEST_CASE("indices of users are taken as far as they can be held") {
  const std::vector<std::uint32_t> F{0, 1, 3'000'000'000U};
  const std::vector<std::int64_t> G{0, 1, std::int64_t{1} << 40};
  if constexpr (wide) {
    CHECK(as_faces(F)(0, 2) == 3'000'000'000);
    CHECK(as_faces(G)(0, 2) == std::int64_t{1} << 40);
    CHECK_THROWS_AS(static_cast<void>(as_faces(std::vector<std::uint64_t>{0, 1, std::uint64_t{1} << 63})), MeshError);
  } else {
    CHECK_THROWS_AS(static_cast<void>(as_faces(F)), MeshError);
    CHECK_THROWS_AS(static_cast<void>(as_faces(G)), MeshError);
  }
  for (const std::int64_t faces : {std::int64_t{800'000'000}, std::int64_t{10'000'000'000}}) {
    const RunPlan plan = plan_field({.faces = faces, .memory = std::int64_t{1} << 60});
    CHECK(plan.halfedges == 3 * faces);
    CHECK(plan.refusals.empty() == wide);
  }
}

TEST_CASE("files with 32-bit numbers have these as long as they fit, and are refused beyond") {
  constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();
  CHECK_NOTHROW(detail::check_32_bits("a.ply", most, "vertices"));
  try {
    detail::check_32_bits("a.ply", most + 1, "vertices");
    FAIL("2^31 vertices fit into 32 bits");
  } catch (const FileError& e) {
    CHECK(e.path() == "a.ply");
    CHECK(std::string(e.what()).find("a.ply: 2147483648 vertices") == 0);
  }
  const auto numbers = [](std::int64_t last) {
    const detail::polydata::DataArray a =
        detail::polydata::whole_numbers("x", 2, last, [=](std::int64_t i) { return i == 0 ? 7 : last; });
    std::vector<char> bytes(static_cast<std::size_t>(a.bytes()));
    a.fill(0, 2, bytes.data());
    const auto at = [&]<class T>(T) {
      return std::int64_t{detail::load<T, std::endian::little>(bytes.data() + sizeof(T))};
    };
    return std::pair(std::string(a.type), a.type == "Int64" ? at(std::int64_t{}) : at(std::int32_t{}));
  };
  CHECK(numbers(most) == std::pair(std::string("Int32"), most));
  CHECK(numbers(most + 1) == std::pair(std::string("Int64"), most + 1));
  if constexpr (wide) {
    const test::Folder folder;
    SparseMatrix<Complex<double>> A(1, 1);
    A.outerIndexPtr()[1] = static_cast<Index>(most + 1);  // announced, not there
    CHECK_THROWS_AS(write_matrix(folder.path / "A.dat", A, MatrixFormat::petsc), FileError);
    CHECK(!std::filesystem::exists(folder.path / "A.dat"));
    A.outerIndexPtr()[1] = 0;
  }
}
