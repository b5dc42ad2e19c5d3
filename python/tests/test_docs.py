# SPDX-License-Identifier: MIT
"""The docstrings against the C++ headers: every function has its counterpart, every option its parameter, with the same
default and the same unit; and every docstring describes the parameters that there are."""
import dataclasses
import glob
import inspect
import math
import os
import re

import numpy as np
import pytest

import alcap

# C++ functions that Python has under another name.
ELSEWHERE = {
    'globally_optimal': 'connect', 'locally_optimal': 'connect', 'polar': 'connect', 'trivial': 'connect',
    'metric_connection': 'connect', 'nearest_connection': 'connect',
    'measure_deviation': 'ConnectedSurface.connection_report', 'check_design': 'design_field',
    'place_design': 'design_field', 'design_controls': 'design_field', 'feature_strokes': 'design_field',
    'update_streamlines': 'streamlines', 'read_connection_target': 'connect', 'stiffness_and_mass': 'energy_matrices',
    'apply_energy_family': 'energy_matrices', 'smoothest_modes': 'FieldRun.modes', 'face_index': 'face_indices',
    'flat_torus': 'Surface.from_lengths', 'duplicate_positions': 'find_defects', 'degenerate': 'find_defects',
    'find_topology': 'Surface.components', 'extract_component': 'Surface.split',
    'controlled': 'progress_bar',
    'edge_field': 'edge_value', 'face_field': 'field_value', 'from_vectors': 'Field.from_vectors',
    'holonomy': 'ConnectedSurface.holonomy', 'homology_generators': 'Surface.homology_generators',
    'normalised': 'Field.normalised', 'on_frames': 'Field.on_frames', 'position': 'singularity_positions',
    'dihedral_angle': 'dihedral_angles', 'design_features': 'DesignRun.features', 'run_design': 'design_field', 'split_components': 'Surface.split',
    'vertex_frames': 'ConnectedSurface.frames', 'make_linear_solver': 'factorise', 'residual': 'Factorised.report',
    'design_text': 'DesignRun.design', 'parse_design': 'design_field', 'plan_design': 'DesignRun.design',
    'face_vertex_matrix': 'first_order_operators',
    'version': '__version__', 'mesh_remarks': 'FieldRun.remarks',
}
# C++ functions that make no sense in Python, and why.
CPP_ONLY = {
    'name': 'enumerators are strings', 'from_name': 'enumerators are strings', 'names_of': 'enumerators are strings',
    'apply': 'P @ u', 'apply_adjoint': 'P.T @ w', 'flux_and_circulation': 'the parts of P @ u',
    'operator_energies': 'sums of |P @ u|^2 and |Q @ u|^2', 'edge_to_face': 'a coefficient of P',
    'hermitian_product': 'numpy.vdot', 'connection_options': 'of the C++ structures', 'index_of': 'of a document',
    'measurable': 'a test inside find_defects', 'field_format': 'the end of a name',
    'as_positions': 'NumPy converts', 'as_faces': 'NumPy converts',
    'connection_choice': 'connect() takes the name',
    'within_tolerance': "report['converged']",
    'command_for': 'a line of text of the command line',
}
# Options: C++ structure, Python function, renamed members, members that Python has elsewhere.
OPTIONS = [
    ('SharpEdgeOptions', 'sharp_edges', {}, ()),
    ('SharpEdgeOptions', 'Alignment', {}, ()),
    ('FieldAlignment', 'Alignment', {}, ('features',)),
    ('SizingOptions', 'target_edge_lengths', {}, ()),
    ('AlignedOptions', 'aligned_field', {}, ('eigen', 'control')),
    ('RepairOptions', 'repair_mesh', {}, ()),
    ('RepairOptions', 'repaired_surface', {}, ()),
    ('IntrinsicOptions', 'intrinsic_delaunay', {}, ()),
    ('ConnectionOptions', 'connect', {'kind': 'connection'}, ('polar', 'global')),
    ('GlobalOptions', 'connect', {'tolerance': 'connection_tolerance', 'max_iterations': 'connection_iterations'}, ()),
    ('SolverOptions', 'factorise', {'name': 'solver'}, ('cancel',)),
    ('EigenOptions', 'smallest_eigenpair', {}, ('cancel',)),
    ('EigenOptions', 'eigenpairs', {}, ('cancel',)),
    ('ReadOptions', 'read_mesh', {}, ('control',)),
    ('OperatorOptions', 'first_order_operators', {}, ()),
    ('DesignRunOptions', 'design_field', {}, ('control',)),
    ('BatchOptions', 'run_batch', {}, ('field', 'control')),
    ('FieldRunOptions', 'run_batch', {}, ('connection', 'eigen', 'control', 'threads')),
    ('EigenStroke', 'EigenStroke', {}, ()),
    ('CurvatureOptions', 'curvature_field', {}, ()),
    ('DesignerOptions', 'Designer', {}, ('control', 'largest_rank', 'right_hand_sides')),
    ('EigenDesignOptions', 'eigen_design', {}, ('eigen', 'control', 'largest_rank')),
    ('PlanOptions', 'plan_field', {}, ()),
    ('FieldRunOptions', 'run_field', {}, ('connection', 'eigen', 'control')),
    ('SingularityTarget', 'SingularityTarget', {}, ()),
    ('VertexConstraint', 'VertexConstraint', {}, ()),
    ('Stroke', 'Stroke', {}, ('points',)),
    ('BoundaryAlignment', 'BoundaryAlignment', {}, ()),
    ('FeatureAlignment', 'FeatureAlignment', {}, ()),
    ('ControlTolerances', 'ControlTolerances', {}, ()),
]
UNITS = ('radians', 'degrees', 'diagonals', 'turns', 'bytes')


