// SPDX-License-Identifier: MIT
//
// rosy.cpp: rotationally symmetric direction fields as vcglib reads them: the number of faces, n, then one direction
// per face. The other n - 1 follow by turning about the normal, so only branch 0 is written, with unit length; zero
// where the field is.
#include "src/field/branches.h"
#include "src/io/field/format.h"
#include "src/io/field/rows.h"

namespace alcap::detail {
namespace {

WrittenFiles write_rosy(const FieldJob& job, const Target& target) {
  const Field& field = job.at_faces();
  const Branches branches(field.n);
  WrittenFiles files = open_files({target.file});
  AtomicFile& file = *files[0];
  file.write(std::to_string(field.u.size()) + "\n" + std::to_string(field.n) + "\n");
  write_table(file, field.u.size(), 3 * (longest_number + 1), [&](std::int64_t i, char* to) {
    Eigen::RowVector3d d = branches.at(field, static_cast<Index>(i)).vector(0);
    if (d != Eigen::RowVector3d::Zero()) d.stableNormalize();
    for (int c = 0; c < 3; ++c) {
      to = put_text(to, d[c]);
      *to++ = c == 2 ? '\n' : ' ';
    }
    return to;
  });
  return files;
}

}  // namespace

const OutputFormat rosy_format = {"rosy", true, write_rosy, true};

}  // namespace alcap::detail
