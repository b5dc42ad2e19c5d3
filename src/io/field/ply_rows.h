// SPDX-License-Identifier: MIT
//
// ply_rows.h: the parts of a field as PLY: the header, and rows of fixed lengths, which several ranks can write side by
// side.
#pragma once

#include <cstdint>
#include <string>

#include "alcap/connection.h"
#include "alcap/field.h"
#include "alcap/frames.h"
#include "src/field/branches.h"

namespace alcap::detail {

inline constexpr std::size_t ply_vertex_bytes = 14 * sizeof(double);
inline constexpr std::size_t ply_face_bytes = 1 + 3 * sizeof(std::int32_t);

[[nodiscard]] std::string ply_field_header(int n, const Connection& connection, std::int64_t vertices,
                                           std::int64_t faces);

/// Row v of V, of the field and of its frames at `to`; the row's end.
char* put_ply_vertex(const Positions<double>& V, const Field& field, const Frames& frames, const Branches& branches,
                     Index v, char* to);
/// Row t of F.
char* put_ply_face(const Faces& F, Index t, char* to);

}  // namespace alcap::detail
