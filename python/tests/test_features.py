# SPDX-License-Identifier: MIT
"""Aligned runs in one call, feature files, repairs, edge lengths, hand-offs, transport, matrices, tables, plans."""
import glob
import math
import os
import re
import subprocess
import sys

import numpy as np
import pytest
import scipy.io
import scipy.sparse

import alcap


@pytest.fixture(scope='module')
def tube():
    return alcap.Surface(*alcap.shapes.cylinder(24, 12))


def box(m=4):
    """[0, m]^3 by unit squares, as triangles that share nothing."""
    quads = []
    for axis in range(3):
        for side in (0, m):
            for i in range(m):
                for j in range(m):
                    corners = [[side, a, b] for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))]
                    corners = np.roll(np.array(corners, float), axis, axis=1)
                    quads.append(corners if side else corners[::-1])
    return (np.concatenate(quads),
            np.concatenate([[[4 * k, 4 * k + 1, 4 * k + 2], [4 * k, 4 * k + 2, 4 * k + 3]] for k in range(len(quads))]))


def test_an_aligned_run_in_one_call():
    run = alcap.run_field(*box(), n=4, repairs=['weld'], align=True)
    assert run.holds and run.report['alignment']
    features = run.features
    assert features.followed and len(features.graph.lines) == 12 and len(features.report['lines']) == 12
    assert features.report['all']['worst_degrees'] < 10 and all(piece['settled'] for piece in features.pieces)
    assert run.indices.sum() == 8
    assert alcap.run_field(*box(), n=4, repairs=['weld']).features is None


def test_alignment_has_options(tube):
    across = alcap.smoothest_field(tube, n=2, align=alcap.Alignment(across=True))
    rims = across.features.graph
    measured = alcap.measure_features(across.connection, across.field, rims, across=True)
    assert measured['all']['worst_degrees'] < 1
    along = alcap.smoothest_field(tube, n=2, align=alcap.Alignment(edges=edge_pairs(tube, rims)))
    assert np.array_equal(along.features.graph.edges, rims.edges)
    assert along.features.report['all']['worst_degrees'] < 1
    with pytest.raises(alcap.OptionError) as raised:
        alcap.smoothest_field(tube, n=1, align=True)
    assert raised.value.field == 'n'
    with pytest.raises(alcap.OptionError):
        alcap.smoothest_field(tube, n=4, align=alcap.Alignment(angle=-1))


def edge_pairs(surface, graph):
    return surface.edges[graph.edges]


def test_aligned_runs_in_a_batch(tube):
    runs = alcap.run_batch([tube, alcap.shapes.cylinder(12, 6)], n=4, align=True)
    assert all(run.features.followed for run in runs)
    assert np.array_equal(runs[0].u, alcap.smoothest_field(tube, n=4, align=True).u)


def test_feature_files_round_trip(tmp_path, tube):
    graph = alcap.sharp_edges(tube)
    alcap.write_sharp(tmp_path / 'f.sharp', tube, graph)
    lines = (tmp_path / 'f.sharp').read_text().split()
    assert int(lines[0]) == len(lines) - 1 == len(graph.edges)
    pairs = alcap.read_sharp(tmp_path / 'f.sharp', tube.F)
    assert sorted(alcap.edges_between(tube, pairs).tolist()) == graph.edges.tolist()
    with pytest.raises(alcap.FileError):
        alcap.read_sharp(tmp_path / 'missing.sharp', tube.F)
    with pytest.raises(alcap.OptionError):
        alcap.edges_between(tube, [[0, 0]])
    with pytest.raises(alcap.OptionError):
        alcap.edges_between(tube, [0, 1])


def test_sharp_edges_take_all_options(tube):
    assert len(alcap.sharp_edges(tube, boundary=False).edges) == 0
    assert len(alcap.sharp_edges(tube, boundary=False, angle=math.radians(10)).edges) == 24 * 12
    assert len(alcap.sharp_edges(tube, angle=math.radians(10), creases=False).edges) == 48
    with pytest.raises(alcap.OptionError):
        alcap.sharp_edges(tube, angle=math.radians(20), low_angle=math.radians(30))