@pytest.fixture(scope='module')
def headers(source):
    files = sorted(glob.glob(os.path.join(source, 'include/alcap/*.h')))
    skipped = ('alcap_c.h', 'petsc.h', 'distributed.h', 'distributed_output.h', 'distributed_design.h', 'assembly.h', 'arrays.h', 'memory.h', 'errors.h', 'conventions.h', 'backends.h')
    return {os.path.basename(f): open(f).read() for f in files if os.path.basename(f) not in skipped}


def found(path):
    value = alcap
    for part in path.split('.'):
        if not hasattr(value, part) and part not in getattr(value, '__annotations__', {}):
            return path == 'Factorised.report'  # made by __init__
        value = getattr(value, part)
    return True


def without_details(text):
    """Without namespace detail { ... }."""
    return re.sub(r'^namespace detail \{.*?^\}  // namespace detail', '', text, flags=re.M | re.S)


def test_every_function_of_the_headers_is_in_python(headers):
    missing = set()
    for file, text in headers.items():
        for name in re.findall(r'^(?:\[\[nodiscard\]\] )?(?:inline )?[A-Za-z][\w:<>, ]*[ &*>]([a-z]\w*)\(', without_details(text), re.M):
            if name in CPP_ONLY or found(ELSEWHERE.get(name, name)) or found(f'shapes.{name}'):
                continue
            missing.add(f'{file}: {name}')
    assert sorted(missing) == []


def members(headers, struct):
    """name: (default, comment) of a structure's members."""
    for text in headers.values():
        match = re.search(rf'^struct {struct} \{{\n(.*?)^\}};', text, re.M | re.S)
        if match:
            break
    out, comment, last = {}, '', None
    for line in match.group(1).split('\n'):
        text = line.strip()
        if text.startswith('//'):
            before = text.lstrip('/ ')
            if last and line.startswith('   ' * 5):  # goes on behind a member
                out[last] = (out[last][0], out[last][1] + ' ' + before)
            else:
                comment += ' ' + before
            continue
        found_member = re.match(r'[\w:<>, ]+(?:\(.*\)>)? (\w+)(?:\{\})?(?: = (.*?))?;(?:\s*//[/<]*\s*(.*))?$', text)
        if found_member:
            last = found_member.group(1)
            out[last] = (found_member.group(2), comment + ' ' + (found_member.group(3) or ''))
        comment = ''
    assert out, struct
    return out


def value_of(default):
    """A C++ default as Python has it."""
    text = {'{}': '()', 'std::nullopt': 'None', 'true': 'True', 'false': 'False'}.get(default, default)
    text = text.replace('pi<double>', str(math.pi)).replace('{"ply"}', "('ply',)")
    text = re.sub(r'(\w+)Options\{\}\.(\w+)', r'"as \1.\2"', text)
    text = re.sub(r'^\w+::(\w+)$', r'"\1"', text).replace("'000", '000')
    return eval(text)  # noqa: S307: our own headers


