// SPDX-License-Identifier: MIT
//
// mesh_check.cpp: finds every defect. Each check leaves out the faces that an earlier check has named, so that one
// broken face is reported once and not as a swarm of consequences.
#include "alcap/mesh_check.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "src/base/array.h"
#include "src/base/cancel.h"
#include "src/base/limits.h"
#include "src/base/numbers.h"
#include "src/mesh/face_edges.h"

namespace alcap {
namespace {

using detail::FacesRef;

constexpr std::size_t most_named = 8;

/// Counts offenders and keeps the names of the first.
struct Found {
  std::int64_t count = 0;
  std::vector<Index> first;

  void add(Index element) {
    if (static_cast<std::size_t>(count++) < most_named) first.push_back(element);
  }
  void add_edge(Index a, Index b) {
    if (static_cast<std::size_t>(count++) < most_named) first.insert(first.end(), {std::min(a, b), std::max(a, b)});
  }
};

std::string names(const Found& found, Element element) {
  std::string text;
  const std::size_t step = element == Element::edge ? 2 : 1;
  for (std::size_t k = 0; k < found.first.size(); k += step) {
    if (k > 0) text += ", ";
    if (step == 2) text += '(';
    text += std::to_string(found.first[k]);
    if (step == 2) text.append(", ").append(std::to_string(found.first[k + 1])).append(")");
  }
  return static_cast<std::size_t>(found.count) > most_named ? text + ", ..." : text;
}

/// Appends "<count> <one|many>: <names>; <remedy>" unless nothing was found.
void report(std::vector<DefectReport>& reports, Found found, Defect defect, Element element, const std::string& one,
            const std::string& many, const std::string& remedy) {
  if (found.count == 0) return;
  std::string message =
      detail::counted(found.count, one.c_str(), many.c_str()) + ": " + names(found, element) + "; " + remedy;
  reports.push_back({defect, element, found.count, std::move(found.first), std::move(message)});
}

/// Whether the numbers of faces, halfedges and vertices fit the index type.
void check_size(std::vector<DefectReport>& reports, std::int64_t faces, std::int64_t vertices) {
  constexpr std::int64_t most = detail::most_faces;
  const auto complain = [&](std::int64_t count, const char* what, Element element) {
    reports.push_back({Defect::index_out_of_range,
                       element,
                       count,
                       {},
                       "the mesh has " + std::to_string(count) + " " + what + ", more than the " +
                           std::to_string(most) + " that can be numbered; simplify it or cut it into pieces"});
  };
  if (faces > most) complain(faces, "faces", Element::face);
  if (vertices > most) complain(vertices, "vertices", Element::vertex);
}

bool face_in_range(const FacesRef& F, Eigen::Index t, std::int64_t vertices) {
  return F.row(t).minCoeff() >= 0 && F.row(t).maxCoeff() < vertices;
}

bool repeats_vertex(const FacesRef& F, Eigen::Index t) {
  return F(t, 0) == F(t, 1) || F(t, 1) == F(t, 2) || F(t, 2) == F(t, 0);
}

void check_each_face(std::vector<DefectReport>& reports, const FacesRef& F, std::int64_t vertices,
                     detail::Array<char>& usable) {
  Found out, repeated;
  for (Eigen::Index t = 0; t < F.rows(); ++t) {
    detail::check_cancelled_at(t);
    char& good = usable[t];
    good = 0;
    if (!face_in_range(F, t, vertices)) {
      out.add(static_cast<Index>(t));
    } else if (repeats_vertex(F, t)) {
      repeated.add(static_cast<Index>(t));
    } else {
      good = 1;
    }
  }
  const std::string range = vertices > 0 ? "valid: 0 to " + std::to_string(vertices - 1) : "there are no vertices";
  report(reports, std::move(out), Defect::index_out_of_range, Element::face,
         "face uses a vertex that does not exist (" + range + ")",
         "faces use vertices that do not exist (" + range + ")", "the file may be cut, or number vertices differently");
  report(reports, std::move(repeated), Defect::repeated_vertex_in_face, Element::face,
         "face uses the same vertex twice", "faces use the same vertex twice", "delete them");
}

/// Faces with the vertices of an earlier face, in either orientation.
void check_duplicates(std::vector<DefectReport>& reports, const FacesRef& F, detail::Array<char>& usable) {
  const auto sorted = [&](Index t) {
    std::array<Index, 3> f{F(t, 0), F(t, 1), F(t, 2)};
    std::sort(f.begin(), f.end());
    return f;
  };
  detail::Buckets b = detail::bucket(static_cast<Index>(F.rows()), detail::vertex_limit(F, usable),
                                     [&](Index t) { return usable[t] != 0 ? F.row(t).minCoeff() : none; });
  for (std::size_t v = 0; v + 1 < b.start.size(); ++v) {
    detail::check_cancelled_at(static_cast<std::int64_t>(v));
    const auto begin = b.items.begin() + b.start[v], end = b.items.begin() + b.start[v + 1];
    if (end - begin < 2) continue;
    std::sort(begin, end, [&](Index s, Index t) {
      const auto fs = sorted(s), ft = sorted(t);
      return fs != ft ? fs < ft : s < t;
    });
    for (auto at = begin + 1; at < end; ++at) {
      if (sorted(at[0]) == sorted(at[-1])) usable[*at] = 2;
    }
  }
  Found found;
  for (std::int64_t t = 0; t < usable.size(); ++t) {
    if (usable[t] != 2) continue;
    found.add(static_cast<Index>(t));
    usable[t] = 0;
  }
  report(reports, std::move(found), Defect::duplicate_face, Element::face,
         "face has the same three vertices as an earlier one", "faces have the same three vertices as earlier ones",
         "delete them");
}

void check_edges(std::vector<DefectReport>& reports, const FacesRef& F, const detail::FaceEdges& edges) {
  Found found;
  for (std::size_t e = 0; e < edges.edges(); ++e) {
    detail::check_cancelled_at(static_cast<std::int64_t>(e));
    const auto h = edges.halfedges(e);
    if (h.size() > 2) found.add_edge(F(h[0] / 3, h[0] % 3), F(h[0] / 3, (h[0] + 1) % 3));
  }
  report(reports, std::move(found), Defect::non_manifold_edge, Element::edge,
         "edge has more than two faces (non-manifold)", "edges have more than two faces (non-manifold)",
         "split the mesh along them or delete the extra faces");
}

void check_orientable(std::vector<DefectReport>& reports, const detail::Orientation& orientation) {
  Found found;
  for (std::size_t p = 0; p < orientation.first_face.size(); ++p) {
    if (orientation.orientable[p] == 0) found.add(orientation.first_face[p]);
  }
  report(reports, std::move(found), Defect::not_orientable, Element::face,
         "piece of the surface is one-sided like a Moebius strip, so no orientation exists; it contains face",
         "pieces of the surface are one-sided like a Moebius strip, so no orientation exists; they contain the faces",
         "cut the surface open along a closed path that reverses sides");
}

void check_orientation(std::vector<DefectReport>& reports, const FacesRef& F, const detail::FaceEdges& edges,
                       const detail::Orientation& orientation) {
  Found found;
  for (std::size_t e = 0; e < edges.edges(); ++e) {
    const auto h = edges.halfedges(e);
    if (h.size() != 2 || F(h[0] / 3, h[0] % 3) != F(h[1] / 3, h[1] % 3)) continue;
    const Index piece = orientation.piece[h[0] / 3];
    if (orientation.orientable[detail::at(piece)] == 0) continue;
    found.add_edge(F(h[0] / 3, h[0] % 3), F(h[0] / 3, (h[0] + 1) % 3));
  }
  report(reports, std::move(found), Defect::inconsistent_orientation, Element::edge,
         "edge runs the same way in both of its faces (inconsistent orientation)",
         "edges run the same way in both of their faces (inconsistent orientation)",
         "turn the faces with repair_orientation()");
}

/// Vertices whose faces fall into several fans that share no edge. Corners are joined across edges of any number of
/// faces, so that the ends of a non-manifold edge are not named again.
void check_vertices(std::vector<DefectReport>& reports, const FacesRef& F, const detail::Array<char>& usable,
                    const detail::FaceEdges& edges) {
  detail::Array<Index> parent(3 * usable.size());
  std::iota(parent.begin(), parent.end(), Index{0});
  const auto root = [&](Index c) {
    while (parent[c] != c) {
      Index& p = parent[c];
      p = parent[p];
      c = p;
    }
    return c;
  };
  const auto join = [&](Index a, Index b) {
    a = root(a);
    b = root(b);
    parent[std::max(a, b)] = std::min(a, b);
  };
  for (std::size_t e = 0; e < edges.edges(); ++e) {
    detail::check_cancelled_at(static_cast<std::int64_t>(e));
    const auto h = edges.halfedges(e);
    const auto next = [](Index k) { return k % 3 == 2 ? k - 2 : k + 1; };
    for (std::size_t k = 1; k < h.size(); ++k) {
      const bool same_way = F(h[0] / 3, h[0] % 3) == F(h[k] / 3, h[k] % 3);
      join(h[0], same_way ? h[k] : next(h[k]));
      join(next(h[0]), same_way ? next(h[k]) : h[k]);
    }
  }
  std::vector<Index> fans;  // the vertex of each fan
  for (std::int64_t c = 0; c < parent.size(); ++c) {
    if (usable[c / 3] == 0 || parent[c] != static_cast<Index>(c)) continue;
    fans.push_back(F(c / 3, c % 3));
  }
  std::sort(fans.begin(), fans.end());
  Found found;
  for (std::size_t k = 1; k < fans.size(); ++k) {
    const bool second_fan = fans[k] == fans[k - 1] && (k == 1 || fans[k] != fans[k - 2]);
    if (second_fan) found.add(fans[k]);
  }
  report(reports, std::move(found), Defect::non_manifold_vertex, Element::vertex,
         "vertex joins parts of the surface that share no edge there (non-manifold, a bow-tie)",
         "vertices join parts of the surface that share no edge there (non-manifold, bow-ties)",
         "give each part its own copy of the vertex");
}

/// Everything that stops faces from being oriented. Leaves in `usable` the faces that later checks may look at.
std::vector<DefectReport> find_face_defects(const FacesRef& F, std::int64_t vertices, detail::Array<char>& usable) {
  std::vector<DefectReport> reports;
  if (F.rows() == 0) {
    reports.push_back({Defect::empty, Element::face, 0, {}, "the mesh has no faces; check that the file is complete"});
    return reports;
  }
  check_size(reports, F.rows(), vertices);
  if (!reports.empty()) return reports;
  usable = detail::Array<char>(F.rows(), 1);
  check_each_face(reports, F, vertices, usable);
  check_duplicates(reports, F, usable);
  return reports;
}

}  // namespace

bool measurable(const Eigen::Matrix<double, 1, 3>& a, const Eigen::Matrix<double, 1, 3>& b,
                const Eigen::Matrix<double, 1, 3>& c) {
  const double extent = std::max((b - a).cwiseAbs().maxCoeff(), (c - a).cwiseAbs().maxCoeff());
  return extent >= 1 / largest_length && extent <= largest_length;
}

bool degenerate(const Eigen::Matrix<double, 1, 3>& a, const Eigen::Matrix<double, 1, 3>& b,
                const Eigen::Matrix<double, 1, 3>& c) {
  Eigen::Matrix<double, 1, 3> ab = b - a, bc = c - b, ca = a - c;
  const double extent = std::max({ab.cwiseAbs().maxCoeff(), bc.cwiseAbs().maxCoeff(), ca.cwiseAbs().maxCoeff()});
  if (!(extent > 0 && extent <= std::numeric_limits<double>::max())) return true;
  ab /= extent;
  bc /= extent;
  ca /= extent;
  const double longest = std::sqrt(std::max({ab.squaredNorm(), bc.squaredNorm(), ca.squaredNorm()}));
  const double size = std::max({a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff(), c.cwiseAbs().maxCoeff()});
  const Eigen::Matrix<double, 1, 3> normal(ca.y() * ab.z() - ca.z() * ab.y(), ca.z() * ab.x() - ca.x() * ab.z(),
                                           ca.x() * ab.y() - ca.y() * ab.x());
  const double twice_area = normal.norm();
  return !(twice_area > double(4) * std::numeric_limits<double>::epsilon() * (size / extent) * longest);
}

std::vector<DefectReport> find_defects(const FacesRef& F, std::int64_t vertex_count) {
  detail::Array<char> usable;
  std::vector<DefectReport> reports = find_face_defects(F, vertex_count, usable);
  if (usable.empty()) return reports;
  const detail::FaceEdges edges(F, usable);
  const detail::Orientation orientation = detail::orient(F, usable, edges);
  check_edges(reports, F, edges);
  check_orientable(reports, orientation);
  check_orientation(reports, F, edges, orientation);
  check_vertices(reports, F, usable, edges);
  return reports;
}

std::vector<DefectReport> find_defects(const Positions<double>& V, const FacesRef& F) {
  std::vector<DefectReport> reports;
  Found not_finite, zero_area, zero_length, out_of_scale;
  detail::Array<char> finite(V.rows());
  for (Eigen::Index v = 0; v < V.rows(); ++v) {
    finite[v] = V.row(v).allFinite();
    if (!V.row(v).allFinite()) not_finite.add(static_cast<Index>(v));
  }
  std::vector<std::array<Index, 2>> short_edges;
  for (Eigen::Index t = 0; t < F.rows(); ++t) {
    detail::check_cancelled_at(t);
    if (!face_in_range(F, t, V.rows()) || repeats_vertex(F, t)) continue;
    bool known = true, has_length = true;
    for (int c = 0; c < 3; ++c) known = known && finite[F(t, c)] != 0;
    if (!known) continue;
    for (int c = 0; c < 3; ++c) {
      const Index a = F(t, c), b = F(t, (c + 1) % 3);
      if (V.row(a) != V.row(b)) continue;
      short_edges.push_back({std::min(a, b), std::max(a, b)});
      has_length = false;
    }
    if (!has_length) continue;
    if (!measurable(V.row(F(t, 0)), V.row(F(t, 1)), V.row(F(t, 2)))) {
      out_of_scale.add(static_cast<Index>(t));
    } else if (degenerate(V.row(F(t, 0)), V.row(F(t, 1)), V.row(F(t, 2)))) {
      zero_area.add(static_cast<Index>(t));
    }
  }
  std::sort(short_edges.begin(), short_edges.end());
  short_edges.erase(std::unique(short_edges.begin(), short_edges.end()), short_edges.end());
  for (const auto& e : short_edges) zero_length.add_edge(e[0], e[1]);
  report(reports, std::move(not_finite), Defect::not_finite, Element::vertex,
         "vertex has a coordinate that is not finite", "vertices have coordinates that are not finite",
         "correct or delete them");
  report(reports, std::move(zero_length), Defect::zero_length_edge, Element::edge, "edge has length zero",
         "edges have length zero", "collapse them (repair_weld(), then delete the faces that use a vertex twice)");
  report(reports, std::move(zero_area), Defect::zero_area_face, Element::face,
         "face has area zero (its corners lie on a line)", "faces have area zero (their corners lie on a line)",
         "flip or collapse their longest edges, or move a corner");
  report(reports, std::move(out_of_scale), Defect::scale_out_of_range, Element::face,
         "face is larger than 1e60 or smaller than 1e-60 across",
         "faces are larger than 1e60 or smaller than 1e-60 across", "use another unit of length");
  return reports;
}

void throw_defect(const DefectReport& report) {
  throw MeshError(report.message, report.defect, report.element, report.count, report.first);
}

Faces repair_orientation(const FacesRef& F, std::int64_t vertex_count, std::vector<Index>* flipped) {
  detail::Array<char> usable;
  std::vector<DefectReport> reports = find_face_defects(F, vertex_count, usable);
  if (!reports.empty()) throw_defect(reports.front());
  const detail::FaceEdges edges(F, usable);
  check_edges(reports, F, edges);
  if (!reports.empty()) throw_defect(reports.front());
  const detail::Orientation orientation = detail::orient(F, usable, edges);
  check_orientable(reports, orientation);
  if (!reports.empty()) throw_defect(reports.front());
  Faces out = F;
  if (flipped != nullptr) flipped->clear();
  for (std::int64_t t = 0; t < usable.size(); ++t) {
    if (orientation.turned[t] == 0) continue;
    std::swap(out(t, 1), out(t, 2));
    if (flipped != nullptr) flipped->push_back(static_cast<Index>(t));
  }
  return out;
}

}  // namespace alcap