def test_repairs_are_reported_in_python():
    V, F = box()
    mesh = alcap.repair_mesh(V, F, ['weld'])
    assert [step['code'] for step in mesh.steps] == ['welded'] and len(mesh.copies_of) == 0 == len(mesh.face_of)
    assert alcap.Surface(mesh.V, mesh.F).euler == 2
    near = V + 1e-7 * np.random.default_rng(1).normal(size=V.shape)
    assert alcap.Surface(*vars_of(alcap.repair_mesh(near, F, ['weld'], weld_tolerance=1e-4))).euler == 2
    doubled = alcap.repair_mesh(mesh.V, np.vstack([mesh.F, mesh.F[:3]]), ['duplicates'])
    assert len(doubled.F) == len(mesh.F) and len(doubled.face_of) == len(mesh.F)
    every = alcap.run_field(V, np.vstack([F, F[:1]]), n=4, repairs=['auto'])
    assert every.holds and len(every.face_of) == len(F)
    assert '::' not in str(every.remarks)
    with pytest.raises(alcap.OptionError, match='auto'):
        alcap.repair_mesh(V, F, ['everything'])


def vars_of(mesh):
    return mesh.V, mesh.F


def test_messages_of_refusals_name_what_python_has():
    V, F = alcap.shapes.icosphere(1)
    cases = [np.vstack([F, F[:1]]), np.vstack([F, [[F[0, 0], F[0, 1], 7]]]),
             np.vstack([F[:3, ::-1], F[3:]])]
    for faces in cases:
        with pytest.raises(alcap.MeshError) as raised:
            alcap.Surface(V, faces)
        assert '::' not in str(raised.value) and '()' not in str(raised.value)


def test_target_edge_lengths_of_a_sphere(tmp_path):
    surface = alcap.Surface(*alcap.shapes.icosphere(4))
    h = alcap.target_edge_lengths(surface, error=0.001, smallest=1e-6, largest=1.0)
    error = 0.001 * np.linalg.norm(np.ptp(surface.V, axis=0))
    assert np.allclose(h, 2 * math.sqrt(error * (2 - error)), rtol=0.05)
    for format in alcap.scalar_formats():
        alcap.write_scalars(tmp_path / f'h.{format}', h)
    assert np.array_equal(np.load(tmp_path / 'h.npy'), h)
    assert np.array_equal(np.genfromtxt(tmp_path / 'h.csv', delimiter=',', names=True)['h'], h)


def test_tables_of_elements_are_numpy_arrays(tmp_path, tube):
    run = alcap.smoothest_field(tube, n=4, normalise=True)
    run.write(tmp_path / 'f.npy', tmp_path / 'f.vertex.npy', tmp_path / 'f.csv', unit=True)
    faces, vertices = np.load(tmp_path / 'f.npy'), np.load(tmp_path / 'f.vertex.npy')
    assert faces.shape == (tube.n_faces, 14) and vertices.shape == (tube.n_vertices, 14)
    assert np.allclose(vertices[:, 3:6], run.vectors(0), atol=1e-12)
    assert np.allclose(np.cross(faces[:, 9:12], faces[:, 3:6]), faces[:, 6:9]) and np.allclose(faces[:, 13], 1)
    names = (tmp_path / 'f.csv').read_text().split('\n', 1)[0].split(',')
    assert names[0] == 'face' and np.array_equal(np.loadtxt(tmp_path / 'f.csv', delimiter=',', skiprows=1)[:, 1:], faces)
    at_faces = alcap.at_faces(run.connection, run.field)
    theta = np.degrees(np.angle(at_faces.u) / 4)
    assert np.allclose((faces[:, 12] - theta + 45) % 90, 45, atol=1e-9)


def test_hand_offs(tmp_path, tube):
    run = alcap.smoothest_field(tube, n=4, align=True)
    files = run.write_for('quadwild', tmp_path / 'tube')
    assert sorted(f.rsplit('.', 1)[1] for f in files) == ['obj', 'rosy', 'sharp', 'txt']
    assert np.array_equal(alcap.read_mesh(tmp_path / 'tube.obj').F, tube.F)
    assert len((tmp_path / 'tube.sharp').read_text().split()) == 1 + 48
    rows = np.loadtxt(tmp_path / 'tube.rosy', skiprows=2)
    assert np.allclose(np.linalg.norm(rows, axis=1), 1)
    alcap.write_for('directional', run.connection, run.field, tmp_path / 'd')
    assert (tmp_path / 'd.rawfield').read_text().startswith(f'4 {tube.n_faces}\n')
    with pytest.raises(alcap.OptionError, match='quadwild'):
        run.write_for('blender', tmp_path / 'x')


