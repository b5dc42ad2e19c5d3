#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What scripts/accuracy.py measures with: closed meshes, and salience that is largest where curvature is."""
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / 'scripts'))
import accuracy  # noqa: E402


class Accuracy(unittest.TestCase):
    def test_polycubes_are_closed_and_oriented(self):
        for name, cells in accuracy.CAD.items():
            with self.subTest(name):
                points, faces = accuracy.polycube(cells, 3)
                edges = {}
                for f in faces:
                    for k in range(3):
                        edge = (f[k], f[(k + 1) % 3])
                        self.assertNotIn(edge, edges)
                        edges[edge] = True
                for a, b in edges:
                    self.assertIn((b, a), edges)
                volume = sum(self.det(*(points[v] for v in f)) for f in faces) / 6
                self.assertAlmostEqual(volume, len(cells))

    def test_corners_of_a_cube_are_the_most_salient(self):
        points, faces = accuracy.polycube([(0, 0, 0)], 8)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / 'cube.obj'
            accuracy.write_obj(path, points, faces)
            self.assertEqual(accuracy.read_obj(path)[1], [list(f) for f in faces])
            salience = accuracy.Salience(path)
        corners = [v for v, p in enumerate(points) if all(x in (0, 1) for x in p)]
        others = [v for v in range(len(points)) if v not in corners]
        self.assertEqual(len(corners), 8)
        self.assertGreater(min(salience.rank[v] for v in corners), 90)
        self.assertGreater(min(salience.rank[v] for v in corners), max(salience.rank[v] for v in others))

    @staticmethod
    def det(a, b, c):
        return (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
                + a[2] * (b[0] * c[1] - b[1] * c[0]))


if __name__ == '__main__':
    unittest.main()
