# SPDX-License-Identifier: MIT
"""Designs: what is asked for is there."""
import json
import math

import numpy as np
import pytest

import alcap


def test_singularities_are_where_they_were_asked_for(bumpy):
    designer = alcap.Designer(alcap.connect(bumpy), n=1)
    saddle = designer.add(alcap.SingularityTarget(face=70, sign=-1, orientation=0.2))
    designer.add(alcap.SingularityTarget(face=300, pin=(0.2, 0.3, 0.5)))
    for angle in (0.2, 0.7, 1.2):
        designer.set(saddle, alcap.SingularityTarget(face=70, sign=-1, orientation=angle))
        result = designer.solve()
        assert result.controls[0]['met'] and result.controls[0]['index'] == -1
        found = alcap.find_singularities(designer_surface := alcap.connect(bumpy), result.field)
        here = found[found['face'] == 70][0]
        assert here['index'] == -1
        assert math.remainder(here['orientation'] - angle, math.pi) == pytest.approx(0, abs=0.02)
        assert np.allclose(found[found['face'] == 300][0]['barycentric'], (0.2, 0.3, 0.5), atol=1e-6)
        assert designer_surface.euler == found['index'].sum()
    assert set(designer.controls) == {0, 1}
    designer.remove(saddle)
    assert set(designer.controls) == {1}


def test_a_vertex_is_held(bumpy):
    designer = alcap.Designer(alcap.connect(bumpy), n=4, guidance_weight=1.0)
    designer.set_guidance(np.ones(bumpy.n_vertices, complex))
    designer.add(alcap.VertexConstraint(vertex=10, value=2j))
    assert designer.solve().field.u[10] == pytest.approx(2j, abs=1e-8)


def test_the_field_follows_a_stroke(bumpy):
    connection = alcap.connect(bumpy)
    line = alcap.stroke_along_vertices(bumpy, [0, 1])
    assert line.length == pytest.approx(line.segments['length'].sum()) and len(line) > 1
    assert np.allclose(line.segments['a'].sum(axis=1), 1)
    designer = alcap.Designer(connection, n=2)
    designer.add(alcap.Stroke(line, weight=100.0))
    assert designer.solve().controls[0]['error_degrees'] < 10
    design = alcap.eigen_design(connection, n=2, strokes=[alcap.Stroke(line, weight=10.0)])
    assert design.strokes[0]['met'] and design.components[0]['converged']


def test_strokes_agree(bumpy):
    V, F = bumpy.V, bumpy.F
    faces = [4, 90]
    points = V[F[faces]].mean(axis=1)
    by_points = alcap.stroke_through_points(bumpy, faces, np.full((2, 3), 1 / 3))
    from_space = alcap.stroke_from_space(bumpy, points)
    assert by_points.length == pytest.approx(from_space.length, rel=1e-6)
    assert by_points.reversed().length == pytest.approx(by_points.length, rel=1e-12)
    found, barycentric = alcap.SurfaceLocator(bumpy).closest(points)
    assert found.tolist() == faces and np.allclose(barycentric, 1 / 3, atol=1e-9)


def test_eigen_design_without_controls_is_the_smoothest_field(bumpy, cross):
    design = alcap.eigen_design(cross.connection, n=4)
    assert design.components[0]['lambda'] == pytest.approx(cross.eigen[0]['lambda'], rel=1e-9)


def test_the_boundary_is_followed():
    surface = alcap.connect(alcap.Surface(*alcap.shapes.disk(10)))
    free = alcap.Designer(surface, n=4)
    free.add(alcap.SingularityTarget(face=100))
    with pytest.raises(alcap.OptionError, match='singular'):  # a flat disk has parallel fields, and nothing holds one
        free.solve()
    designer = alcap.Designer(surface, n=4)
    designer.add(alcap.BoundaryAlignment(weight=10.0))
    assert designer.solve().controls[0]['met']


DESIGN = {'n': 2, 'singularities': [{'name': 'a', 'face': 40, 'kind': 'trisector', 'angle': 10}],
          'guidance': {'field': 'smoothest', 'weight': 0.5}}


def test_a_design_of_a_dict(bumpy, tmp_path):
    run = alcap.design_field(bumpy, DESIGN)
    assert run.controls[0]['met'] and run.controls_met and run.holds
    assert run.indices[40] == -1 and run.design['n'] == 2
    assert run.report['command'] == 'design' and run.report['ok']
    alcap.write_design(tmp_path / 'd.json', DESIGN)
    assert alcap.read_design(tmp_path / 'd.json')['singularities'] == DESIGN['singularities']
    assert np.array_equal(alcap.design_field(bumpy, tmp_path / 'd.json').u, run.u)


def test_a_session_keeps_what_an_edit_leaves(bumpy):
    session = alcap.DesignSession(bumpy)
    design = json.loads(json.dumps(DESIGN))
    session.solve(design)
    design['singularities'][0]['angle'] = 25
    edited, fresh = session.solve(design), alcap.design_field(bumpy, design)
    assert np.allclose(edited.u, fresh.u, atol=1e-8 * np.abs(fresh.u).max())
    with pytest.raises(alcap.Error):
        session.solve({**design, 'singularities': [{'face': 10**6}]})
    assert session.solve(design).holds


def test_the_field_runs_along_the_edges_of_a_cube():
    V, F = alcap.shapes.cube()
    surface = alcap.connect(alcap.Surface(V, F))
    creases = alcap.sharp_edges(surface)
    aligned = alcap.aligned_field(surface, creases, n=4)
    report = alcap.measure_features(surface, aligned.field, creases)
    assert len(report['lines']) == 12 and report['all']['edges'] + report['all']['corner_edges'] == 12
    assert all(piece['settled'] for piece in aligned.pieces)
    assert alcap.find_singularities(surface, aligned.field)['index'].sum() == 8
    cylinder = alcap.connect(alcap.Surface(*alcap.shapes.cylinder(24, 12)))
    rims = alcap.sharp_edges(cylinder)
    followed = alcap.aligned_field(cylinder, rims, n=4)
    assert len(rims.lines) == 2 and len(alcap.find_singularities(cylinder, followed.field)) == 0
    assert alcap.measure_features(cylinder, followed.field, rims)['all']['worst_degrees'] < 1


def test_singularities_move_merge_and_split(bumpy):
    designer = alcap.Designer(alcap.connect(bumpy), n=4)
    first = designer.add(alcap.SingularityTarget(face=70, sign=1, count=2))
    designer.move(first, 300)
    assert designer.controls[first].face == 300 and designer.controls[first].count == 2
    second = designer.split(first, 70)
    assert designer.controls[first].count == 1 and designer.controls[second].face == 70
    found = alcap.find_singularities(alcap.connect(bumpy), designer.solve().field)
    assert {70, 300} <= set(found['face'][found['index'] == 1].tolist())
    assert designer.merge(first, second) == first and set(designer.controls) == {first}
