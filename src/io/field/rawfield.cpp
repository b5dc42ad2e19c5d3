// SPDX-License-Identifier: MIT
//
// rawfield.cpp: the two text files of the Directional library. A raw field is "n rows", then per element its n vectors,
// x y z each, counter-clockwise about the normal. Singularities are "n count", then "element index", the index in
// n-ths.
//
// Directional takes rows per face as a face-based field, whose singularities are vertices, and rows per vertex as a
// vertex-based one, whose singularities are faces. The face-based pair is the default, and its singular vertices are
// found from the very rows in the file, so both files agree.
#include <cstring>
#include <vector>

#include "src/base/array.h"
#include "src/field/branches.h"
#include "src/io/field/format.h"
#include "src/io/field/rows.h"

namespace alcap::detail {
namespace {

// An element and its index, in n-ths.
struct Pole {
  Index element;
  int index;
};

// A number and the blank after it.
constexpr std::size_t longest_entry = longest_number + 1;

// Writes the number [from, from + length) with the opposite sign.
char* put_opposite(const char* from, std::size_t length, char* to) {
  if (*from == '-') {
    ++from;
    --length;
  } else if (length > 2 || *from != '0') {  // 0 has no sign
    *to++ = '-';
  }
  std::memmove(to, from, longest_entry);  // in one piece; what is too much is written over
  return to + length;
}

// Every line ends with a newline, also the last: Directional's reader reports failure at a file that ends in a digit.
void write_raw(AtomicFile& file, const Field& field) {
  const int n = field.n;
  const Branches branches(n);
  file.write(std::to_string(n) + " " + std::to_string(field.u.size()) + "\n");
  // One more entry, for what put_opposite() copies too much.
  const std::size_t most = (3 * at(n) + 1) * longest_entry;
  write_ranges(file, field.u.size(), most, [&](std::int64_t begin, std::int64_t end, char* to) {
    std::vector<std::size_t> lengths;
    for (std::int64_t i = begin; i < end; ++i) {
      const auto here = branches.at(field, static_cast<Index>(i));
      const char* from = to;
      lengths.clear();
      for (int k = 0; k < branches.independent(); ++k) {
        const Eigen::RowVector3d d = here.vector(k);
        for (int c = 0; c < 3; ++c) {
          const char* const start = to;
          to = put_text(to, d[c]);
          *to++ = ' ';
          lengths.push_back(at(to - start));
        }
      }
      if (branches.independent() < n) {
        for (const std::size_t length : lengths) {
          to = put_opposite(from, length, to);
          from += length;
        }
      }
      to[-1] = '\n';
    }
    return to;
  });
}

void write_sings(AtomicFile& file, int n, const std::vector<Pole>& poles) {
  file.write(std::to_string(n) + " " + std::to_string(poles.size()) + "\n");
  for (const Pole& p : poles) file.write(std::to_string(p.element) + " " + std::to_string(p.index) + "\n");
}

WrittenFiles write(const Field& field, const std::vector<Pole>& poles, const Target& target,
                   std::string_view sings_extension) {
  WrittenFiles files = open_files({target.file, target.beside(sings_extension)});
  write_raw(*files[0], field);
  write_sings(*files[1], field.n, poles);
  return files;
}

WrittenFiles write_per_face(const FieldJob& job, const Target& target) {
  const Field& field = job.at_faces();
  const std::vector<int> indices = vertex_indices(job.out.surface, field);
  std::vector<Pole> poles;
  for (std::size_t v = 0; v < indices.size(); ++v) {
    if (indices[v] != 0) poles.push_back({static_cast<Index>(v), indices[v]});
  }
  return write(field, poles, target, ".sings");
}

WrittenFiles write_per_vertex(const FieldJob& job, const Target& target) {
  std::vector<Pole> poles;
  for (const Singularity& s : job.out.singularities) poles.push_back({s.face, s.index});
  return write(job.out.field, poles, target, ".vertex.sings");
}

}  // namespace

const OutputFormat rawfield_format = {"rawfield", true, write_per_face, true};
const OutputFormat vertex_rawfield_format = {"vertex.rawfield", false, write_per_vertex, true};

}  // namespace alcap::detail
