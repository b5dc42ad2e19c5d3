# SPDX-License-Identifier: MIT
"""Fields, connections, matrices: truth on shapes that are known."""
import numpy as np
import pytest
import scipy.sparse.linalg

import alcap


@pytest.mark.parametrize('n', [1, 2, 4])
def test_smallest_eigenvalue_of_the_sphere(n):
    # The connection Laplacian of n-fields on the unit sphere begins with n.
    errors = []
    for level in (3, 4):
        run = alcap.smoothest_field(alcap.Surface(*alcap.shapes.icosphere(level)), n=n)
        assert run.holds
        errors.append(abs(run.eigen[0]['lambda'] - n) / n)
    assert errors[1] < 0.01
    assert 3 < errors[0] / errors[1] < 5  # second order


def test_scipy_agrees_on_the_eigenvalue(cross):
    S, M = alcap.energy_matrices(cross.connection, n=4)
    values = scipy.sparse.linalg.eigsh(S, k=2, M=M, sigma=-0.1, which='LM', return_eigenvectors=False)
    assert np.min(values) == pytest.approx(cross.eigen[0]['lambda'], rel=1e-7)
    u, report = alcap.smallest_eigenpair(S, M, cross.surface.area)
    assert report['converged']
    assert report['lambda'] == pytest.approx(np.min(values), rel=1e-7)
    assert np.vdot(u, M @ u).real == pytest.approx(1, rel=1e-10)
    assert report['smallest'] == 'proven'
    assert alcap.inertia(S, M, report['lower_bound']) == 0
    modes, U, said = alcap.eigenpairs(S, M, cross.surface.area, 2)
    assert modes == pytest.approx(np.sort(values), rel=1e-6)
    assert said['smallest'] == 'proven'
    assert abs(U.conj().T @ (M @ U) - np.eye(2)).max() < 1e-8


@pytest.mark.parametrize('n', [1, 4])
def test_matrices_are_hermitian_and_positive(bumpy, n):
    S, M = alcap.energy_matrices(alcap.connect(bumpy), n)
    assert S.dtype == M.dtype == np.complex128
    assert abs(S - S.getH()).max() < 1e-12 * abs(S).max()
    assert abs(M - M.getH()).max() < 1e-12 * abs(M).max()
    rng = np.random.default_rng(1)
    for _ in range(5):
        u = rng.normal(size=S.shape[0]) + 1j * rng.normal(size=S.shape[0])
        assert np.vdot(u, S @ u).real > 0 and np.vdot(u, M @ u).real > 0


def test_mass_of_a_parallel_field_is_the_area():
    plane = alcap.connect(alcap.Surface(*alcap.shapes.grid(6, 5, 2.0, 1.5)), 'global')
    S, M = alcap.energy_matrices(plane, 1)
    field = alcap.Field.from_vectors(1, np.tile([1.0, 0.0, 0.0], (plane.n_vertices, 1)), plane.frames)
    assert np.vdot(field.u, M @ field.u).real == pytest.approx(3.0, rel=1e-9)
    assert abs(np.vdot(field.u, S @ field.u)) < 1e-12
    P, Q = alcap.first_order_operators(plane, 1)
    assert P.shape == (plane.n_faces, plane.n_vertices)
    assert abs(P @ field.u).max() < 1e-12 and abs(Q @ field.u).max() < 1e-12


def test_divergence_of_the_position_field_of_a_plane():
    plane = alcap.connect(alcap.Surface(*alcap.shapes.grid(6, 5, 2.0, 1.5)))
    field = alcap.Field.from_vectors(1, plane.V, plane.frames)  # x in the plane: div 2, curl 0
    P, _ = alcap.first_order_operators(plane, 1)
    assert np.allclose(P @ field.u, 2 * plane.areas, atol=1e-12)
    energies = alcap.field_energies(plane, field)
    assert energies.antiholomorphic == pytest.approx(0.5 * 4 * plane.area, rel=1e-9)
    assert energies.holomorphic == pytest.approx(0, abs=1e-12)
    value, d1, d2 = alcap.field_value(plane, field, 3, (0.2, 0.3, 0.5))
    assert abs(d1 - 1) < 1e-12 and abs(d2 - 1j) < 1e-12


