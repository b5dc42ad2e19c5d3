# SPDX-License-Identifier: MIT
"""The docstrings against the C++ headers: every function has its counterpart, every option its parameter, with the same
default and the same unit; and every docstring describes the parameters that there are."""
import dataclasses
import glob
import inspect
import math
import os
import re

import pytest

import alcap

# C++ functions that Python has under another name.
ELSEWHERE = {
    'globally_optimal': 'connect', 'locally_optimal': 'connect', 'polar': 'connect', 'trivial': 'connect',
    'metric_connection': 'connect', 'nearest_connection': 'connect',
    'measure_deviation': 'ConnectedSurface.connection_report', 'check_design': 'design_field',
    'place_design': 'design_field', 'design_controls': 'design_field', 'feature_strokes': 'design_field',
    'read_connection_target': 'connect', 'stiffness_and_mass': 'energy_matrices',
    'apply_energy_family': 'energy_matrices', 'smoothest_modes': 'FieldRun.modes', 'face_index': 'face_indices',
    'flat_torus': 'Surface.from_lengths', 'duplicate_positions': 'find_defects', 'degenerate': 'find_defects',
    'find_topology': 'Surface.components', 'extract_component': 'Surface.split',
    'controlled': 'progress_bar',
    'edge_field': 'edge_value', 'face_field': 'field_value', 'from_vectors': 'Field.from_vectors',
    'holonomy': 'ConnectedSurface.holonomy', 'homology_generators': 'Surface.homology_generators',
    'normalised': 'Field.normalised', 'on_frames': 'Field.on_frames', 'position': 'singularity_positions',
    'dihedral_angle': 'dihedral_angles', 'run_design': 'design_field', 'split_components': 'Surface.split',
    'vertex_frames': 'ConnectedSurface.frames', 'make_linear_solver': 'factorise', 'residual': 'Factorised.report',
    'design_text': 'DesignRun.design', 'parse_design': 'design_field', 'plan_design': 'DesignRun.design',
    'face_vertex_matrix': 'first_order_operators',
    'version': '__version__', 'mesh_remarks': 'FieldRun.remarks', 'repaired_surface': 'run_field',
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
    'intrinsic_delaunay': 'run_field(triangulation=...) solves on it', 'triangle_quality': 'part of intrinsic_delaunay',
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
    ('CurvatureOptions', 'curvature_field', {}, ()),
    ('DesignerOptions', 'Designer', {}, ('control', 'largest_rank', 'right_hand_sides')),
    ('EigenDesignOptions', 'eigen_design', {}, ('eigen', 'control', 'largest_rank')),
    ('PlanOptions', 'plan_field', {}, ()),
    ('FieldRunOptions', 'run_field', {}, ('connection', 'eigen', 'control')),
    ('SingularityTarget', 'SingularityTarget', {}, ()),
    ('VertexConstraint', 'VertexConstraint', {}, ()),
    ('Stroke', 'Stroke', {}, ('points',)),
    ('BoundaryAlignment', 'BoundaryAlignment', {}, ()),
]
UNITS = ('radians', 'degrees', 'diagonals', 'turns', 'bytes')


@pytest.fixture(scope='module')
def headers(source):
    files = sorted(glob.glob(os.path.join(source, 'include/alcap/*.h')))
    skipped = ('alcap_c.h', 'petsc.h', 'distributed.h', 'distributed_output.h', 'assembly.h', 'arrays.h', 'memory.h', 'errors.h', 'conventions.h', 'backends.h')
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
    text = re.sub(r'^\w+::(\w+)$', r'"\1"', text)
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
        if default is not None and python[here] not in (inspect.Parameter.empty, dataclasses.MISSING):
            expected = value_of(default)
            if isinstance(expected, str) and expected.startswith('as '):
                structure, member = expected[3:].split('.')
                expected = value_of(members(headers, structure + 'Options')[member][0])
            same = python[here] == pytest.approx(expected) if isinstance(expected, float) else \
                python[here] == expected or not python[here] and not expected or expected == 'automatic'
            assert same, f'{function}: {here} = {python[here]!r}, C++: {default}'
        for unit in UNITS:
            if re.search(rf'\b{unit}\b', comment):
                described = section(doc, here)
                assert described is None or unit in described, f'{function}: {here} is in {unit}: {comment}'


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
