# SPDX-License-Identifier: MIT
"""Files, curves, pictures, pages, and solvers written in Python."""
import os
import re
import subprocess
import sys
import types

import numpy as np
import pytest
import scipy.sparse
import scipy.sparse.linalg

import alcap


@pytest.mark.parametrize('format', ['off', 'obj', 'ply'])
def test_meshes_round_trip(tmp_path, bumpy, format):
    path = tmp_path / f'mesh.{format}'
    alcap.write_mesh(path, bumpy.V, bumpy.F)
    mesh = alcap.read_mesh(path)
    assert mesh.format == format and np.array_equal(mesh.F, bumpy.F) and np.array_equal(mesh.V, bumpy.V)
    assert np.array_equal(alcap.read_mesh_from_memory(path.read_bytes()).F, bumpy.F)


def test_fields_round_trip(tmp_path, cross):
    files = [tmp_path / f'field.{format}' for format in alcap.field_formats()]
    written = cross.write(*files, face_scalars={'area': cross.surface.areas})
    assert all(os.path.getsize(f) > 0 for f in written)
    back = alcap.read_field(tmp_path / 'field.ply')
    assert np.array_equal(back.field.u, cross.u) and np.array_equal(back.field.frames.X, cross.frames.X)
    assert back.connection == 'global' and back.field.n == 4
    assert 'area' in (tmp_path / 'field.vtp').read_bytes().decode('latin-1')


def test_curves_lie_on_the_surface_and_follow_the_field(tmp_path, cross):
    curves = alcap.streamlines(cross.connection, cross.field, spacing=0.05)
    assert len(curves) > 5 and curves.offsets[-1] == len(curves.points) == len(curves.faces)
    V, F = cross.surface.V, cross.surface.F
    corners = V[F[curves.faces]]
    assert np.allclose((curves.barycentric[:, :, None] * corners).sum(axis=1), curves.points, atol=1e-9)
    assert curves.length(0) == pytest.approx(np.linalg.norm(np.diff(curves[0], axis=0), axis=1).sum(), rel=1e-9)
    traced = alcap.trace_curves(cross.connection, cross.field, [3], [[0.3, 0.3, 0.4]], sides='forward', max_length=0.2)
    assert len(traced) == 1 and traced.start_reasons == ['seed']
    rays = alcap.separatrices(cross.connection, cross.field, max_length=0.1)
    expected = sum(4 - int(k) for k in cross.singularities['index'])
    assert len(rays) == expected
    for format in alcap.curve_formats():
        alcap.write_curves(curves, 4, tmp_path / f'curves.{format}')


def test_positions_of_singularities(cross):
    found = cross.singularities
    points = alcap.singularity_positions(cross.surface, found)
    V, F = cross.surface.V, cross.surface.F
    assert np.allclose(points, (found['barycentric'][:, :, None] * V[F[found['face']]]).sum(axis=1))


def test_the_report_is_that_of_the_command_line(cross, source):
    keys = set(re.findall(r'`(?:field\.)?([a-z_]+)[.\[`]', open(os.path.join(source, 'docs/report.md')).read()))
    report = cross.report
    assert report['input'] is None and report['ok'] is True and report['version'] == alcap.__version__
    assert set(report) <= keys
    assert report['singularities']['count'] == len(cross.singularities)
    assert report['eigen']['lambda'] == cross.eigen[0]['lambda']


def test_notebooks_show_something(cross):
    shown = cross._repr_html_()
    assert shown.startswith(('<iframe', '<table')) and 'script>' not in re.sub(r'srcdoc="[^"]*"', '', shown)
    assert 'singularities' in repr(cross)


def test_plot_without_a_display_in_the_colours_of_the_page(cross, tmp_path, source):
    pytest.importorskip('matplotlib')
    style = open(os.path.join(source, 'apps/viewer/style.css')).read()
    figure = cross.plot()
    figure.savefig(tmp_path / 'field.png')
    figure.canvas.draw()
    pixels = np.asarray(figure.canvas.buffer_rgba())[..., :3].astype(int)

    def share(name, off=12):
        """Of the pixels that have this colour, thin lines nearly so."""
        code = re.search(rf'--{name}: #(\w{{6}})', style).group(1)
        colour = [int(code[k:k + 2], 16) for k in (0, 2, 4)]
        return (abs(pixels - colour).max(axis=-1) < off).mean()
    assert share('canvas') > 0.05 and share('ink', 60) > 0.005 and share('positive') > 1e-4
    assert (pixels[..., 0] > pixels[..., 2] + 8).mean() > 0.2  # clay is warm
    assert (tmp_path / 'field.png').stat().st_size > 10000


def test_adapters_say_what_to_install(cross, monkeypatch):
    for name in ('trimesh', 'pyvista', 'polyscope'):
        monkeypatch.setitem(sys.modules, name, None)
        with pytest.raises(ImportError, match=f'pip install {name}'):
            getattr(cross, f'to_{name}')()


def test_trimesh_gets_the_field(cross, monkeypatch):
    class Trimesh:
        def __init__(self, V, F, process):
            assert process is False
            self.V, self.F, self.vertex_attributes = V, F, {}
    monkeypatch.setitem(sys.modules, 'trimesh', types.SimpleNamespace(Trimesh=Trimesh))
    mesh = cross.to_trimesh()
    assert np.array_equal(mesh.vertex_attributes['branch1'], cross.vectors(1))


def test_a_linear_solver_of_scipy(bumpy, cross):
    seen = []

    def factory(A):
        seen.append(A.dtype)
        return scipy.sparse.linalg.splu(A)
    with alcap.register_linear_solver('splu', factory):
        assert 'splu' in alcap.linear_solvers()
        run = alcap.smoothest_field(bumpy, n=4, solver='splu', method='lanczos')
        assert run.holds and 'splu' in run.eigen[0]['solver']
        assert run.eigen[0]['lambda'] == pytest.approx(cross.eigen[0]['lambda'], rel=1e-7)
    assert np.dtype(complex) in seen
    assert 'splu' not in alcap.linear_solvers()


def test_an_eigensolver_of_scipy(bumpy, cross):
    def eigsh(S, M, area, options):
        assert options['tolerance'] > 0 and area == pytest.approx(bumpy.area)
        return scipy.sparse.linalg.eigsh(S, k=1, M=M, sigma=-1 / area, which='LM')[1][:, 0]
    with alcap.register_eigen_solver('eigsh', eigsh):
        run = alcap.smoothest_field(bumpy, n=4, method='eigsh')
    assert run.holds and run.eigen[0]['lambda'] == pytest.approx(cross.eigen[0]['lambda'], rel=1e-7)


def test_errors_of_solvers_in_python_arrive(bumpy):
    def broken(A):
        raise ZeroDivisionError('mine')
    with alcap.register_linear_solver('broken', broken):
        with pytest.raises(ZeroDivisionError, match='mine'):
            alcap.smoothest_field(bumpy, n=4, solver='broken', method='lanczos')
    with alcap.register_linear_solver('short', lambda A: lambda B: B[:-1]):
        with pytest.raises(alcap.SolveError, match='size'):
            alcap.smoothest_field(bumpy, n=4, solver='short', method='lanczos')


def test_a_registration_that_is_left_open_does_not_keep_the_interpreter_from_ending():
    code = 'import alcap; r = alcap.register_linear_solver("x", lambda A: None); s = alcap.register_eigen_solver("y", print)'
    subprocess.run([sys.executable, '-c', code], check=True, timeout=60)
