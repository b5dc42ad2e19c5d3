// SPDX-License-Identifier: MIT
#include "src/distributed/defects.h"

#include <algorithm>
#include <array>
#include <set>
#include <string>

#include "src/base/array.h"

namespace alcap::detail::distributed {
namespace {

constexpr std::size_t most_named = 8;

struct Words {
  Defect defect;
  const char* one;
  const char* many;
  const char* remedy;
};

/// In the order that find_defects() looks for them (mesh_check.h).
constexpr std::array<Words, 11> words{{
    {Defect::empty, "face", "faces", "the mesh has no faces; check that the file is complete"},
    {Defect::index_out_of_range, "face uses a vertex that does not exist", "faces use vertices that do not exist",
     "the file may be cut, or number vertices differently"},
    {Defect::repeated_vertex_in_face, "face uses the same vertex twice", "faces use the same vertex twice",
     "delete them"},
    {Defect::duplicate_face, "face has the vertices of an earlier one", "faces have the vertices of earlier ones",
     "delete them"},
    {Defect::non_manifold_edge, "edge has more than two faces", "edges have more than two faces",
     "cut the mesh there or delete the extra faces"},
    {Defect::inconsistent_orientation, "edge runs the same way in both of its faces (inconsistent orientation)",
     "edges run the same way in both of their faces (inconsistent orientation)",
     "turn the faces before (alcap --repair)"},
    {Defect::non_manifold_vertex,
     "vertex joins parts of the surface that share no edge there (non-manifold, a bow-tie)",
     "vertices join parts of the surface that share no edge there (non-manifold, bow-ties)",
     "give each part its own copy of the vertex"},
    {Defect::not_finite, "vertex has a coordinate that is not finite", "vertices have coordinates that are not finite",
     "correct or delete them"},
    {Defect::zero_length_edge, "edge has length zero", "edges have length zero", "collapse them"},
    {Defect::zero_area_face, "face has area zero (its corners lie on a line)",
     "faces have area zero (their corners lie on a line)", "flip or collapse their longest edges, or move a corner"},
    {Defect::scale_out_of_range, "face is larger than 1e60 or smaller than 1e-60 across",
     "faces are larger than 1e60 or smaller than 1e-60 across", "use another unit of length"},
}};

std::size_t order(Defect defect) {
  const auto found = std::ranges::find(words, defect, &Words::defect);
  return at(found - words.begin());
}

using Name = std::array<std::int32_t, 2>;  // of an edge; else the second is 0

std::string text_of(const std::set<Name>& names, bool edges) {
  std::string text;
  std::size_t count = 0;
  for (const Name& name : names) {
    if (count++ == most_named) return text + ", ...";
    if (count > 1) text += ", ";
    const std::string first = std::to_string(name[0]);
    text += edges ? "(" + first + ", " + std::to_string(name[1]) + ")" : first;
  }
  return text;
}

}  // namespace

void throw_first_defect(const std::vector<NamedDefect>& seen) {
  const NamedDefect& kind = *std::ranges::min_element(seen, {}, [](const NamedDefect& d) { return order(d.defect); });
  const bool edges = kind.element == Element::edge;
  const std::size_t step = edges ? 2 : 1;
  std::set<Name> names;
  std::int64_t most = 0;
  for (const NamedDefect& d : seen) {
    if (d.defect != kind.defect) continue;
    most = std::max(most, d.count);
    for (std::size_t k = 0; k + step <= d.first.size(); k += step)
      names.insert({d.first[k], edges ? d.first[k + 1] : 0});
  }
  // Ranks see the same elements at their borders, and name only the first of many.
  const bool complete = std::ranges::all_of(
      seen, [&](const NamedDefect& d) { return d.defect != kind.defect || at(d.count) * step == d.first.size(); });
  const std::int64_t count = std::max(most, count_of(names));
  const std::size_t word = order(kind.defect);
  const Words& text = words[std::min(word, words.size() - 1)];
  std::vector<std::int32_t> first;
  for (const Name& name : names) {
    if (first.size() == most_named * step) break;
    first.insert(first.end(), name.begin(), name.begin() + static_cast<std::ptrdiff_t>(step));
  }
  const std::string message = std::string(complete ? "" : "at least ") + std::to_string(count) + " " +
                              (count == 1 ? text.one : text.many) + ": " + text_of(names, edges) + "; " + text.remedy;
  throw MeshError(message, kind.defect, kind.element, count, std::move(first));
}

}  // namespace alcap::detail::distributed
