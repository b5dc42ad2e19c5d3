#!/bin/sh
# SPDX-License-Identifier: MIT
#
# make_mesh.sh [N]: writes a closed, bumpy ball of 8 N^2 triangles as OBJ to standard output (default 93: about as many as
# the Stanford bunny). It is an octahedron with N^2 triangles per side, projected to a sphere, with smooth bumps. Needs
# only awk. For examples, and for machines that cannot install a real scan.
set -eu
n=${1:-93}
case $n in
  *[!0-9]* | '' | 0*) echo "make_mesh.sh: N must be a positive whole number, not '$n'" >&2; exit 2 ;;
esac
exec awk -v n="$n" '
  # The number of the vertex at the integer point (x, y, z), |x| + |y| + |z| = n; written when first met.
  function vertex(x, y, z,   key, l, r) {
    x += 0; y += 0; z += 0  # no negative zeros
    key = x "," y "," z
    if (!(key in number)) {
      number[key] = ++count
      l = sqrt(x * x + y * y + z * z)
      x /= l; y /= l; z /= l
      r = 1 + 0.12 * sin(3 * x + 1) * cos(4 * y) + 0.08 * sin(5 * z + 2 * x)
      printf "v %.9g %.9g %.9g\n", r * x, r * y, r * z
    }
    return number[key]
  }
  # Counter-clockwise from outside; mirrored octants turn the other way round.
  function face(a, b, c, mirrored) {
    if (mirrored) print "f", a, c, b
    else print "f", a, b, c
  }
  BEGIN {
    print "# a bumpy ball,", 8 * n * n, "triangles"
    for (sx = -1; sx <= 1; sx += 2) for (sy = -1; sy <= 1; sy += 2) for (sz = -1; sz <= 1; sz += 2) {
      m = sx * sy * sz < 0
      for (i = 0; i < n; ++i) for (j = 0; i + j < n; ++j) {
        k = n - i - j
        a = vertex(sx * i, sy * j, sz * k)
        b = vertex(sx * (i + 1), sy * j, sz * (k - 1))
        c = vertex(sx * i, sy * (j + 1), sz * (k - 1))
        face(a, b, c, m)
        if (k > 1) face(b, vertex(sx * (i + 1), sy * (j + 1), sz * (k - 2)), c, m)
      }
    }
  }'
