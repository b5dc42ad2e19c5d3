// SPDX-License-Identifier: MIT
//
// matrix_file.cpp: matrices in PETSc's binary format, as Matrix Market text, and as SciPy's npz: a ZIP archive of
// uncompressed .npy arrays.
#include "alcap/matrix_file.h"

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "src/base/atomic_file.h"
#include "src/base/bytes.h"
#include "src/base/narrow.h"
#include "src/base/npy.h"
#include "src/base/shortest.h"

namespace alcap {
namespace {

using C = std::complex<double>;
using Matrix = SparseMatrix<C>;
using detail::AtomicFile;

/// Numbers on their way into a file or a checksum, byte by byte in the order asked for.
template <std::endian order, class T>
void append(std::string& text, T value) {
  auto bytes = detail::little_endian(value);
  if constexpr (order == std::endian::big) std::ranges::reverse(bytes);
  text.append(bytes.data(), bytes.size());
}

/// Hands text to `take` whenever there is a good piece of it.
constexpr std::size_t piece = std::size_t{1} << 16;
template <class Take, class Add>
void in_pieces(std::int64_t count, Take&& take, Add&& add) {
  std::string text;
  for (std::int64_t i = 0; i < count; ++i) {
    add(i, text);
    if (text.size() < piece && i + 1 < count) continue;
    take(std::string_view(text));
    text.clear();
  }
}

// Row i of a Hermitian matrix is the conjugate of column i.
void write_petsc(AtomicFile& file, const Matrix& A) {
  detail::check_32_bits(file.target(), A.rows(), "rows");
  detail::check_32_bits(file.target(), A.nonZeros(), "entries");
  constexpr std::int32_t matrix_id = 1211216;
  constexpr auto big = std::endian::big;
  const auto take = [&](std::string_view bytes) { file.write(bytes); };
  const std::int32_t head[] = {matrix_id, static_cast<std::int32_t>(A.rows()), static_cast<std::int32_t>(A.cols()),
                               static_cast<std::int32_t>(A.nonZeros())};
  in_pieces(4, take, [&](std::int64_t i, std::string& text) { append<big>(text, head[i]); });
  const Index* const start = A.outerIndexPtr();
  in_pieces(A.cols(), take, [&](std::int64_t i, std::string& text) {
    append<big>(text, static_cast<std::int32_t>(start[i + 1] - start[i]));
  });
  in_pieces(A.nonZeros(), take, [&](std::int64_t k, std::string& text) {
    append<big>(text, static_cast<std::int32_t>(A.innerIndexPtr()[k]));
  });
  in_pieces(A.nonZeros(), take, [&](std::int64_t k, std::string& text) {
    append<big>(text, A.valuePtr()[k].real());
    append<big>(text, -A.valuePtr()[k].imag());
  });
}

void append_number(std::string& text, double x) {
  std::array<char, 32> room;
  const auto [end, error] = std::to_chars(room.data(), room.data() + room.size(), x);
  text.append(room.data(), end);
}

void write_mtx(AtomicFile& file, const Matrix& A) {
  std::int64_t lower = 0;
  for (Index j = 0; j < A.outerSize(); ++j)
    for (Matrix::InnerIterator it(A, j); it; ++it) lower += it.row() >= j ? 1 : 0;
  file.write("%%MatrixMarket matrix coordinate complex hermitian\n% written by alcap\n");
  file.write(std::to_string(A.rows()) + " " + std::to_string(A.cols()) + " " + std::to_string(lower) + "\n");
  const auto take = [&](std::string_view text) { file.write(text); };
  in_pieces(A.outerSize(), take, [&](std::int64_t j, std::string& text) {
    for (Matrix::InnerIterator it(A, static_cast<Index>(j)); it; ++it) {
      if (it.row() < j) continue;
      text += std::to_string(it.row() + 1) + " " + std::to_string(j + 1) + " ";
      append_number(text, it.value().real());
      text += ' ';
      append_number(text, it.row() == j ? 0.0 : it.value().imag());  // the diagonal of a Hermitian matrix is real
      text += '\n';
    }
  });
}

/// The checksum of ZIP: the remainder of the bits divided by the polynomial 0x104C11DB7, lowest bits first.
class Crc {
 public:
  void add(std::string_view bytes) {
    for (const char c : bytes) crc_ = table()[(crc_ ^ static_cast<unsigned char>(c)) & 0xFFU] ^ (crc_ >> 8U);
  }
  [[nodiscard]] std::uint32_t value() const { return ~crc_; }

 private:
  static const std::array<std::uint32_t, 256>& table() {
    static constexpr auto entries = [] {
      std::array<std::uint32_t, 256> all{};
      for (std::uint32_t i = 0; i < 256; ++i) {
        std::uint32_t x = i;
        for (int bit = 0; bit < 8; ++bit) x = (x & 1U) != 0 ? 0xEDB88320U ^ (x >> 1U) : x >> 1U;
        all[i] = x;
      }
      return all;
    }();
    return entries;
  }
  std::uint32_t crc_ = ~std::uint32_t{0};
};

/// An archive of members that are stored as they are.
class Zip {
 public:
  explicit Zip(AtomicFile& file) : file_(file) {}