@pytest.mark.parametrize('shape, euler', [(alcap.shapes.icosphere(2), 2), (alcap.shapes.torus(16, 8), 0),
                                          (alcap.shapes.genus_surface(2, 2), -2)])
@pytest.mark.parametrize('n', [1, 4])
def test_indices_sum_to_the_euler_characteristic(shape, euler, n):
    surface = alcap.Surface(*shape)
    assert surface.euler == euler
    run = alcap.smoothest_field(surface, n=n)
    assert run.indices.sum() == n * euler
    assert run.singularities['index'].sum() == n * euler
    assert run.index_sums == [(n * euler, n * euler)]


@pytest.mark.parametrize('kind', ['global', 'local', 'polar', 'polar-barycenter'])
def test_curvature_sums_to_the_euler_characteristic(bumpy, kind):
    connection = alcap.connect(bumpy, kind)
    assert connection.kind == kind.split('-')[0]
    assert connection.K.sum() == pytest.approx(4 * np.pi, rel=1e-9)
    h = np.arange(3 * bumpy.n_faces)
    tau = connection.tau.reshape(-1, 3).sum(axis=1)
    assert np.allclose(connection.K, -tau)
    assert connection.rho_along(int(h[5])) == pytest.approx(-connection.rho_along(int(bumpy.twins[5])))


def test_cones_carry_all_curvature(bumpy):
    cones = alcap.balance_cones(bumpy, [(0, 0.25)], n=4)
    assert cones[0] == (0, 0.25) and sum(index for _, index in cones) == pytest.approx(2)
    connection = alcap.connect(bumpy, 'trivial', cones=cones, n=4)
    assert connection.cones == cones
    away = ~np.isin(bumpy.F, [v for v, _ in cones]).any(axis=1)
    assert np.abs(connection.K[away]).max() < 1e-8


def test_detail_spreads_curvature(bumpy):
    sharp, soft = (alcap.connect(bumpy, detail=d).K / bumpy.areas for d in (1.0, 0.01))
    assert np.ptp(soft) < 0.8 * np.ptp(sharp)


def test_vectors_are_tangent_and_branches_turn(cross):
    frames = cross.frames
    first, second = cross.vectors(0), cross.vectors(1)
    assert np.abs(np.einsum('ij,ij->i', first, frames.N)).max() < 1e-12
    assert np.abs(np.einsum('ij,ij->i', first, second)).max() < 1e-12
    assert np.allclose(frames.components(first) ** 4, cross.u)
    assert np.allclose(cross.field.raw()[:, 3:6], second)
    assert np.allclose(np.abs(cross.field.normalised().u), 1)


def test_at_faces_and_back(bumpy):
    run = alcap.smoothest_field(bumpy, n=2)
    faces = alcap.at_faces(run.connection, run.field)
    assert len(faces) == bumpy.n_faces
    back = alcap.at_vertices(run.connection, faces)
    norm = np.sqrt((np.abs(run.u) ** 2).mean())
    assert np.sqrt((np.abs(back.u - run.u) ** 2).mean()) < 0.1 * norm


def test_holonomy_of_transport_around_a_vertex_is_its_curvature(bumpy):
    connection = alcap.connect(bumpy, 'polar')
    F = bumpy.F[7]
    around = alcap.transport(connection, [F[0], F[1], F[2], F[0]], 1.0)
    assert np.angle(around.z) == pytest.approx(connection.K[7], abs=1e-12)


def test_numbers_of_threads_do_not_matter(bumpy):
    one, all_of_them = (alcap.smoothest_field(bumpy, n=4, threads=t) for t in (1, 0))
    assert np.array_equal(one.u, all_of_them.u)


