// SPDX-License-Identifier: MIT
//
// mesh_io.h: triangle meshes from and to files.
//
// Read: OBJ, OFF (with its C, N, ST variants), PLY (ascii, binary of both endians), STL (ascii, binary).
// Write: OFF, OBJ, PLY (binary little endian); doubles come back bit for bit.
//
// The numbering is the user's: row i of V is the i-th vertex of the file, row k of F its k-th face (with polygons, its
// k-th triangle). Nothing is dropped, merged or reordered; only STL, which has no vertices, is welded: corners at
// exactly the same position (-0 equals 0) become one vertex, numbered by first appearance.
//
// The readers are strict about numbers: what is none (1.5abc, 1,5, 0x10, nan, 1e999) is an error that gives the line
// and the text, never another number. They are tolerant where the meaning is certain all the same, and say so in
// MeshFile::remarks: statements they do not know, faces of fewer than three corners, vertices without a position that
// no face uses, lists across lines, a few bytes behind the data. Every failure is a FileError with the path, the line
// or byte, and what to do. Files are read into memory whole before they are parsed: one that changes meanwhile is an
// error, or what it was when it was opened.
//
//   alcap::MeshFile file = alcap::read_mesh("bunny.ply");
//   alcap::write_mesh("bunny.off", file.V, file.F);
//   auto lengths = alcap::read_edge_lengths("cone.txt", mesh);   // of an intrinsic surface
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "alcap/control.h"
#include "alcap/conventions.h"
#include "alcap/mesh.h"

namespace alcap {

/// How a mesh file is read.
struct ReadOptions {
  /// What becomes of faces with more than three corners.
  enum class Polygons { triangulate, refuse };

  /// What to do with faces of more than three corners. `triangulate` keeps all vertices and adds none: a polygon whose
  /// fan from the first corner has no flipped or flat triangle becomes that fan; every other one is cut ear by ear in
  /// the plane across its area vector (a concave quad: along the diagonal at its reflex corner). On by default because
  /// quads are common and the choice of diagonal rarely matters.
  Polygons polygons = Polygons::triangulate;

  /// Name of the format ("obj", "off", "ply", "stl"). Empty: by content, then by extension, so that a wrong extension
  /// does no harm.
  std::string format = {};

  RunControl control = {};  // phase "read", with the part of the file that is done
};
template <>
struct NamesOf<ReadOptions::Polygons> {
  static constexpr auto table = detail::name_table<ReadOptions::Polygons>(
      {{ReadOptions::Polygons::triangulate, "triangulate"}, {ReadOptions::Polygons::refuse, "refuse"}});
};

/// What a mesh file held.
struct MeshFile {
  /// Lines (OBJ) or elements (PLY) of one kind that carry no surface, such as "vt", "l" or "edge".
  struct Ignored {
    std::string kind;        ///< as the file calls it
    std::int64_t count = 0;  ///< how many
  };

  Positions<double> V;            ///< #V x 3, in the units of the file; all finite (see remarks)
  Faces F;                        ///< #F x 3, orientation as in the file; indices in [0, #V)
  std::vector<Index> polygon_of;  ///< #F, number of the file's polygon; empty when all faces were triangles
  std::string format;             ///< "obj", "off", "ply" or "stl"
  std::vector<Ignored> ignored;   ///< in order of first appearance
  /// Edges that the file lists beside its faces, such as creases, by their vertices: the segments of an OBJ's "l", the
  /// elements "edge" of a PLY. They count as ignored, too.
  std::vector<std::array<Index, 2>> edges;
  std::int64_t bytes = 0;  ///< size of the file
  /// One sentence for everything about the file that is not as its format says, and how it was understood.
  std::vector<std::string> remarks;
};

/// Reads a mesh. Throws FileError (missing, unreadable, empty, a directory, cut, malformed, no vertices, no faces,
/// index out of range, a number that is not finite) and OptionError (unknown format). Does not check the topology:
/// mesh.h does.
[[nodiscard]] MeshFile read_mesh(const std::filesystem::path& path, const ReadOptions& options = {});

/// The same from memory; `format` as in ReadOptions (which it replaces).
[[nodiscard]] MeshFile read_mesh_from_memory(std::string_view bytes, std::string_view format = {},
                                             const ReadOptions& options = {});

/// The feature edges of a .sharp file on faces F, by their vertices, for edges_between(). Throws FileError: missing,
/// not such a file, no such face.
[[nodiscard]] std::vector<std::array<Index, 2>> read_sharp(const Faces& F, const std::filesystem::path& file);

/// The feature edges that a file names, by their vertices: those of a .sharp file, or the lines ("l") of an OBJ or
/// elements "edge" of a PLY with as many vertices as the mesh. Throws FileError, also where there are none.
[[nodiscard]] std::vector<std::array<Index, 2>> read_feature_edges(const Faces& F, std::int64_t vertices,
                                                                   const std::filesystem::path& file);

/// The lengths of the edges of an intrinsic surface, for Surface::from_lengths (#E, in the order of the mesh's edges).
/// A text file: for each face the lengths of its first, second and third edge, in the units of the mesh, between
/// blanks, commas or newlines; from # on a line is a comment. Both faces of an edge must agree to 1e-9. Throws
/// FileError, which names the line or the face.
[[nodiscard]] VectorX<double> read_edge_lengths(const std::filesystem::path& file, const Mesh& mesh,
                                                const RunControl& control = {});

/// Writes V (#V x 3) and F (#F x 3) in the format of the extension: .off, .obj or .ply. The file appears complete or
/// not at all; phase "write". Throws MeshError (empty, index out of range, not finite) and FileError (other extension,
/// cannot be written).
void write_mesh(const std::filesystem::path& path, const Positions<double>& V, const Faces& F,
                const RunControl& control = {});

/// Names of the formats that can be read.
[[nodiscard]] std::vector<std::string> mesh_formats();

}  // namespace alcap
