// SPDX-License-Identifier: MIT
//
// stl.cpp: STL, ascii and binary. Triangles without vertices: corners at exactly the same position become one vertex,
// numbered by first appearance. Normals and attribute bytes are not read; the order of the corners orients a face.
#include <algorithm>
#include <array>
#include <cmath>

#include "src/base/bytes.h"
#include "src/base/numbers.h"
#include "src/io/mesh/builder.h"
#include "src/io/mesh/format.h"
#include "src/io/mesh/tokenizer.h"
#include "src/io/mesh/weld.h"

namespace alcap::detail {
namespace {

constexpr std::size_t header_bytes = 84;  // 80 of text, 4 of the number of triangles
constexpr std::size_t facet_bytes = 50;   // 12 floats and 2 bytes of attributes

std::uint64_t binary_size(std::string_view bytes) {
  return header_bytes + facet_bytes * std::uint64_t{load<std::uint32_t, std::endian::little>(bytes.data() + 80)};
}

bool starts_with_solid(std::string_view bytes) {
  const Source source{"", bytes};
  Tokenizer in(source);
  return in.next_token() && equal_ignoring_case(in.word(), "solid");
}

// Many binary files start with "solid" too: the size decides, then bytes that are no text.
bool is_binary(std::string_view bytes) {
  if (bytes.size() >= header_bytes && binary_size(bytes) == bytes.size()) return true;
  return !starts_with_solid(bytes) || bytes.substr(0, 1024).find('\0') != std::string_view::npos;
}

bool recognise_stl(std::string_view bytes) {
  return (bytes.size() > header_bytes && binary_size(bytes) == bytes.size()) || starts_with_solid(bytes);
}

class Facets {
 public:
  Facets(const Source& source, const ReadOptions& options, std::int64_t triangles)
      : mesh_(source, options), welder_(triangles / 2) {
    mesh_.reserve_faces(triangles);
  }
  Builder& mesh() { return mesh_; }
  [[nodiscard]] const Welder& welder() const { return welder_; }

  void add(const std::array<double, 9>& x, const std::array<std::uint64_t, 3>& hashes, const char* where) {
    std::array<std::int64_t, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) {
      bool is_new = false;
      corners[c] = welder_.number(&x[3 * c], hashes[c], is_new);
      if (is_new) mesh_.vertex(&x[3 * c], where);
    }
    mesh_.face(corners, where);
  }

 private:
  Builder mesh_;
  Welder welder_;
};

MeshFile read_binary(Source& source, const ReadOptions& options) {
  source.binary_from = source.begin();
  const std::size_t size = source.bytes.size();
  if (size < header_bytes)
    fail(source, "a binary STL file has 84 bytes before its triangles, this one ends before; it was cut");
  const std::uint64_t announced = binary_size(source.bytes);
  const bool whole = (size - header_bytes) % facet_bytes == 0;
  // Programs that write triangle by triangle forget the count; others pad the file.
  if (announced > size || (!whole && size - announced >= facet_bytes)) {
    fail(source, "the STL header announces " + std::to_string(announced) + " bytes, the file has " +
                     std::to_string(size) + "; it was cut, or it is no STL file");
  }
  const std::size_t triangles = (size - header_bytes) / facet_bytes;
  Facets facets(source, options, static_cast<std::int64_t>(triangles));
  if (announced != size)
    facets.mesh().remark(whole ? "the header announces " + std::to_string((announced - header_bytes) / facet_bytes) +
                                     " triangles, and all " + std::to_string(triangles) + " that there are were read"
                               : counted(static_cast<std::int64_t>(size - announced), "byte", "bytes") +
                                     " behind the data; left out");
  constexpr std::size_t batch = 32;  // table slots fetched ahead
  std::array<std::array<double, 9>, batch> x;
  std::array<std::array<std::uint64_t, 3>, batch> hashes;
  for (std::size_t first = 0; first < triangles; first += batch) {
    const std::size_t count = std::min(batch, triangles - first);
    const char* const from = source.begin() + header_bytes + facet_bytes * first;
    for (std::size_t t = 0; t < count; ++t) {
      for (std::size_t i = 0; i < 9; ++i) {
        const char* const place = from + facet_bytes * t + 12 + 4 * i;
        x[t][i] = double{load<float, std::endian::little>(place)};
        if (!std::isfinite(x[t][i])) {
          fail_at(source, place,
                  "corner " + std::to_string(i / 3) + " of face " + std::to_string(first + t) +
                      " (counted from 0) is not finite; remove or repair the triangle");
        }
      }
      for (std::size_t c = 0; c < 3; ++c) {
        hashes[t][c] = Welder::hash(&x[t][3 * c]);
        facets.welder().prefetch(hashes[t][c]);
      }
    }
    for (std::size_t t = 0; t < count; ++t) facets.add(x[t], hashes[t], from + facet_bytes * t);
  }
  return facets.mesh().finish("stl");
}

// The next word of the file must be this one.
void expect(Tokenizer& in, std::string_view wanted) {
  if (!in.next_token()) in.fail("the file ends before '" + std::string(wanted) + "'; it was cut");
  const char* const where = in.where();
  const std::string_view word = in.word();
  if (!equal_ignoring_case(word, wanted))
    fail_at(in.source(), where, quoted(word) + " where '" + std::string(wanted) + "' belongs");
}

void read_facet(Tokenizer& in, Facets& facets) {
  const char* const where = in.where();
  in.skip_line();  // the normal
  expect(in, "outer");
  expect(in, "loop");
  std::array<double, 9> x;
  for (std::size_t c = 0; c < 3; ++c) {
    expect(in, "vertex");
    for (std::size_t i = 3 * c; i < 3 * c + 3; ++i) {
      if (!in.real(x[i])) in.fail_number("corner " + std::to_string(c) + " of " + facets.mesh().next_face());
    }
  }
  expect(in, "endloop");
  expect(in, "endfacet");
  facets.add(x, {Welder::hash(&x[0]), Welder::hash(&x[3]), Welder::hash(&x[6])}, where);
}

MeshFile read_text(const Source& source, const ReadOptions& options) {
  constexpr std::size_t text_facet_bytes = 250;  // of usual files; only a first guess of the table's size
  Tokenizer in(source);
  Facets facets(source, options, static_cast<std::int64_t>(source.bytes.size() / text_facet_bytes));
  do {
    expect(in, "solid");
    in.skip_line();
    for (;;) {
      if (!in.next_token()) {
        if (facets.mesh().faces() == 0) in.fail("the file ends without 'endsolid'; it was cut");
        facets.mesh().remark("the file ends without 'endsolid'; it may have been cut");
        return facets.mesh().finish("stl");
      }
      const char* const where = in.where();
      const std::string_view word = in.word();
      if (equal_ignoring_case(word, "endsolid")) break;
      if (!equal_ignoring_case(word, "facet"))
        fail_at(source, where, quoted(word) + " where 'facet' or 'endsolid' belongs");
      read_facet(in, facets);
    }
    in.skip_line();
  } while (in.next_token());
  return facets.mesh().finish("stl");
}

MeshFile read_stl(const Source& given, const ReadOptions& options) {
  Source source = given;  // remembers where the binary part begins
  return is_binary(source.bytes) ? read_binary(source, options) : read_text(source, options);
}

}  // namespace

const Format stl_format = {"stl", recognise_stl, read_stl, nullptr};

}  // namespace alcap::detail
