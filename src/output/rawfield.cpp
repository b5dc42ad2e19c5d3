// SPDX-License-Identifier: MIT
//
// rawfield.cpp: the two text files of the Directional library. A raw field is "n rows", then per element its n vectors,
// x y z each, counter-clockwise about the normal. Singularities are "n count", then "element index", the index in
// n-ths.
//
// Directional takes rows per face as a face-based field, whose singularities are vertices, and rows per vertex as a
// vertex-based one, whose singularities are faces. The face-based pair is the default, and its singular vertices are
// found from the very rows in the file, so both files agree.
#include "output/format.h"
#include "output/rows.h"

namespace alcap::detail {
namespace {

// An element and its index, in n-ths.
struct Pole {
  Index element;
  int index;
};

// Every line ends with a newline, also the last: Directional's reader reports failure at a file that ends in a digit.
void write_raw(AtomicFile& file, const Field<double>& field) {
  const int n = field.n;
  file.write(std::to_string(n) + " " + std::to_string(field.u.size()) + "\n");
  write_rows(file, field.u.size(), [&](std::int64_t i, std::string& text) {
    for (int k = 0; k < n; ++k) {
      const Eigen::RowVector3d d = branch_vector(field, static_cast<Index>(i), k);
      for (int c = 0; c < 3; ++c) append_text(text, d[c]), text += c == 2 && k + 1 == n ? '\n' : ' ';
    }
  });
}

void write_sings(AtomicFile& file, int n, const std::vector<Pole>& poles) {
  file.write(std::to_string(n) + " " + std::to_string(poles.size()) + "\n");
  for (const Pole& p : poles) file.write(std::to_string(p.element) + " " + std::to_string(p.index) + "\n");
}

std::vector<std::filesystem::path> write(const Field<double>& field, const std::vector<Pole>& poles,
                                         const Target& target, std::string_view sings_extension) {
  const std::filesystem::path sings_path = target.beside(sings_extension);
  AtomicFile raw(target.file), sings(sings_path);
  write_raw(raw, field);
  write_sings(sings, field.n, poles);
  raw.commit();
  sings.commit();
  return {target.file, sings_path};
}

std::vector<std::filesystem::path> write_per_face(FieldJob& job, const Target& target) {
  const Field<double>& field = job.at_faces();
  const std::vector<int> indices = vertex_indices(job.out.mesh, job.out.geometry, field);
  std::vector<Pole> poles;
  for (std::size_t v = 0; v < indices.size(); ++v) {
    if (indices[v] != 0) poles.push_back({static_cast<Index>(v), indices[v]});
  }
  return write(field, poles, target, ".sings");
}

std::vector<std::filesystem::path> write_per_vertex(FieldJob& job, const Target& target) {
  std::vector<Pole> poles;
  for (const Singularity& s : job.out.singularities) poles.push_back({s.face, s.index});
  return write(job.out.field, poles, target, ".vertex.sings");
}

}  // namespace

const OutputFormat rawfield_format = {"rawfield", write_per_face};
const OutputFormat vertex_rawfield_format = {"vertex.rawfield", write_per_vertex};

}  // namespace alcap::detail