def test_transport_along_everything(cross):
    surface, n = cross.connection, 4
    curves = alcap.trace_curves(surface, cross.field, [3], [[0.3, 0.3, 0.4]], sides='forward', max_length=0.5)
    along = alcap.transport_along_curve(surface, curves, 0, 1.0, n)
    assert abs(along.z) == pytest.approx(1)
    first, last = int(curves.offsets[0]), int(curves.offsets[1])
    points = alcap.transport_along_points(surface, curves.faces[first:last], curves.barycentric[first:last], 1.0, n)
    assert np.exp(1j * n * points.turn_from_path) == pytest.approx(np.exp(1j * n * along.turn_from_path), abs=1e-9)
    with pytest.raises(alcap.OptionError):
        alcap.transport_along_curve(surface, curves, 1, 1.0)
    # Around a face a vector turns by its curvature.
    corners = alcap.transport_along_points(surface, [5] * 4, np.vstack([np.eye(3), np.eye(3)[:1]]), 1.0)
    assert corners.turn_from_path + 2 * math.pi == pytest.approx(surface.K[5], abs=1e-12)


def test_matrices_go_to_files(tmp_path, cross):
    S, _ = alcap.energy_matrices(cross.connection, 4)
    alcap.write_matrix(tmp_path / 'S.npz', S)
    assert abs(scipy.sparse.load_npz(tmp_path / 'S.npz') - S).max() == 0
    alcap.write_matrix(tmp_path / 'S.mtx', S)
    assert abs(scipy.io.mmread(tmp_path / 'S.mtx') - S).max() == 0
    alcap.write_matrix(tmp_path / 'S.bin', S, 'petsc')
    assert np.frombuffer((tmp_path / 'S.bin').read_bytes(), '>i4', 4).tolist() == [1211216, *S.shape, S.nnz]
    with pytest.raises(alcap.OptionError, match='mtx'):
        alcap.write_matrix(tmp_path / 'S.bin', S)


def test_modes_of_a_run(bumpy):
    run = alcap.smoothest_field(bumpy, n=4, modes=3)
    values, U, report = run.modes
    S, M = alcap.energy_matrices(run.connection, 4)
    assert values.shape == (3,) and U.shape == (bumpy.n_vertices, 3) and report['converged']
    assert values[0] == pytest.approx(run.eigen[0]['lambda'], rel=1e-7)
    assert np.allclose(U.conj().T @ (M @ U), np.eye(3), atol=1e-8)


def test_the_paper_is_measured():
    result = alcap.tables(levels=(2, 3), fields=5)
    row = next(r for r in result['operators'] if r['level'] == 3 and r['connection'] == 'global' and r['kind'] == 'edge')
    assert row['vertices'] == 642 and 1.5 < row['order']['l2_div'] < 2.5
    euler = [r for r in result['euler'] if r['kind'] == 'basis' and r['connection'] == 'global' and r['surface'] == 'clean']
    assert euler and all(abs(r['mean'] - r['expected']) < 0.5 for r in euler)
    assert 'polar' in result['text']


def test_plans():
    plan = alcap.plan_field(1_000_000, n=4)
    assert plan['fits'] and plan['bytes'] > 1e8 and [p['name'] for p in plan['phases']][0] == 'read'
    assert alcap.plan_field(2_000_000)['seconds'] > plan['seconds']
    assert alcap.plan_field(10**10)['refusals']
    with pytest.raises(alcap.OptionError):
        alcap.plan_field(0)


