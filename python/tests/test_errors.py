# SPDX-License-Identifier: MIT
"""Errors name the elements, as attributes; messages speak Python."""
import dataclasses

import numpy as np
import pytest

import alcap

V, F = alcap.shapes.icosphere(1)


def test_mesh_error_names_faces():
    with pytest.raises(alcap.MeshError) as raised:
        alcap.Surface(V, np.vstack([F, [[0, 1, 400]]]))
    assert raised.value.defect == 'index_out_of_range' and raised.value.faces == [len(F)]
    assert raised.value.vertices == [] and raised.value.edges == []
    assert isinstance(raised.value, ValueError)


def test_mesh_error_names_edges():
    with pytest.raises(alcap.MeshError) as raised:
        alcap.Surface(np.vstack([V, [[5, 5, 5]]]), np.vstack([F, [[F[0, 0], F[0, 1], len(V)]]]))
    assert raised.value.defect == 'non_manifold_edge'
    assert {tuple(sorted(e)) for e in raised.value.edges} == {tuple(sorted(F[0, :2].tolist()))}


def test_messages_speak_python():
    soup_V, soup_F = V[F].reshape(-1, 3), np.arange(3 * len(F)).reshape(-1, 3)
    run = alcap.run_field(soup_V, soup_F, n=1, repairs=['weld'])
    assert run.holds and run.report['options']['repairs'] == ['weld']
    assert '::' not in str(run.report)
    S, M = alcap.energy_matrices(alcap.connect(alcap.Surface(V, F)), 1)
    _, report = alcap.smallest_eigenpair(S, M, 12.0, method='lanczos', max_iterations=1, tolerance=1e-14)
    assert not report['converged'] and 'max_iterations' in report['message'] and '::' not in str(report)


def test_option_error():
    with pytest.raises(alcap.OptionError) as raised:
        alcap.smoothest_field(alcap.Surface(V, F), n=0)
    assert raised.value.field == 'n' and raised.value.value == '0' and raised.value.rule
    with pytest.raises(alcap.OptionError, match='polar'):
        alcap.connect(alcap.Surface(V, F), 'spherical')
    with pytest.raises(TypeError, match='tolerence'):
        alcap.smoothest_field(alcap.Surface(V, F), tolerence=1e-3)
    with pytest.raises(alcap.OptionError, match='solver'):
        alcap.smoothest_field(alcap.Surface(V, F), solver='none')


def test_file_errors(tmp_path):
    with pytest.raises(OSError) as raised:
        alcap.read_mesh(tmp_path / 'missing.obj')
    assert raised.value.path.endswith('missing.obj')
    (tmp_path / 'bad.obj').write_text('v 0 0 0\nv 1 0 x\n')
    with pytest.raises(alcap.FileError) as raised:
        alcap.read_mesh(tmp_path / 'bad.obj')
    assert raised.value.line == 2


def test_defects_are_listed():
    assert alcap.find_defects(V, F) == []
    found = alcap.find_defects(V, np.vstack([F, F[:1]]))
    assert found[0]['defect'] == 'duplicate_face'
    turned = F.copy()
    turned[3] = turned[3][::-1]
    assert alcap.find_defects(V, turned)[0]['defect'] == 'inconsistent_orientation'
    assert alcap.find_defects(V, alcap.repair_orientation(turned)) == []


def test_out_of_range_numbers_are_refused():
    surface = alcap.connect(alcap.Surface(V, F))
    field = alcap.smoothest_field(alcap.Surface(V, F)).field
    for call in (lambda: surface.rho_along(-1), lambda: alcap.field_value(surface, field, 10**6, (1, 0, 0)),
                 lambda: alcap.transport(surface, [0, 10**6], 1), lambda: field.vectors(4),
                 lambda: alcap.shortest_path(surface, 0, 10**6), lambda: alcap.Field(1, np.zeros(3), surface.frames),
                 lambda: alcap.root_mean_square(surface, np.zeros(3))):
        with pytest.raises(alcap.OptionError):
            call()
    with pytest.raises(IndexError):
        alcap.streamlines(surface, field)[10**6]


def test_values_of_the_wrong_type_are_named():
    surface = alcap.connect(alcap.Surface(V, F))
    run = alcap.smoothest_field(alcap.Surface(V, F))
    for name, value, call in (
            ('n', '4.5', lambda: alcap.run_field(V, F, n=4.5)),
            ('n', str(2**40), lambda: alcap.run_field(V, F, n=2**40)),
            ('min_angle', "'wide'", lambda: alcap.run_field(V, F, min_angle='wide')),
            ('max_points', '1.5', lambda: alcap.streamlines(surface, run.field, max_points=1.5)),
            ('spacing', 'None', lambda: alcap.streamlines(surface, run.field, spacing=None)),
            ('detail', "'fine'", lambda: alcap.connect(alcap.Surface(V, F), detail='fine')),
            ('seed', '-1', lambda: alcap.smoothest_field(alcap.Surface(V, F), seed=-1)),
            ('sign', '0.5', lambda: alcap.Designer(surface, n=1).add(alcap.SingularityTarget(0, 0.5)))):
        with pytest.raises(alcap.OptionError) as raised:
            call()
        assert (raised.value.field, raised.value.value) == (name, value)
        assert 'must be' in raised.value.rule


