# SPDX-License-Identifier: MIT
"""Errors name the elements, as attributes; messages speak Python."""
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
