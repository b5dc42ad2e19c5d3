// SPDX-License-Identifier: MIT
//
// polydata.h: VTK's XML PolyData with raw appended data, section by section. Internal to the formats that write it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "output/rows.h"

namespace alcap::detail {

namespace polydata {

using Append = std::function<void(std::int64_t row, std::string& bytes)>;

// One DataArray: its declaration, and how to append a row of its bytes.
struct Array {
  std::string name;
  std::string_view type;  // "Float64", "Int32", "Int64", "UInt8"
  int components;
  std::int64_t rows;
  Append append;

  [[nodiscard]] std::int64_t bytes() const {
    return rows * components * (type == "Float64" || type == "Int64" ? 8 : type == "Int32" ? 4 : 1);
  }
};

// A section of arrays, such as PointData.
struct Section {
  std::string_view tag;
  std::string_view attributes;
  std::vector<Array> arrays;
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
  for (const Array& a : section.arrays) {
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
    for (const Array& a : section.arrays) {
      std::string length;
      append_binary(length, static_cast<std::uint64_t>(a.bytes()));
      file.write(length);
      write_rows(file, a.rows, a.append);
    }
  }
  file.write("\n  </AppendedData>\n</VTKFile>\n");
}

template <class Vector>
void append_vector(std::string& bytes, const Vector& d) {
  for (int c = 0; c < 3; ++c) append_binary(bytes, static_cast<double>(d[c]));
}

}  // namespace polydata

}  // namespace alcap::detail