def test_batch_gives_the_same_bits(bumpy, cross):
    runs = alcap.run_batch([bumpy, (bumpy.V, bumpy.F)] * 3, n=4)
    assert all(np.array_equal(run.u, cross.u) for run in runs)


def test_batch_reports_what_fails(bumpy):
    bad = (np.zeros((3, 3)), [[0, 1, 2]])
    first, second = alcap.run_batch([bad, bumpy], n=4, errors='return')
    assert isinstance(first, alcap.MeshError) and second.holds
    with pytest.raises(alcap.MeshError):
        alcap.run_batch([bumpy, bad], n=4)


def test_factorised_solves(bumpy):
    S, M = alcap.energy_matrices(alcap.connect(bumpy), 2)
    A = S + M
    rng = np.random.default_rng(2)
    x = rng.normal(size=(A.shape[0], 3)) + 1j * rng.normal(size=(A.shape[0], 3))
    for solver in alcap.linear_solvers():
        factorised = alcap.factorise(A, solver)
        assert np.allclose(factorised.solve(A @ x), x, atol=1e-7), solver
        assert np.allclose(factorised.solve(A @ x[:, 0]), x[:, 0], atol=1e-7)
        assert factorised.report['residual'] < 1e-8


def test_curvature_follows_a_cylinder():
    surface = alcap.connect(alcap.Surface(*alcap.shapes.cylinder(40, 20)))
    field = alcap.curvature_field(surface, 2)
    inner = ~surface.boundary_vertices
    along = np.abs(field.vectors(0)[inner] @ [0, 0, 1])  # curvature is largest around, not along
    assert (along < 0.2 * np.linalg.norm(field.vectors(0)[inner], axis=1)).all()


def test_sharp_edges_of_a_cube():
    surface = alcap.Surface(*alcap.shapes.cube())
    graph = alcap.sharp_edges(surface)
    assert len(graph.edges) == 12 and np.allclose(graph.angles, np.pi / 2)
    assert graph.vertices.count('corner') == 8 and len(graph.lines) == 12
    assert np.allclose(alcap.dihedral_angles(surface)[graph.edges], np.pi / 2)


def test_an_intrinsic_surface():
    V, F = alcap.shapes.torus(8, 6)
    surface = alcap.Surface(V, F)
    intrinsic = alcap.Surface.from_lengths(F, len(V), surface.lengths)
    assert not intrinsic.in_space and np.allclose(intrinsic.areas, surface.areas)
    run = alcap.smoothest_field(intrinsic, n=4)
    assert run.frames is None and run.holds
    assert run.eigen[0]['lambda'] == pytest.approx(alcap.smoothest_field(surface, n=4).eigen[0]['lambda'], rel=1e-6)


def test_a_metric_connection_has_the_curvature_that_was_asked_for(bumpy):
    K = np.full(bumpy.n_faces, 4 * np.pi / bumpy.n_faces)
    assert np.allclose(alcap.connect(bumpy, 'metric', target={'face_curvature': K}).K, K, atol=1e-8)
    cone = alcap.connect(bumpy, 'metric', cones=[(0, 0.7), (200, 1.3)])
    away = ~np.isin(bumpy.F, [0, 200]).any(axis=1)
    assert np.abs(cone.K[away]).max() < 1e-8 and cone.admits_parallel(10) and not cone.admits_parallel(1)
    with pytest.raises(alcap.OptionError):
        alcap.connect(bumpy, 'metric', target={'face_curvature': 2 * K})


def test_values_along_an_edge_are_those_of_both_ends(bumpy, cross):
    h = 17
    for s, vertex in ((0.0, bumpy.F.ravel()[h]), (1.0, bumpy.F[h // 3, (h % 3 + 1) % 3])):
        value, along = alcap.edge_value(cross.connection, cross.field, h, s)
        assert abs(value) == pytest.approx(abs(cross.u[vertex]), rel=1e-12) and np.isfinite(along)
