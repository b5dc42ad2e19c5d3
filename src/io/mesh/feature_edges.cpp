// SPDX-License-Identifier: MIT
//
// feature_edges.cpp: feature edges in the format of QuadWild, and those that mesh files list beside their faces.
#include <algorithm>
#include <charconv>
#include <sstream>
#include <string>

#include "alcap/mesh_io.h"
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

std::vector<std::array<Index, 2>> read_feature_edges(const Faces& F, std::int64_t vertices,
                                                     const std::filesystem::path& file) {
  const std::string name = file.string();
  if (file.extension() == ".sharp") {
    std::vector<std::array<Index, 2>> pairs = read_sharp(F, file);
    if (pairs.empty()) throw FileError(name + ": lists no edges", name);
    return pairs;
  }
  MeshFile other = read_mesh(file);
  if (other.V.rows() != vertices)
    throw FileError(name + ": has " + std::to_string(other.V.rows()) + " vertices, and the mesh " +
                        std::to_string(vertices) + "; edges of features are named by them",
                    name);
  if (other.edges.empty())
    throw FileError(name + ": lists no edges; an OBJ has them as \"l\", a PLY as elements \"edge\"", name);
  return std::move(other.edges);
}

}  // namespace alcap