  /// An array of numpy: `type` is its dtype, `shape` its shape as Python writes it; fill(take) produces the bytes, the
  /// same ones each time: first for the checksum, then for the file.
  template <class Fill>
  void add_array(const std::string& name, const std::string& type, const std::string& shape, Fill&& fill) {
    const std::string head = detail::npy_head(type, shape);
    Crc crc;
    std::uint64_t size = 0;
    const auto count = [&](std::string_view bytes) {
      crc.add(bytes);
      size += bytes.size();
    };
    count(head);
    fill(count);
    const std::uint64_t offset = static_cast<std::uint64_t>(file_.size());
    if (size >= none || offset + size >= none)
      throw FileError(file_.target().string() + ": an npz of 4 GB or more cannot be written; the format petsc can",
                      file_.target().string());
    const std::string common = shared_head(crc.value(), static_cast<std::uint32_t>(size), name + ".npy");
    std::string local;
    append<little>(local, std::uint32_t{0x04034b50});
    file_.write(local + common + name + ".npy");
    file_.write(head);
    fill([&](std::string_view bytes) { file_.write(bytes); });
    append<little>(directory_, std::uint32_t{0x02014b50});
    append<little>(directory_, version);
    directory_ += common;
    for (int k = 0; k < 3; ++k) append<little>(directory_, std::uint16_t{0});  // comment, disk, text or binary
    append<little>(directory_, std::uint32_t{0});                              // attributes
    append<little>(directory_, static_cast<std::uint32_t>(offset));
    directory_ += name + ".npy";
    ++members_;
  }

  void finish() {
    std::string end;
    append<little>(end, std::uint32_t{0x06054b50});
    append<little>(end, std::uint32_t{0});  // this disk, first disk
    append<little>(end, members_);
    append<little>(end, members_);
    append<little>(end, static_cast<std::uint32_t>(directory_.size()));
    append<little>(end, static_cast<std::uint32_t>(file_.size()));
    append<little>(end, std::uint16_t{0});
    file_.write(directory_);
    file_.write(end);
  }

 private:
  static constexpr auto little = std::endian::little;
  static constexpr std::uint64_t none = std::numeric_limits<std::uint32_t>::max() - (1U << 16U);
  static constexpr std::uint16_t version = 20;

  /// What a member's own head and its line in the directory have in common; the time is the oldest there is.
  static std::string shared_head(std::uint32_t crc, std::uint32_t size, const std::string& name) {
    std::string text;
    constexpr std::uint16_t first_of_january_1980 = 0x21;
    for (const std::uint16_t x : {version, std::uint16_t{0}, std::uint16_t{0}, std::uint16_t{0}, first_of_january_1980})
      append<little>(text, x);
    for (const std::uint32_t x : {crc, size, size}) append<little>(text, x);
    append<little>(text, static_cast<std::uint16_t>(name.size()));
    append<little>(text, std::uint16_t{0});
    return text;
  }

  AtomicFile& file_;
  std::string directory_;
  std::uint16_t members_ = 0;
};

void write_npz(AtomicFile& file, const Matrix& A) {
  constexpr auto little = std::endian::little;
  Zip zip(file);
  const auto shape = [](std::int64_t n) { return "(" + std::to_string(n) + ",)"; };
  const auto numbers = [&](std::int64_t count, auto at) {
    return [=](auto&& take) {
      in_pieces(count, take, [&](std::int64_t k, std::string& text) { append<little>(text, at(k)); });
    };
  };
  const Index* const start = A.outerIndexPtr();
  const Index* const row = A.innerIndexPtr();
  // Numbers of 32 bits are enough: with rows or entries beyond them the archive would be too large.
  const C* const value = A.valuePtr();
  zip.add_array("indices", "<i4", shape(A.nonZeros()),
                numbers(A.nonZeros(), [=](std::int64_t k) { return static_cast<std::int32_t>(row[k]); }));
  zip.add_array("indptr", "<i4", shape(A.cols() + 1),
                numbers(A.cols() + 1, [=](std::int64_t k) { return static_cast<std::int32_t>(start[k]); }));
  zip.add_array("format", "|S3", "()", [](auto&& take) { take(std::string_view("csc")); });
  zip.add_array("shape", "<i8", "(2,)", numbers(2, [n = std::int64_t{A.rows()}](std::int64_t) { return n; }));
  zip.add_array("data", "<c16", shape(A.nonZeros()), numbers(2 * A.nonZeros(), [=](std::int64_t k) {
                  return k % 2 == 0 ? value[k / 2].real() : value[k / 2].imag();
                }));
  zip.finish();
}

}  // namespace

void write_matrix(const std::filesystem::path& path, const Matrix& A, MatrixFormat format) {
  if (A.rows() != A.cols()) throw SolveError("a Hermitian matrix is square");
  if (!A.isCompressed()) {
    Matrix compressed = A;
    compressed.makeCompressed();
    write_matrix(path, compressed, format);
    return;
  }
  AtomicFile file(path);
  switch (format) {
    case MatrixFormat::petsc:
      write_petsc(file, A);
      break;
    case MatrixFormat::mtx:
      write_mtx(file, A);
      break;
    case MatrixFormat::npz:
      write_npz(file, A);
      break;
  }
  file.commit();
}

}  // namespace alcap
