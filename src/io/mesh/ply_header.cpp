// SPDX-License-Identifier: MIT
//
// ply_header.cpp: parses the header lines of a PLY file.
#include "src/io/mesh/ply_header.h"

#include <algorithm>
#include <array>
#include <string>
#include <unordered_set>

#include "src/io/mesh/tokenizer.h"

namespace alcap::detail {
namespace {

PlyType read_type(Tokenizer& in) {
  constexpr std::array<std::string_view, 16> names = {"char",   "int8",    "uchar",  "uint8",  "short", "int16",
                                                      "ushort", "uint16",  "int",    "int32",  "uint",  "uint32",
                                                      "float",  "float32", "double", "float64"};
  const std::string_view word = in.word();
  const auto at = std::ranges::find(names, word);
  if (at == names.end())
    in.fail(quoted(word) + " is no PLY type (char, uchar, short, ushort, int, uint, float, double)");
  return static_cast<PlyType>((at - names.begin()) / 2);
}

void read_format(Tokenizer& in, PlyHeader& header) {
  const std::string_view word = in.word();
  if (word == "ascii") {
    header.encoding = PlyEncoding::ascii;
  } else if (word == "binary_little_endian") {
    header.encoding = PlyEncoding::little_endian;
  } else if (word == "binary_big_endian") {
    header.encoding = PlyEncoding::big_endian;
  } else {
    in.fail(quoted(word) + " is no PLY encoding (ascii, binary_little_endian, binary_big_endian)");
  }
  const std::string_view version = in.word();
  if (version != "1.0") in.fail("PLY version " + quoted(version) + "; only 1.0 is known");
}

// No scanner writes so many; a row of so many numbers would be 100,000 bytes.
constexpr std::size_t most_elements = 10'000, most_properties = 10'000;

/// Names so far, of all elements and of the properties of the last one.
struct Names {
  std::unordered_set<std::string_view> elements, properties;
};

void read_element(Tokenizer& in, PlyHeader& header, Names& names) {
  PlyElement element;
  element.name = in.word();
  if (!in.integer(element.count)) in.fail_number("number of elements");
  if (element.count < 0) in.fail(std::to_string(element.count) + " elements " + quoted(element.name));
  if (header.elements.size() >= most_elements) in.fail("more than " + std::to_string(most_elements) + " elements");
  if (!names.elements.insert(element.name).second) in.fail("element " + quoted(element.name) + " is announced twice");
  names.properties.clear();
  header.elements.push_back(std::move(element));
}

void read_property(Tokenizer& in, PlyHeader& header, Names& names) {
  if (header.elements.empty()) in.fail("a property before the first element");
  PlyProperty property;
  const char* const from = in.where();
  if (in.word() == "list") {
    property.is_list = true;
    property.count_type = read_type(in);
    if (property.count_type >= PlyType::float32) in.fail("the length of a list must be of a whole-number type");
  } else {
    in.go(from);
  }
  property.type = read_type(in);
  property.name = in.word();
  if (property.name.empty()) in.fail("a property without a name");
  auto& properties = header.elements.back().properties;
  if (properties.size() >= most_properties) in.fail("more than " + std::to_string(most_properties) + " properties");
  if (!names.properties.insert(property.name).second) {
    // Both are stepped over, unless they are what is read.
    constexpr std::array<std::string_view, 5> read = {"x", "y", "z", "vertex_indices", "vertex_index"};
    if (std::ranges::find(read, property.name) != read.end())
      in.fail("property " + quoted(property.name) + " is announced twice");
    header.remarks.push_back("property " + quoted(property.name) + " is announced twice; the first one counts");
  }
  properties.push_back(property);
}

// The body starts right behind the line end: "\n", "\r\n" or "\r".
const char* behind_line_end(const char* p, const char* end) {
  if (p != end && *p == '\r') return p + 1 != end && p[1] == '\n' ? p + 2 : p + 1;
  return p == end ? p : p + 1;
}

}  // namespace

int PlyElement::find(std::string_view name_a, std::string_view name_b) const {
  const auto is_it = [&](const PlyProperty& p) { return p.name == name_a || p.name == name_b; };
  const auto at = std::ranges::find_if(properties, is_it);
  return at == properties.end() ? -1 : static_cast<int>(at - properties.begin());
}

PlyHeader read_ply_header(const Source& source) {
  Tokenizer in(source);
  PlyHeader header;
  Names names;
  if (!in.next_token() || in.word() != "ply") fail_at(source, source.begin(), "a PLY file starts with the word ply");
  bool has_format = false;
  for (;;) {
    if (!in.next_token()) fail(source, "the file ends inside the PLY header; it was cut");
    const char* const where = in.where();
    const std::string_view word = in.word();
    if (word == "format") {
      read_format(in, header);
      has_format = true;
    } else if (word == "element") {
      read_element(in, header, names);
    } else if (word == "property") {
      read_property(in, header, names);
    } else if (word == "comment" || word == "obj_info") {
      in.skip_line();
    } else if (word == "end_header") {
      break;
    } else if (has_format && header.elements.empty()) {
      // Before the first element it cannot be a part of one: a comment without the word.
      header.remarks.push_back("the header has a line that is none of PLY, which begins with " + quoted(word));
      in.skip_line();
    } else {
      fail_at(source, where, quoted(word) + " does not belong in a PLY header");
    }
    if (!in.at_line_end()) in.fail("more words than this line of a PLY header has");
    in.skip_line();
  }
  if (!has_format) fail(source, "the PLY header has no line 'format'");
  for (const auto& element : header.elements) {
    if (element.properties.empty() && element.count > 0) {
      fail(source, "element " + quoted(element.name) + " has no properties; remove it from the header");
    }
  }
  while (in.where() != in.end() && (*in.where() == ' ' || *in.where() == '\t')) in.go(in.where() + 1);
  header.body = behind_line_end(in.where(), in.end());
  return header;
}

}  // namespace alcap::detail