def parameters(function):
    if dataclasses.is_dataclass(function):
        return {f.name: f.default for f in dataclasses.fields(function)}
    return {p.name: p.default for p in inspect.signature(function).parameters.values()}


@pytest.mark.parametrize('struct, function, renamed, elsewhere', OPTIONS)
def test_options_have_the_same_names_defaults_and_units(headers, struct, function, renamed, elsewhere):
    python = parameters(getattr(alcap, function))
    doc = inspect.getdoc(getattr(alcap, function))
    for name, (default, comment) in members(headers, struct).items():
        if name in elsewhere:
            continue
        here = renamed.get(name, name)
        assert here in python, f'{function}: no {here}'
        if python[here] is None and re.match(r'[\d.]', default or ''):  # the docstring may say that of C++
            said = re.findall(r'([\d.e-]*\d) by default', section(doc, here) or '')
            assert all(float(text) == value_of(default) for text in said), f'{function}: {here}, C++: {default}'
        elif default is not None and python[here] not in (None, inspect.Parameter.empty, dataclasses.MISSING):
            expected = value_of(default)
            if isinstance(expected, str) and expected.startswith('as '):
                structure, member = expected[3:].split('.')
                expected = value_of(members(headers, structure + 'Options')[member][0])
            if default == '{}' and dataclasses.is_dataclass(python[here]):
                expected = type(python[here])()
            same = python[here] == pytest.approx(expected) if isinstance(expected, float) else \
                python[here] == expected or not python[here] and not expected or expected == 'automatic'
            assert same, f'{function}: {here} = {python[here]!r}, C++: {default}'
        for unit in UNITS:
            if re.search(rf'\b{unit}\b(?! out)', comment):  # turns, but not "turns out"
                described = section(doc, here)
                assert described is None or unit in described, f'{function}: {here} is in {unit}: {comment}'


def test_options_of_curves_by_name(headers, sphere):
    connected = alcap.connect(sphere)
    field = alcap.eigen_design(connected, 2).field
    doc = inspect.getdoc(alcap.streamlines) + inspect.getdoc(alcap.trace_curves)
    for name, (default, _) in members(headers, 'StreamlineOptions').items():
        if name == 'control':
            continue
        said = re.search(rf'\b{name} \(([\d.e-]+)', doc)
        assert re.search(rf'\b{name}\b', doc)
        assert said is None or float(said.group(1)) == value_of(default), name
        assert len(alcap.trace_curves(connected, field, [0], [[0.2, 0.3, 0.5]], **{name: value_of(default)})) == 1


