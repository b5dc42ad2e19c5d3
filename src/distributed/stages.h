// SPDX-License-Identifier: MIT
//
// stages.h: what fields and designs have in common: the mesh among the ranks, the connection, and what follows a
// solution. Internal to src/distributed.
#pragma once

#include "alcap/frames.h"
#include "src/distributed/connect.h"
#include "src/distributed/meter.h"

namespace alcap::detail::distributed {

struct Stage {
  Patch patch;
  Components components;
  Connection connection;
};

/// Throws OptionError where this rank's slice has not the size that its counts say.
void check_slice_size(const MeshSlice& mesh);

/// Patch and components. Throws MeshError, on all ranks.
[[nodiscard]] Stage divide(const MeshSlice& mesh, PartitionMethod method, Meter& meter, DistributedField& out);
/// The connection. Throws OptionError.
void connect(Stage& stage, const DistributedOptions& options, Meter& meter, DistributedField& out);

/// Of the local vertices; right at inner ones. Empty where no face is.
[[nodiscard]] Frames frames_of(const Stage& stage);
/// The field at local vertices from values at owned ones; right at inner vertices.
[[nodiscard]] Field extended(const Patch& patch, int n, const ComplexVectorX<double>& owned);

/// Singularities, index sums, and the field and its frames at the `rows` vertices of this rank's slice.
void conclude(Stage& stage, const Frames& frames, const Field& field, Eigen::Index rows, DistributedField& out);

/// distributed_field() of slices of any sizes, with options that are known to be good.
[[nodiscard]] DistributedField field_of_slices(const MeshSlice& mesh, const DistributedOptions& options);

}  // namespace alcap::detail::distributed