def test_wide_indices_of_matrices_do_not_wrap():
    import scipy.sparse
    one = scipy.sparse.identity(3, format='csc', dtype=complex)
    wide = scipy.sparse.csc_matrix((one.data, one.indices.astype(np.int64), one.indptr.astype(np.int64)))
    wide.indices = wide.indices.astype(np.int64)
    wide.indptr = wide.indptr.astype(np.int64)
    assert np.allclose(alcap.factorise(wide).solve(np.ones(3)), 1)
    wide.indices = wide.indices + 2**32  # the same in 32 bits
    with pytest.raises(alcap.OptionError, match='32 bits'):
        alcap.factorise(wide)


def refused(cases):
    """Calls each of (field, value, part of the rule, call): an OptionError that says all three."""
    for field, value, rule, call in cases:
        with pytest.raises(alcap.OptionError) as raised:
            call()
        error = raised.value
        assert (error.field, error.value) == (field, value), str(error)
        assert rule in error.rule and field in str(error) and value in str(error)


def test_arrays_of_the_wrong_shape_or_type_are_named():
    ring = alcap.Surface(V, F)
    surface, frames = alcap.connect(ring), alcap.connect(ring).frames
    refused((
        ('V', "<class 'list'>", 'array of numbers', lambda: alcap.Surface([[0, 1, 2], [3]], F)),
        ('V', 'array of shape (42, 2) of float64', '(#V, 3)', lambda: alcap.Surface(V[:, :2], F)),
        ('V', 'array of shape (42, 3) of complex128', 'real numbers', lambda: alcap.Surface(V * 1j, F)),
        ('F', 'array of shape (80, 2) of int32', '(#F, 3)', lambda: alcap.Surface(V, F[:, :2])),
        ('F', 'array of shape (80, 3) of float64', 'integers', lambda: alcap.Surface(V, F.astype(float))),
        ('u', 'array of shape (1) of <U1', 'wrong type', lambda: alcap.Field(1, np.array(['a']), frames)),
        ('u', 'array of shape (5) of float64', 'shape (42,)', lambda: alcap.Field(1, np.zeros(5), frames)),
        ('vertices', 'array of shape (1, 2) of int64', 'one dimension',
         lambda: alcap.stroke_along_vertices(ring, np.zeros((1, 2), dtype=np.int64))),
        ('pairs', "<class 'list'>", '(k, 2)', lambda: alcap.edges_between(ring, [1, 2, 3])),
        ('barycentric', '2', 'row per face', lambda: alcap.polyline_through(ring, [0], [[1, 0, 0], [0, 1, 0]])),
        ('N', '3', 'as many rows as X', lambda: alcap.Frames(np.zeros((2, 3)), np.zeros((3, 3)))),
        ('w', '2', 'row per frame', lambda: surface.frames.components(np.zeros((2, 3)))),
    ))


def test_values_that_mean_nothing_are_named():
    ring = alcap.Surface(V, F)
    surface = alcap.connect(ring)
    field = alcap.smoothest_field(ring).field
    curves = alcap.streamlines(surface, field)
    many = str(len(curves))
    peaks = dataclasses.replace(alcap.sharp_edges(ring), vertices=['peak'])
    refused((
        ('n', '0', 'at least 1', lambda: alcap.Field(0, field.u, surface.frames)),
        ('s', '2', '[0, 1]', lambda: alcap.edge_value(surface, field, 0, 2)),
        ('face', '-1', 'must be a face', lambda: alcap.field_value(surface, field, -1, (1, 0, 0))),
        ('h', '-1', 'must be a halfedge', lambda: surface.rho_along(-1)),
        ('k', many, 'must be a curve', lambda: alcap.transport_along_curve(surface, curves, len(curves), 1)),
        ('vertices', 'peak', 'not a kind of vertex', lambda: alcap.write_sharp('none.sharp', ring, peaks)),
        ('target', 'speed', 'must be one of', lambda: alcap.connect(ring, 'metric', target={'speed': np.zeros(42)})),
        ('connection', 'flat', 'must be one of', lambda: alcap.connect(ring, 'flat')),
        ('length_factor', 'wide', 'must be one of', lambda: alcap.connect(ring, length_factor='wide')),
        ('spacings', '1', 'not an option of curves', lambda: alcap.streamlines(surface, field, spacings=1)),
        ('prove_smallest', 'perhaps', "'always'", lambda: alcap.smoothest_field(ring, prove_smallest='perhaps')),
        ('control', 'round', 'SingularityTarget', lambda: alcap.Designer(surface, n=1).add('round')),
    ))
    for call in (lambda: curves[len(curves)], lambda: curves.length(len(curves))):
        with pytest.raises(IndexError):
            call()


def test_matrices_that_are_none_are_named(tmp_path):
    import scipy.sparse
    one = scipy.sparse.identity(3, format='csc', dtype=complex)

    def of(indices, indptr):
        return lambda: alcap._alcap.factorise((one.data, np.array(indices), np.array(indptr)), 'auto', 0, 1e-9, 9)
    refused((
        ('A', '3 x 4', 'square', lambda: alcap.factorise(scipy.sparse.eye(3, 4))),
        ('A', '4 x 3', 'square', lambda: alcap.write_matrix(tmp_path / 'A.npz', scipy.sparse.eye(4, 3))),
        ('A', '3 entries', 'compressed', of([0, 1, 2], [0, 1, 2, 4])),
        ('A', '1', 'ends before it starts', of([0, 1, 2], [0, 2, 1, 3])),
        ('A', '7', 'not a row', of([0, 1, 7], [0, 1, 2, 3])),
        ('B', '5', 'row per row', lambda: alcap.factorise(one).solve(np.ones(5))),
        ('M', '2', 'rows', lambda: alcap.smallest_eigenpair(one, scipy.sparse.identity(2, format='csc'), 1.0)),
    ))
