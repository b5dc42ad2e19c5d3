// SPDX-License-Identifier: MIT
//
// generators.h: meshes made in code, for tests, benchmarks and examples: spheres, tori, flat pieces, surfaces of higher
// genus, and stand-ins for CAD models and scans. All are oriented manifolds without unreferenced vertices; closed ones
// are oriented outward, flat ones have normal +z. The same arguments give the same mesh on every machine up to the last
// bits of the trigonometric functions. Bad arguments throw OptionError.
//
//   const alcap::MeshData sphere = alcap::icosphere(3);            // 642 vertices, 1280 faces
//   const alcap::Mesh mesh(sphere.F, sphere.V.rows());
#pragma once

#include <cstdint>

#include "alcap/conventions.h"

namespace alcap {

/// Vertices (#V x 3) and triangles (#F x 3).
struct MeshData {
  Positions<double> V;  ///< points
  Faces F;              ///< triangles
};

// ---- one face to twelve

/// One triangle, (0,0,0) (1,0,0) (0,1,0).
[[nodiscard]] MeshData single_triangle();
/// Regular tetrahedron on the unit sphere: 4 vertices, 4 faces.
[[nodiscard]] MeshData tetrahedron();
/// [-1, 1]^3: 8 vertices, 12 faces.
[[nodiscard]] MeshData cube();

// ---- genus 0

/// Icosahedron, `level` midpoint subdivisions, each projected to the unit sphere: 10 4^level + 2 vertices,
/// 20 4^level faces. The vertices of a level come first, with the same numbers, in the next. level in [0, 12].
[[nodiscard]] MeshData icosphere(int level);
/// An icosphere whose vertices are moved tangentially by a random vector in the disk of radius `amount` x mean edge
/// length and projected back to the sphere. Above about 0.25 faces can fold over.
[[nodiscard]] MeshData jittered_sphere(int level, double amount, std::uint64_t seed);
/// An icosphere with radius 1 + amplitude (sin fx + sin fy + sin fz) / 3 at (x, y, z) on the unit sphere.
[[nodiscard]] MeshData bumpy_sphere(int level, double amplitude, double frequency);

// ---- genus 1 and more

/// Torus of radii R > r around the z axis, nu quads around R and nv around r, vertex (i,j) has number i nv + j. Quads
/// are split a-b-c / a-c-d with a=(i,j), b=(i+1,j), c=(i+1,j+1), d=(i,j+1). nu, nv >= 3.
[[nodiscard]] MeshData torus(int nu, int nv, double R, double r);
/// The same torus with each quad split along a random one of its diagonals: valences 4 to 8.
[[nodiscard]] MeshData torus_random_diagonals(int nu, int nv, double R, double r, std::uint64_t seed);
/// A slab with `genus` square holes, made of cubes `resolution` to a slab thickness, smoothed. Closed; genus in
/// [0, 1000], resolution >= 1.
[[nodiscard]] MeshData genus_surface(int genus, int resolution);

/// The unit square with opposite sides glued: intrinsic, it has no embedding in space.
struct FlatTorus {
  std::int64_t vertices = 0;  ///< how many
  Faces F;                    ///< #F x 3
  /// #F x 3: the length of halfedge 3 t + c at (t, c).
  Positions<double> lengths;
};
/// Connectivity and numbering of torus(nu, nv, ...), lengths of the flat unit square.
[[nodiscard]] FlatTorus flat_torus(int nu, int nv);

// ---- with boundary

/// [0, width] x [0, height] in nx x ny quads, vertex (i,j) has number j (nx + 1) + i. One boundary loop.
[[nodiscard]] MeshData grid(int nx, int ny, double width = 1, double height = 1);
/// Unit disk of concentric rings with 6, 12, 18, ... vertices around vertex 0: 1 + 3 rings (rings + 1) vertices.
[[nodiscard]] MeshData disk(int rings);
/// One vertex of valence `count` in a ring of `count` faces on the unit disk. count >= 3.
[[nodiscard]] MeshData fan(int count);
/// Open cylinder around the z axis, nu quads around and nv along; two boundary loops.
[[nodiscard]] MeshData cylinder(int nu, int nv, double radius = 1, double height = 2);

// ---- as they come from outside

/// A stepped shaft as a CAD kernel tessellates it: each cylinder is one quad tall (long slivers), ring-shaped shoulders
/// are strips, the two end disks are fans from one rim vertex. Closed, genus 0; segments >= 3 around, steps >= 1.
[[nodiscard]] MeshData cad_like(int segments, int steps);
/// A bumpy sphere as a scanner leaves it: jittered, a part of the edges flipped, noise of standard size `noise` x mean
/// edge length along the normals, five holes. Level in [3, 12], noise in [0, 0.5].
[[nodiscard]] MeshData noisy_scan(int level, double noise, std::uint64_t seed);

}  // namespace alcap
