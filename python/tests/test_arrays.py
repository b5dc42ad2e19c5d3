# SPDX-License-Identifier: MIT
"""Arrays: what is shared, who keeps whom alive, which types and orders are taken."""
import gc
import sys
import weakref

import numpy as np
import pytest

import alcap


def test_surface_shares_its_memory(sphere):
    assert np.shares_memory(sphere.V, sphere.V) and np.shares_memory(sphere.F, sphere.F)
    assert not sphere.V.flags.writeable
    with pytest.raises(ValueError):
        sphere.V[0, 0] = 1


def test_arrays_keep_their_owners_alive():
    surface = alcap.Surface(*alcap.shapes.icosphere(3))
    run = alcap.smoothest_field(surface, n=4)
    V, u, K, X = surface.V, run.u, run.connection.K, run.frames.X
    singular = run.singularities
    copies = [np.array(a) for a in (V, u, K, X, singular)]
    del surface, run
    gc.collect()
    trash = [alcap.Surface(*alcap.shapes.icosphere(3)) for _ in range(3)]  # reuse what was freed
    for a, b in zip((V, u, K, X, singular), copies):
        assert np.array_equal(a, b)
    assert trash


def test_nothing_stays_behind(sphere):
    before = sys.getrefcount(None)
    callback = lambda phase, fraction: None  # noqa: E731
    alive = weakref.ref(callback)
    for _ in range(20):
        run = alcap.smoothest_field(sphere, n=2, progress=callback)
        assert run.u is not None and run.report
    designer = alcap.Designer(run.connection, n=1, progress=callback)
    designer.add(alcap.SingularityTarget(face=3))
    del run, designer, callback
    gc.collect()
    assert alive() is None
    assert abs(sys.getrefcount(None) - before) < 50


def test_memory_comes_back():
    def resident():
        with open('/proc/self/statm') as file:
            return int(file.read().split()[1]) * 4096
    shape = alcap.shapes.icosphere(5)

    def work():
        surface = alcap.Surface(*shape)
        S, M = alcap.energy_matrices(alcap.connect(surface, 'polar'), 4)
        return S.nnz + M.nnz
    for _ in range(5):
        work()
    before = resident()
    for _ in range(30):  # 30 times 5 MB of matrices
        work()
    assert resident() - before < 60e6


@pytest.mark.parametrize('order', ['C', 'F'])
@pytest.mark.parametrize('real', [np.float32, np.float64, '>f8'])
@pytest.mark.parametrize('integer', [np.int32, np.int64, np.uint32, np.uint64, np.int16])
def test_types_and_orders(order, real, integer):
    V, F = alcap.shapes.icosphere(1)
    surface = alcap.Surface(np.asarray(V, dtype=real, order=order), np.asarray(F, dtype=integer, order=order))
    assert np.array_equal(surface.F, F)
    assert np.allclose(surface.V, V, atol=1e-7)


def test_views_and_lists():
    V, F = alcap.shapes.icosphere(1)
    wide = np.zeros((2 * len(V), 6))
    wide[::2, ::2] = V
    assert np.array_equal(alcap.Surface(wide[::2, ::2], F[::-1]).V, V)
    assert np.array_equal(alcap.Surface(V.tolist(), F.tolist()).V, V)
    assert np.array_equal(alcap.Surface(V[::-1], len(V) - 1 - F).V, V[::-1])


def test_input_is_not_changed_and_not_kept():
    V, F = alcap.shapes.icosphere(1)
    V, F = V.copy(), F.copy()
    surface = alcap.Surface(V, F)
    before = surface.V.copy()
    V[:] = 0
    F[:] = 0
    assert np.array_equal(surface.V, before) and surface.F.max() > 0


def test_matrices_are_not_copied(sphere):
    S, _ = alcap.energy_matrices(alcap.connect(sphere), 1)
    assert S.data.base is not None and S.indices.base is not None  # over the library's memory
    S.data *= 2  # and ours to change


@pytest.mark.parametrize('V, F', [
    (np.zeros((3, 2)), [[0, 1, 2]]), (np.zeros(9), [[0, 1, 2]]), (np.zeros((3, 3), complex), [[0, 1, 2]]),
    (np.eye(3), [[0.0, 1.0, 2.0]]), (np.eye(3), [0, 1, 2]), (np.eye(3), np.zeros((1, 4), int)), ('no', [[0, 1, 2]]),
    (np.eye(3), None)])
def test_wrong_arrays_are_refused(V, F):
    with pytest.raises(ValueError) as raised:
        alcap.Surface(V, F)
    assert isinstance(raised.value, alcap.Error)