def needles(turns=100, height=4.0, rings=3):
    """A shaft of long thin triangles with flat ends: its eigenvalues are those of the surface, not of the needles."""
    a = 2 * np.pi * np.arange(turns) / turns
    z = height * np.arange(rings) / (rings - 1)
    rings_of_points = [np.stack([np.cos(a), np.sin(a), np.full(turns, h)], axis=1) for h in z]
    V = np.concatenate(rings_of_points + [[[0, 0, 0], [0, 0, height]]])
    i, j = np.arange(turns), (np.arange(turns) + 1) % turns
    F = [np.stack([turns * r + i, turns * r + j, turns * (r + 1) + j], axis=1) for r in range(rings - 1)]
    F += [np.stack([turns * r + i, turns * (r + 1) + j, turns * (r + 1) + i], axis=1) for r in range(rings - 1)]
    last = turns * (rings - 1)
    F += [np.stack([j, i, np.full(turns, turns * rings)], axis=1),
          np.stack([last + i, last + j, np.full(turns, turns * rings + 1)], axis=1)]
    return V, np.concatenate(F)


def test_intrinsic_triangulations():
    surface = alcap.Surface(*needles())
    flipped = alcap.intrinsic_delaunay(surface)
    assert flipped.before == alcap.triangle_quality(surface) and flipped.after == alcap.triangle_quality(flipped.surface)
    assert flipped.after['not_delaunay'] == flipped.barred and flipped.complete and flipped.added == 0
    assert flipped.surface.area == pytest.approx(surface.area, rel=1e-12)
    assert flipped.surface.n_vertices == flipped.given_vertices == surface.n_vertices
    assert flipped.surface.defects == pytest.approx(surface.defects, abs=1e-9)
    rim = [surface.edge(k, (k + 1) % 100) for k in range(100)]
    refined = alcap.intrinsic_delaunay(surface, keep=rim, min_angle=np.radians(20))
    assert refined.after['angle_min'] >= np.radians(20) * (1 - 1e-9) and refined.added > 0
    assert all({line[0], line[-1]} == {k, (k + 1) % 100} for k, line in enumerate(refined.kept))
    assert not refined.surface.in_space
    with pytest.raises(alcap.OptionError) as raised:
        alcap.intrinsic_delaunay(surface, min_angle=1.0)
    assert raised.value.field == 'min_angle'


def test_values_carry_over_to_intrinsic_triangulations_and_back(bumpy):
    better = alcap.intrinsic_delaunay(bumpy, min_angle=np.radians(15), max_radius=0.1)
    u = np.exp(1j * np.arange(bumpy.n_vertices))
    there = better.from_given(u, 4)
    assert len(there) == better.surface.n_vertices > bumpy.n_vertices and not there[bumpy.n_vertices:].any()
    assert better.to_given(there, 4) == pytest.approx(u, abs=1e-12)
    with pytest.raises(alcap.OptionError):
        better.to_given(u, 4)


def test_runs_on_needles_say_what_they_were_solved_on():
    V, F = needles(400, 40.0, 2)
    run = alcap.run_field(V, F, n=2)
    assert run.holds and run.triangulation['complete']
    assert run.triangulation['after']['angle_min'] > np.radians(14.9) > run.triangulation['before']['angle_min']
    assert run.report['triangulation']
    runs = alcap.run_batch([(V, F)] * 2, n=2, triangulation='extrinsic')
    assert all(r.triangulation is None for r in runs)


def test_a_mollified_surface():
    V, F = alcap.shapes.grid(4, 4, 1.0, 1.0)
    V = V.copy()
    middle = F[5]
    V[middle[2]] = (V[middle[0]] + V[middle[1]]) / 2  # a face without area
    with pytest.raises(alcap.MeshError):
        alcap.Surface(V, F)
    repaired = alcap.repaired_surface(V, F, ['mollify'])
    assert repaired.surface.areas.min() > 0 and np.array_equal(repaired.surface.V, V)
    assert [r['code'] for r in repaired.remarks] == ['mollified']


