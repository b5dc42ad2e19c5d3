// SPDX-License-Identifier: MIT
//
// sharp.cpp: feature edges in the format of QuadWild.
#include <algorithm>
#include <string>
#include <utility>

#include "alcap/output.h"
#include "src/base/atomic_file.h"
#include "src/base/cancel.h"

namespace alcap {

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

}  // namespace alcap
