// SPDX-License-Identifier: MIT
//
// sharp.cpp: feature edges in the format of QuadWild.
#include <algorithm>
#include <charconv>
#include <sstream>
#include <string>
#include <utility>

#include "alcap/output.h"
#include "src/base/atomic_file.h"
#include "src/base/cancel.h"
#include "src/base/input_file.h"

namespace alcap {
namespace {

/// "a,b,c" of whole numbers, each at least 0; false otherwise.
bool three_numbers(std::string_view line, std::array<std::int64_t, 3>& numbers) {
  const char* at = line.data();
  const char* const end = at + line.size();
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [stop, error] = std::from_chars(at, end, numbers[k]);
    if (error != std::errc() || numbers[k] < 0) return false;
    if (k < 2 && (stop == end || *stop != ',')) return false;
    at = k < 2 ? stop + 1 : stop;
  }
  return at == end;
}

}  // namespace

void write_sharp(const Surface& surface, const FeatureGraph& features, const std::filesystem::path& file,
                 const RunControl& control) {
  const Mesh& mesh = surface.mesh();
  std::vector<std::pair<Index, char>> lines;  // halfedge, type
  for (std::size_t k = 0; k < features.edges.size(); ++k) {
    const Index e = features.edges[k];
    if (e < 0 || e >= mesh.edges()) throw OptionError("features", e, "must be a graph of this surface");
    const char type = features.angles[k] < 0 ? '0' : '1';
    for (const Index h : {mesh.halfedge(e), mesh.twin(mesh.halfedge(e))})
      if (h != none) lines.emplace_back(h, type);
  }
  std::sort(lines.begin(), lines.end());
  controlled(control, [&] {
    detail::report_phase("write");
    detail::AtomicFile out(file);
    out.write(std::to_string(lines.size()) + "\n");
    for (const auto& [h, type] : lines)
      out.write(std::string(1, type) + "," + std::to_string(h / 3) + "," + std::to_string(h % 3) + "\n");
    out.commit();
  });
}

std::vector<std::array<Index, 2>> read_sharp(const Faces& F, const std::filesystem::path& file) {
  const detail::InputFile input(file, {.what = "file of features"});
  std::istringstream in{std::string(input.bytes())};
  std::int64_t number = 0, announced = -1;
  const auto refuse = [&](const std::string& what) {
    throw FileError(file.string() + ", line " + std::to_string(number) + ": " + what, file.string(), number);
  };
  std::vector<std::array<Index, 2>> pairs;
  for (std::string line; std::getline(in, line);) {
    ++number;
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (line.empty()) continue;
    if (announced < 0) {
      const auto [stop, error] = std::from_chars(line.data(), line.data() + line.size(), announced);
      if (error != std::errc() || stop != line.data() + line.size() || announced < 0)
        refuse("\"" + line + "\" should be the number of feature edges");
      continue;
    }
    std::array<std::int64_t, 3> n{};
    if (!three_numbers(line, n)) refuse("\"" + line + "\" should be TYPE,FACE,EDGE, such as 1,12,0");
    if (n[1] >= F.rows() || n[2] > 2)
      refuse("there is no edge " + std::to_string(n[2]) + " of face " + std::to_string(n[1]) + "; the mesh has " +
             std::to_string(F.rows()) + " faces");
    const auto t = static_cast<Eigen::Index>(n[1]), c = static_cast<Eigen::Index>(n[2]);
    const Index i = F(t, c), j = F(t, (c + 1) % 3);
    pairs.push_back({std::min(i, j), std::max(i, j)});
  }
  if (announced != static_cast<std::int64_t>(pairs.size()))
    refuse(std::to_string(pairs.size()) + " feature edges, and the first line announces " +
           std::to_string(std::max<std::int64_t>(0, announced)) + "; the file may be cut");
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

}  // namespace alcap
