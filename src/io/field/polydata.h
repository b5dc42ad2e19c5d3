// SPDX-License-Identifier: MIT
//
// polydata.h: VTK's XML PolyData with raw appended data, section by section. Internal to the formats that write it.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "src/base/narrow.h"
#include "src/io/field/rows.h"

namespace alcap::detail {

namespace polydata {

// One DataArray: its declaration, and how to write the bytes of the rows [begin, end).
struct DataArray {
  std::string name;
  std::string_view type;  // "Float64", "Int32", "Int64", "UInt8"
  int components;
  std::int64_t rows;
  std::size_t row_bytes;
  std::function<void(std::int64_t begin, std::int64_t end, char* to)> fill;

  [[nodiscard]] std::int64_t bytes() const { return rows * static_cast<std::int64_t>(row_bytes); }
};

template <class Number>
constexpr std::string_view type_name() {
  if constexpr (std::is_same_v<Number, double>) return "Float64";
  if constexpr (std::is_same_v<Number, std::int64_t>) return "Int64";
  if constexpr (std::is_same_v<Number, std::int32_t>) return "Int32";
  if constexpr (std::is_same_v<Number, std::uint8_t>) return "UInt8";
}

// An array whose row i is what row(i, numbers) puts into its `components` numbers.
template <class Number, int components, class Row>
DataArray array(std::string name, std::int64_t rows, Row row) {
  const auto fill = [row](std::int64_t begin, std::int64_t end, char* to) {
    for (std::int64_t i = begin; i < end; ++i) {
      Number numbers[components];
      row(i, numbers);
      for (const Number& x : numbers) to = put_binary(to, x);
    }
  };
  return {std::move(name), type_name<Number>(), components, rows, components * sizeof(Number), fill};
}

// Whole numbers up to `largest`, number(i) in row i: of 32 bits, or of 64 where they need them.
template <class Whole>
DataArray whole_numbers(std::string name, std::int64_t rows, std::int64_t largest, Whole number) {
  if (largest > most_32)
    return array<std::int64_t, 1>(std::move(name), rows,
                                  [number](std::int64_t i, std::int64_t* x) { x[0] = number(i); });
  return array<std::int32_t, 1>(std::move(name), rows, [number](std::int64_t i, std::int32_t* x) {
    x[0] = static_cast<std::int32_t>(number(i));
  });
}

// The colours that positive and negative indices have in every picture (Okabe and Ito 2008), light grey for 0: three
// bytes, which readers take as they are.
inline void put_index_colour(int index, std::uint8_t* x) {
  static constexpr std::uint8_t positive[3] = {213, 94, 0}, negative[3] = {0, 114, 178}, plain[3] = {235, 229, 216};
  const std::uint8_t* const colour = index > 0 ? positive : index < 0 ? negative : plain;
  for (int c = 0; c < 3; ++c) x[c] = colour[c];
}

// Attributes of a section whose first sight is these colours: bytes that are active are drawn as they are.
inline constexpr std::string_view index_colours_shown = " Scalars=\"index_rgb\"";

// A section of arrays, such as PointData.
struct Section {
  std::string_view tag;
  std::string_view attributes;
  std::vector<DataArray> arrays;
};

inline std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  return out;
}

// Declarations with the offsets at which the data will be.
inline std::string declare(const Section& section, std::int64_t& offset) {
  std::string text = "      <" + std::string(section.tag) + std::string(section.attributes) + ">\n";
  for (const DataArray& a : section.arrays) {
    text += "        <DataArray type=\"" + std::string(a.type) + "\" Name=\"" + escaped(a.name) +
            "\" NumberOfComponents=\"" + std::to_string(a.components) + "\" format=\"appended\" offset=\"" +
            std::to_string(offset) + "\"/>\n";
    offset += 8 + a.bytes();
  }
  return text + "      </" + std::string(section.tag) + ">\n";
}

inline void write_polydata(AtomicFile& file, int n, std::string_view counts, const std::vector<Section>& sections) {
  std::int64_t offset = 0;
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n  <PolyData>\n    <FieldData>\n      <DataArray type=\"Int32\" Name=\"n\" "
      "NumberOfTuples=\"1\" format=\"ascii\">" +
      std::to_string(n) + "</DataArray>\n    </FieldData>\n    <Piece " + std::string(counts) + ">\n";
  for (const Section& section : sections) text += declare(section, offset);
  text += "    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">\n_";
  file.write(text);
  for (const Section& section : sections) {
    for (const DataArray& a : section.arrays) {
      std::array<char, sizeof(std::uint64_t)> length;
      put_binary(length.data(), static_cast<std::uint64_t>(a.bytes()));
      file.write({length.data(), length.size()});
      write_ranges(file, a.rows, a.row_bytes, a.fill);
    }
  }
  file.write("\n  </AppendedData>\n</VTKFile>\n");
}

template <class Vector>
void put_vector(double* to, const Vector& d) {
  for (int c = 0; c < 3; ++c) to[c] = d[c];
}

}  // namespace polydata

}  // namespace alcap::detail
