// SPDX-License-Identifier: MIT
//
// rosy.cpp: rotationally symmetric direction fields as vcglib reads them: the number of faces, n, then one direction
// per face. The other n - 1 follow by turning about the normal, so only branch 0 is written, with unit length; zero
// where the field is.
#include "output/format.h"
#include "output/rows.h"

namespace alcap::detail {
namespace {

std::vector<std::filesystem::path> write(FieldJob& job, const Target& target) {
  const Field<double>& field = job.at_faces();
  AtomicFile file(target.file);
  file.write(std::to_string(field.u.size()) + "\n" + std::to_string(field.n) + "\n");
  write_rows(file, field.u.size(), [&](std::int64_t i, std::string& text) {
    Eigen::RowVector3d d = branch_vector(field, static_cast<Index>(i), 0);
    if (d != Eigen::RowVector3d::Zero()) d.stableNormalize();
    for (int c = 0; c < 3; ++c) append_text(text, d[c]), text += c == 2 ? '\n' : ' ';
  });
  file.commit();
  return {target.file};
}

}  // namespace

const OutputFormat rosy_format = {"rosy", write};

}  // namespace alcap::detail