# C++ structure that a function returns: what has its members in Python, and those that are told elsewhere.
def results():
    sphere = alcap.Surface(*alcap.shapes.icosphere(2))
    run = alcap.smoothest_field(sphere, n=2, triangulation='intrinsic')
    aligned = alcap.smoothest_field(alcap.Surface(*alcap.shapes.cylinder(12, 4)), n=4, align=True)
    connected = alcap.connect(sphere)
    designer = alcap.Designer(connected, 1)
    designer.add(alcap.SingularityTarget(3))
    design = alcap.eigen_design(connected, 2, fixed=[alcap.VertexConstraint(0)],
                                strokes=[alcap.EigenStroke(alcap.stroke_along_vertices(sphere, [3, 1]))])
    solved = designer.solve()
    S, M = alcap.energy_matrices(connected, 1)
    factorised = alcap.factorise(S)
    factorised.solve(M @ np.ones(len(sphere.V)))
    line = alcap.stroke_along_vertices(sphere, [0, 1])
    curves = alcap.streamlines(connected, design.field, spacing=0.1)
    yield 'EigenReport', run.eigen[0], ()
    yield 'EigenReport', alcap.smallest_eigenpair(S, M, sphere.area)[1], ()
    yield 'EigenModes', alcap.eigenpairs(S, M, sphere.area, 2)[2], ('U', 'lambda')
    yield 'ConnectionReport', connected.connection_report, ()
    yield 'Connection', connected, ('report', 'center', 'options', 'e')
    yield 'SolveReport', factorised.report, ()
    yield 'SolvedTriangulation', run.triangulation, ()
    yield 'TriangleQuality', alcap.triangle_quality(sphere), ()
    yield 'IntrinsicTriangulation', alcap.intrinsic_delaunay(sphere), ()
    yield 'FieldRun', run, ('certificate', 'times')
    yield 'FieldFeatures', aligned.features, ()
    yield 'AlignedPiece', aligned.features.pieces[0], ()
    yield 'LineDeviation', aligned.features.report['all'], ()
    yield 'FeatureReport', aligned.features.report, ()
    yield 'FeatureLine', aligned.features.graph.lines[0], ()
    yield 'FeatureGraph', aligned.features.graph, ()
    yield 'AlignedResult', alcap.aligned_field(aligned.connection, aligned.features.graph), ()
    yield 'DesignResult', {**solved.report, 'field': 0, 'controls': 0}, ()
    yield 'ControlReport', solved.controls[0], ()
    yield 'EigenDesignResult', design, ()
    yield 'EigenStrokeReport', design.strokes[0], ()
    yield 'ControlReport', design.fixed[0], ()
    yield 'Singularity', run.singularities.dtype.names, ()
    yield 'SurfaceSegment', line.segments.dtype.names, ('a', 'b')
    yield 'SurfacePolyline', line, ()
    yield 'CurveSet', curves, ('start_reason', 'end_reason')
    yield 'Transported', alcap.transport(connected, line, 1.0), ()
    yield 'RunPlan', alcap.plan_field(1000), ()
    yield 'PhasePlan', alcap.plan_field(1000)['phases'][0], ()
    yield 'RepairedMesh', alcap.repair_mesh(sphere.V, sphere.F), ()
    yield 'RepairedSurface', alcap.repaired_surface(sphere.V, sphere.F), ()
    yield 'FieldEnergies', alcap.field_energies(connected, design.field), ()
    yield 'Remark', alcap.run_field(*alcap.shapes.grid(3, 3, 1.0, 1.0)).remarks[0], ()
    yield 'Frames', connected.frames, ()
    yield 'Field', design.field, ()


def test_results_have_every_member_of_the_structures(headers):
    missing = []
    for struct, result, elsewhere in results():
        has = set(result) if isinstance(result, (dict, tuple)) else set(dir(result))
        missing += [f'{struct}: {name}' for name in members(headers, struct) if name not in has and name not in elsewhere]
    assert missing == []


def section(doc, name):
    """What the docstring says of a parameter; None where it only refers to another function."""
    match = re.search(rf'^((?:\w+, )*{name}(?:, \w+)*)(?: :.*)?\n((?:    .*\n?)+)', doc, re.M)
    if match is None or re.search(r'\b[Aa]s of \w+\(\)|as of \w+', match.group(2)):
        return None
    return match.group(2).lower()


def functions():
    for name in alcap.__all__:
        value = getattr(alcap, name)
        if inspect.isfunction(value):
            yield name, value
        elif inspect.isclass(value) and value.__module__.startswith('alcap._') and value.__module__ != 'alcap._alcap':
            for member, inner in vars(value).items():
                if not member.startswith('_') and inspect.isfunction(inner):
                    yield f'{name}.{member}', inner
            if dataclasses.is_dataclass(value) or '__init__' in vars(value):
                yield name, value


@pytest.mark.parametrize('name, function', list(functions()))
def test_docstrings_describe_the_parameters_that_there_are(name, function):
    doc = inspect.getdoc(function)
    match = re.search(r'^(Parameters|Attributes)\n-+\n(.*?)(?=^\w+\n-+$|\Z)', doc, re.M | re.S)
    if match is None:
        return
    described = [n.strip('*') for line in re.findall(r'^(\*{0,2}\w+(?:, \w+)*)(?= :|$)', match.group(2), re.M)
                 for n in line.split(', ')]
    real = set(parameters(function)) | {'options', 'files'}
    if match.group(1) == 'Attributes' and not dataclasses.is_dataclass(function):
        return
    assert [n for n in described if n not in real] == []


@pytest.mark.parametrize('name, function', list(functions()))
def test_defaults_in_docstrings_are_the_defaults(name, function):
    """'1e-8 by default' and the like are about options that are None here; those of the C++ structures."""
    doc = inspect.getdoc(function)
    for parameter, default in parameters(function).items():
        if isinstance(default, bool) or not isinstance(default, (int, float)):
            continue
        text = section(doc, parameter)
        for said in re.findall(r'(?:default:? |by default )([\d.e-]+)', text or ''):
            assert float(said.rstrip('.')) == default, f'{name}: {parameter}'
