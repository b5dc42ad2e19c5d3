// SPDX-License-Identifier: MIT
#include "src/distributed/read_off.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "src/base/array.h"
#include "src/base/limits.h"

namespace alcap::detail::distributed {
namespace {

[[noreturn]] void refuse_off(const std::string& path, const std::string& what) {
  throw FileError(path + ": " + what, path);
}

bool blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/// The lines of a text that hold data: neither empty nor comments.
class DataLines {
 public:
  explicit DataLines(std::string_view text) : rest_(text) {}
  /// False after the last one.
  bool next(std::string_view& line) {
    while (!rest_.empty()) {
      const std::size_t end = std::min(rest_.find('\n'), rest_.size());
      line = rest_.substr(0, end);
      rest_.remove_prefix(std::min(end + 1, rest_.size()));
      while (!line.empty() && blank(line.front())) line.remove_prefix(1);
      if (!line.empty() && line.front() != '#') return true;
    }
    return false;
  }
  /// What lies behind the line that was read last.
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

/// The next number of a line; false when there is none.
template <class Number>
bool take(std::string_view& line, Number& number) {
  while (!line.empty() && blank(line.front())) line.remove_prefix(1);
  if (!line.empty() && line.front() == '+') line.remove_prefix(1);
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
  if (error != std::errc()) return false;
  line.remove_prefix(at(end - line.data()));
  return line.empty() || blank(line.front());
}

/// The lines that start in this rank's share of the body, which its neighbours' shares meet without gaps.
std::vector<char> lines_of_share(const ParallelInput& file, std::int64_t body) {
  constexpr std::int64_t longest_line = 1 << 16;
  const std::int64_t size = file.size() - body;
  const std::int64_t begin = body + slice_begin(size, rank(), ranks());
  const std::int64_t end = body + slice_begin(size, rank() + 1, ranks());
  // One byte before, which says whether a line starts at the first, and the rest of the last line.
  const std::int64_t from = begin > body ? begin - 1 : begin, to = std::min(file.size(), end + longest_line);
  std::vector<char> bytes = file.read(from, to - from);
  auto first = bytes.begin();
  if (begin > body) {
    const auto line_end = std::find(first, bytes.end(), '\n');
    first = line_end == bytes.end() ? bytes.end() : line_end + 1;
  }
  // A line that starts at `end` or later belongs to the next rank.
  auto last = bytes.begin() + (end - from);
  if (end < file.size() && end > body && last > bytes.begin() && *(last - 1) != '\n')
    last = std::find(last, bytes.end(), '\n');
  if (first >= last) return {};
  return {first, last};
}

struct ParsedLines {
  std::vector<Index> vertices, faces;  // numbers
  std::vector<std::array<double, 3>> points;
  std::vector<std::array<Index, 3>> corners;
};

void parse_vertex(const std::string& path, std::int64_t number, std::string_view line, ParsedLines& out) {
  std::array<double, 3> x{};
  for (double& value : x)
    if (!take(line, value) || !std::isfinite(value))
      refuse_off(path, "vertex " + std::to_string(number) + " (counted from 0) does not have three finite coordinates");
  out.vertices.push_back(static_cast<Index>(number));
  out.points.push_back(x);
}

void parse_face(const std::string& path, std::int64_t number, std::int64_t vertices, std::string_view line,
                ParsedLines& out) {
  const std::string name = "face " + std::to_string(number) + " (counted from 0)";
  std::int64_t count = 0;
  if (!take(line, count) || count != 3)
    refuse_off(path,
               name + " does not have three corners; faces must be triangles here, one per line; alcap reads polygons");
  std::array<Index, 3> f{};
  for (Index& corner : f) {
    std::int64_t v = -1;
    if (!take(line, v)) refuse_off(path, name + " has a corner that is not a number");
    if (v < 0 || v >= vertices)
      refuse_off(path, name + " names vertex " + std::to_string(v) + ", but there are " + std::to_string(vertices) +
                           " vertices; the file was cut or its indices are off");
    corner = static_cast<Index>(v);
  }
  out.faces.push_back(static_cast<Index>(number));
  out.corners.push_back(f);
}

}  // namespace

OffHeader read_off_header(const std::string& path, std::string_view bytes) {
  DataLines lines(bytes);
  std::string_view line;
  (void)lines.next(line);
  while (!line.empty() && blank(line.back())) line.remove_suffix(1);
  if (line != "OFF")
    refuse_off(path, "the first line must be OFF alone here; read it with alcap and save it as binary PLY");
  OffHeader header;
  if (!lines.next(line) || !take(line, header.vertices) || !take(line, header.faces) || header.vertices < 0 ||
      header.faces < 0)
    refuse_off(path, "the second line must have the numbers of vertices, faces and edges");
  if (header.vertices > most_numbered || header.faces > most_numbered)
    refuse_off(path, "the file has more vertices or faces than the " + std::to_string(most_numbered) +
                         " that can be numbered");
  header.body = count_of(bytes) - count_of(lines.rest());
  return header;
}

MeshSlice read_off_slice(const std::string& path, const ParallelInput& file, const OffHeader& header) {
  const std::vector<char> bytes = lines_of_share(file, header.body);
  const std::string_view text(bytes.data(), bytes.size());
  std::int64_t lines = 0;
  std::string_view line;
  for (DataLines all(text); all.next(line);) ++lines;
  std::int64_t number = sum_before(lines);
  const std::int64_t total = sum(lines);
  ParsedLines parsed;
  agreed([&] {
    if (total < header.vertices + header.faces)
      refuse_off(path, "the file has " + std::to_string(total) + " lines of vertices and faces, and announces " +
                           std::to_string(header.vertices + header.faces) + "; it was cut");
    for (DataLines all(text); all.next(line); ++number) {
      if (number < header.vertices)
        parse_vertex(path, number, line, parsed);
      else if (number < header.vertices + header.faces)
        parse_face(path, number - header.vertices, header.vertices, line, parsed);
    }
  });
  const Slices vertex_slices(header.vertices), face_slices(header.faces);
  std::vector<std::array<double, 3>> points(at(vertex_slices.size(rank())));
  std::vector<std::array<Index, 3>> corners(at(face_slices.size(rank())));
  Exchange(vertex_slices.size(rank()), vertex_slices.find(parsed.vertices))
      .reduce(parsed.points.data(), points.data(), MPI_REPLACE);
  Exchange(face_slices.size(rank()), face_slices.find(parsed.faces))
      .reduce(parsed.corners.data(), corners.data(), MPI_REPLACE);
  MeshSlice mesh;
  mesh.vertices = header.vertices;
  mesh.faces = header.faces;
  mesh.first_vertex = vertex_slices.begin(rank());
  mesh.first_face = face_slices.begin(rank());
  mesh.V.resize(count_of(points), 3);
  mesh.F.resize(count_of(corners), 3);
  for (std::size_t v = 0; v < points.size(); ++v)
    for (int c = 0; c < 3; ++c) mesh.V(static_cast<Eigen::Index>(v), c) = points[v][at(c)];
  for (std::size_t t = 0; t < corners.size(); ++t)
    for (int c = 0; c < 3; ++c) mesh.F(static_cast<Eigen::Index>(t), c) = corners[t][at(c)];
  return mesh;
}

}  // namespace alcap::detail::distributed
