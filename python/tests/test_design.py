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


def test_controls_are_met_within_tolerances(bumpy):
    connection = alcap.connect(bumpy)
    line = alcap.stroke_along_vertices(bumpy, [0, 1])

    def reports(tolerances):
        designer = alcap.Designer(connection, n=2, tolerances=tolerances)
        designer.add(alcap.Stroke(line, weight=0.01))
        eigen = alcap.eigen_design(connection, n=2, strokes=[alcap.Stroke(line, weight=0.01)], tolerances=tolerances)
        return designer.solve().controls[0], eigen.strokes[0]

    for k, key in enumerate(('error_degrees', 'mean_degrees')):
        error = reports(alcap.ControlTolerances())[k][key]
        assert error > 0
        assert reports(alcap.ControlTolerances(stroke_degrees=1.01 * error))[k]['met']
        assert not reports(alcap.ControlTolerances(stroke_degrees=0.99 * error))[k]['met']

    design = {'n': 2, 'strokes': [{'vertices': [0, 1], 'weight': 0.01}]}
    usual = alcap.design_field(bumpy, design).controls[0]
    assert usual['tolerance_degrees'] == 10
    for factor in (1.01, 0.99):
        tolerances = alcap.ControlTolerances(stroke_degrees=factor * usual['error_degrees'])
        control = alcap.design_field(bumpy, design, tolerances=tolerances).controls[0]
        assert control['met'] == (factor > 1) and control['tolerance_degrees'] == tolerances.stroke_degrees
        assert alcap.DesignSession(bumpy, tolerances=tolerances).solve(design).controls_met == (factor > 1)
    with pytest.raises(alcap.OptionError) as refused:
        alcap.design_field(bumpy, design, tolerances=alcap.ControlTolerances(pin_length=2))
    assert refused.value.field == 'tolerances.pin_length' and refused.value.value == '2'


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


def test_eigen_designs_take_guidance_pins_and_wide_strokes(bumpy, cross):
    rng = np.random.default_rng(3)
    g = rng.normal(size=bumpy.n_vertices) + 1j * rng.normal(size=bumpy.n_vertices)
    near = alcap.eigen_design(cross.connection, n=4, guidance=5 * g, guidance_weight=1e10)
    assert near.components[0]['converged'] and near.components[0]['smallest'] == 'proven'
    assert np.allclose(near.field.u / np.linalg.norm(near.field.u), g / np.linalg.norm(g), atol=1e-6)
    weights = np.zeros(bumpy.n_vertices)
    weights[:5] = 1
    held = alcap.eigen_design(cross.connection, n=4, guidance=g, guidance_weight=1e8, guidance_weights=weights)
    assert np.allclose(np.angle(held.field.u[:5] / g[:5]), 0, atol=1e-2)
    with pytest.raises(alcap.OptionError, match='guidance_weight'):
        alcap.eigen_design(cross.connection, n=4, guidance=g)
    line = alcap.stroke_along_vertices(bumpy, [0, 1])
    design = alcap.eigen_design(cross.connection, n=4, strokes=[alcap.Stroke(line, radius=0.3), alcap.EigenStroke(line, radius=0.2)],
                                singularities=[alcap.SingularityTarget(face=300, pin=(0.2, 0.3, 0.5))])
    assert design.strokes[0]['met'] and design.strokes[1]['met'] and design.singularities[0]['met']
    found = alcap.find_singularities(cross.connection, design.field)
    assert np.allclose(found[found['face'] == 300][0]['barycentric'], (0.2, 0.3, 0.5), atol=1e-9)


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


@pytest.mark.parametrize('across', [False, True])
def test_features_are_held_in_designs(across, tmp_path):
    surface = alcap.Surface(*alcap.shapes.cylinder(24, 8))
    connected = alcap.connect(surface)
    rims = alcap.sharp_edges(surface)
    held, free = alcap.feature_directions(connected, rims, 2, across)
    assert len(held) == 48 and free.size == 0
    control = alcap.FeatureAlignment(rims, across=across)
    designer = alcap.Designer(connected, 2)
    number = designer.add(control)
    assert designer.controls[number] is control
    live = designer.solve()
    smooth = alcap.eigen_design(connected, 2, features=[control])
    assert live.controls[0]['met'] and smooth.features[0]['met']
    for field in (live.field, smooth.field):
        off = [abs(np.angle(field.u[h.vertex] * np.conj(h.value))) for h in held]
        assert max(off) < 1e-12
    run = alcap.design_field(surface, {'n': 2, 'features': {'boundary': True, 'hold': True, 'across': across}})
    assert run.controls_met and run.features.followed
    assert run.features.report['all']['worst_degrees'] < 1
    assert run.report['alignment']['hold']
    assert [c['type'] for c in run.controls] == ['features']
    # A file of the same edges.
    alcap.write_sharp(tmp_path / 'rims.sharp', surface, rims)
    pairs = alcap.read_feature_edges(tmp_path / 'rims.sharp', surface.F, len(surface.V))
    assert sorted(alcap.edges_between(surface, pairs)) == sorted(rims.edges)
    named = alcap.design_field(surface, {'n': 2, 'features': {'edges': pairs.tolist(), 'hold': True, 'across': across}})
    assert np.array_equal(named.field.u, run.field.u)
    with pytest.raises(alcap.OptionError, match='even'):
        alcap.Designer(connected, 3).add(control)