def test_eigen_designs_hold_directions_and_cross_lines():
    flat = alcap.connect(alcap.Surface(*alcap.shapes.grid(12, 12, 1.0, 1.0)))
    line = alcap.stroke_along_vertices(flat, [6 * 13 + 3, 6 * 13 + 9])
    along = alcap.eigen_design(flat, 2, strokes=[alcap.EigenStroke(line)])
    across = alcap.eigen_design(flat, 2, strokes=[alcap.EigenStroke(line, across=True)])
    middle = 6 * 13 + 6
    turned = np.vdot(along.field.vectors(0)[middle], across.field.vectors(0)[middle])
    size = np.linalg.norm(along.field.vectors(0)[middle]) * np.linalg.norm(across.field.vectors(0)[middle])
    assert abs(turned) < 0.05 * size and along.strokes[0]['met'] and across.strokes[0]['met']
    held = alcap.eigen_design(flat, 1, fixed=[alcap.VertexConstraint(middle, value=1j)])
    assert held.fixed[0]['met'] and abs(np.angle(held.field.u[middle] / 1j)) < 0.01


def test_points_of_curves_make_lines(bumpy):
    run = alcap.smoothest_field(bumpy, n=4)
    curves = alcap.streamlines(run.connection, run.field, spacing=0.05)
    k = max(range(len(curves)), key=curves.length)
    line = alcap.polyline_through(bumpy, *curves.path(k))
    assert curves.complete and line.length == pytest.approx(curves.length(k), rel=1e-9)
    again = alcap.streamlines(run.connection, run.field, spacing=0.05, earlier=curves)
    assert len(set(map(tuple, curves.points)) & set(map(tuple, again.points))) > 0.95 * len(curves.points)
    one = alcap.transport_along_points(run.connection, *curves.path(k), 1.0)
    assert one.z == pytest.approx(alcap.transport_along_curve(run.connection, curves, k, 1.0).z)


def test_the_angle_of_eigenvectors_is_that_of_directions(bumpy):
    connected = alcap.connect(bumpy)
    S, M = alcap.energy_matrices(connected, 4)
    phase = alcap.smallest_eigenpair(S, M, bumpy.area, tolerance=1e-8)[1]
    direction = alcap.smallest_eigenpair(S, M, bumpy.area, tolerance=1e-8, degree=4)[1]
    assert direction['angle'] == pytest.approx(phase['angle'] / 4, rel=1e-6)
    u, report = alcap.smallest_eigenpair(S, M, bumpy.area, degree=4)
    assert report['converged'] and report['angle'] <= 0.01


def test_trivial_connections_say_what_they_were_given():
    donut = alcap.Surface(*alcap.shapes.torus(24, 12, 1.0, 0.4))
    flat = alcap.connect(donut, 'trivial', generator_holonomy=[0.25, 0.5], n=4)
    assert flat.flat and not flat.to_target and flat.generator_holonomy == [0.25, 0.5] and flat.loop_index == []
    assert len(flat.alpha) == 3 * donut.n_faces and len(alcap.connect(donut).alpha) == 0
    assert flat.admits_parallel(4) and not flat.admits_parallel(1)


def test_the_page_about_petsc_runs(source):
    # In a process of its own, which leaves without a word to MPI: PETSc starts and ends that.
    text = open(os.path.join(source, 'docs/python.md')).read()
    block = next(b for b in re.findall(r'^```python\n(.*?)^```', text, re.M | re.S) if 'petsc4py' in b)
    folders = glob.glob('/usr/lib/petscdir/*/*-complex/lib/python3/dist-packages')  # Debian's
    package = os.path.dirname(os.path.dirname(alcap.__file__))
    environment = dict(os.environ, PYTHONPATH=os.pathsep.join([package, *folders]))
    said = subprocess.run([sys.executable, '-c', PETSC_HEAD + block + PETSC_TAIL], capture_output=True, text=True,
                          env=environment, timeout=120)
    if said.returncode == 77:
        pytest.skip('no petsc4py')
    assert said.stdout.split() == ['True', 'True', 'True'], said.stderr


PETSC_HEAD = '''
import os, sys
try:
    import petsc4py
except ImportError:
    os._exit(77)
'''
PETSC_TAIL = '''
bumpy = alcap.Surface(*alcap.shapes.bumpy_sphere(3, 0.3, 4.0))
run = alcap.smoothest_field(bumpy, n=2, solver='petsc4py', method='lanczos')
other = alcap.smoothest_field(bumpy, n=2)
print(run.holds, 'petsc4py' in run.eigen[0]['solver'], abs(run.eigen[0]['lambda'] / other.eigen[0]['lambda'] - 1) < 1e-7)
sys.stdout.flush()
os._exit(0)
'''
