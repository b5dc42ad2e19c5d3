// SPDX-License-Identifier: MIT
//
// edit.cpp: the edits of a design, done.
#include <cstdlib>
#include <optional>
#include <vector>

#include "alcap/design_file.h"
#include "src/design/file/problem.h"
#include "src/design/singularity_parts.h"

namespace alcap::detail {
namespace {

/// Whether its angle is a swirl, which is the same in every face.
bool swirls(const DesignFile& design, const DesignSingularity& s) { return index_of(s.kind) * s.count == design.n; }

void move(const Surface& surface, const DesignFile& design, DesignSingularity& s, Index to) {
  const double turn = carried_turn(surface.mesh(), surface.geometry(), s.face, to);
  if (!s.relative_to && !swirls(design, s)) s.angle += turn * 180 / pi<double>;
  s.face = to;
  if (s.pin) s.barycentric = {1.0 / 3, 1.0 / 3, 1.0 / 3};
}

/// The first one with both indices; nothing when they cancel. A kind is kept while its sign is.
std::optional<DesignSingularity> sum(DesignSingularity a, const DesignSingularity& b) {
  const int index = index_of(a.kind) * a.count + index_of(b.kind) * b.count;
  if (index == 0) return std::nullopt;
  const int sign = index > 0 ? 1 : -1;
  if (sign != index_of(a.kind)) a.kind = sign > 0 ? SingularityKind::source : SingularityKind::saddle;
  a.count = std::abs(index);
  return a;
}

}  // namespace

void apply_edits(const Surface& surface, DesignFile& design) {
  if (design.edits.empty()) return;
  std::vector<std::optional<DesignSingularity>> list(design.singularities.begin(), design.singularities.end());
  for (const DesignEdit& edit : design.edits) {
    std::optional<DesignSingularity>& which = list[edit.which];
    switch (edit.type) {
      case DesignEdit::Type::move:
        move(surface, design, *which, edit.to);
        break;
      case DesignEdit::Type::merge:
        which = sum(*which, *list[edit.other]);
        list[edit.other].reset();
        break;
      case DesignEdit::Type::split: {
        DesignSingularity part = *which;
        part.count = edit.count;
        move(surface, design, part, edit.to);
        which->count -= edit.count;
        list.emplace_back(std::move(part));  // invalidates `which`
        break;
      }
    }
  }
  design.singularities.clear();
  for (const auto& s : list)
    if (s) design.singularities.push_back(*s);
  design.edits.clear();
}

}  // namespace alcap::detail
