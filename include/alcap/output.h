// SPDX-License-Identifier: MIT
//
// output.h: n-vector fields to files that other programs read, and back. docs/file-formats.md describes every file.
//
//   alcap::write_field({.surface = connected, .field = field, .singularities = singularities}, "out/bunny.vtp");
//   alcap::FieldFile back = alcap::read_field("out/bunny.ply");   // u, n and frames bit for bit
//   auto same = alcap::connect(alcap::Surface(back.V, back.F), back.how);   // and the connection
//
// The extension picks the format:
//   .rawfield         directions per face, and singular vertices in .sings beside it   (Directional, face-based)
//   .vertex.rawfield  directions per vertex, and singular faces in .vertex.sings       (Directional, vertex-based)
//   .rosy             one unit direction per face                                      (vcglib, QuadWild)
//   .ply              mesh, u and frames per vertex, binary; what read_field reads
//   .vtp              mesh, directions and face data, and _singularities.vtp beside it (VTK, ParaView)
//   .csv .npy .dmat   a table of one direction, its frame, angle and length per face   (spreadsheets, NumPy, libigl)
//   .vertex.csv ...   the same per vertex
// Vectors are in the coordinates and the units of V. Numbers in text are the shortest that read back as the same
// double. At a vertex that no face uses everything is zero. Every file appears complete or not at all.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "alcap/connected_surface.h"
#include "alcap/control.h"
#include "alcap/field.h"
#include "alcap/mesh_io.h"
#include "alcap/sharp_edges.h"
#include "alcap/singularities.h"
#include "alcap/streamlines.h"

namespace alcap {

/// A number per face that is to go into a file under a name, such as the integrated divergence.
struct FaceScalars {
  std::string name;                ///< of the array in the file
  std::span<const double> values;  ///< #F
};

/// What the files are made of. Refers to field, singularities and scalars: use it in the expression that creates it or
/// keep them alive.
struct FieldOutput {
  ConnectedSurface surface;                         ///< with the connection that the field was made with
  const Field& field;                               ///< per vertex, with frames
  std::span<const Singularity> singularities = {};  ///< of this field, all of them: find_singularities()
  std::span<const FaceScalars> face_scalars = {};   ///< for .vtp; besides "K" and "index", which are always there
  /// For a field of unit directions: what is written per face has length 1 as well. Where the field vanishes in the
  /// middle of a face, the direction is that of the face's first edge.
  bool unit = false;
};

/// Writes the field in the format of the extension and returns the files written. Throws FileError (unknown extension:
/// the message lists the known ones; folder missing, no permission, disk full) and OptionError (sizes that do not
/// match, no frames, a value that is not finite, a surface that lies in no space). When it throws, also Cancelled, no
/// incomplete file is left behind. Phase "write".
std::vector<std::filesystem::path> write_field(const FieldOutput& output, const std::filesystem::path& file,
                                               const RunControl& control = {});

/// The same for several files, written side by side; what they share, such as the field at the faces, is computed once.
/// When it throws, none of them has appeared.
std::vector<std::filesystem::path> write_field(const FieldOutput& output, std::span<const std::filesystem::path> files,
                                               const RunControl& control = {});

/// The extensions that write_field knows, without the leading dot.
[[nodiscard]] std::vector<std::string> field_formats();

/// Those that a folder gets unless others are asked for: the binary ones that hold everything, ply and vtp.
[[nodiscard]] std::vector<std::string> usual_field_formats();

/// The one of field_formats() that a file name ends with (case does not matter), or empty.
[[nodiscard]] std::string field_format(const std::filesystem::path& file);

/// Writes polylines, such as streamlines(), of an n-field in the format of the extension: .vtp (VTK, ParaView), .obj
/// (lines; Blender, MeshLab), .json (everything a CurveSet has). Throws FileError as write_field does.
void write_curves(const CurveSet& curves, int n, const std::filesystem::path& file, const RunControl& control = {});

/// The extensions that write_curves knows, without the leading dot.
[[nodiscard]] std::vector<std::string> curve_formats();

/// Writes one number per vertex, such as target_edge_lengths(), in the format of the extension: .sol (Medit; the size
/// map of mmg), .csv (with a line of names, `name` among them), .npy (NumPy), .dmat (libigl). Throws FileError as
/// write_field does, and OptionError for a number that is not finite.
void write_scalars(const VectorX<double>& values, const std::string& name, const std::filesystem::path& file,
                   const RunControl& control = {});

/// The extensions that write_scalars knows, without the leading dot.
[[nodiscard]] std::vector<std::string> scalar_formats();

/// Writes feature edges as QuadWild reads them (.sharp): their number, then lines "type,face,edge" with type 0 for
/// concave and 1 for convex and boundary edges, and edge k of a face from its corner k to the next. An edge is given
/// once for each of its faces, in the order of the faces. Throws FileError, and OptionError for the graph of another
/// surface. read_sharp() of mesh_io.h reads them back.
void write_sharp(const Surface& surface, const FeatureGraph& features, const std::filesystem::path& file,
                 const RunControl& control = {});

/// A field read back.
struct FieldFile {
  Positions<double> V;                                 ///< #V x 3
  Faces F;                                             ///< #F x 3
  Field field;                                         ///< n, u (#V) and the vertex frames, bit for bit as written
  ConnectionKind connection = ConnectionKind::global;  ///< the kind of connection the field was made with
  /// For connect(): the connection that the field was made with, cones and weights included.
  ConnectionOptions how = {};
  /// Whether `how` is all of it. Files of alcap before 0.2 name the kind alone, and no file holds a target.
  bool connection_known = false;
};

/// Reads a .ply that write_field wrote. Throws FileError: cannot be read, cut, or not such a file.
[[nodiscard]] FieldFile read_field(const std::filesystem::path& file, const RunControl& control = {});

}  // namespace alcap
