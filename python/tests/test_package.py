# SPDX-License-Identifier: MIT
"""The package itself: types, docstrings, versions, what the wheel holds and needs."""
import importlib.util
import inspect
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import zipfile

import pytest

import alcap
from alcap import _alcap


def public():
    for name in alcap.__all__:
        value = getattr(alcap, name)
        if inspect.isclass(value):
            yield name, value
            for member, inner in vars(value).items():
                if not member.startswith('_') and (callable(inner) or isinstance(inner, (property, staticmethod))):
                    yield f'{name}.{member}', inner
        elif callable(value):
            yield name, value


def test_every_public_name_is_documented():
    missing = [name for name, value in public() if len((inspect.getdoc(value) or '').split('\n', 1)[0]) < 10
               and name not in ('Control',)]
    assert missing == []


def test_names_of_the_interface_exist():
    assert len(set(alcap.__all__)) == len(alcap.__all__)
    assert alcap.Surface in _alcap.ConnectedSurface.__mro__


def test_version_is_that_of_the_project(source):
    text = open(os.path.join(source, 'CMakeLists.txt')).read()
    assert re.search(r'project\(alcap VERSION ([0-9.]+)', text).group(1) == alcap.__version__
    import importlib.metadata
    assert importlib.metadata.version('alcap') == alcap.__version__


def test_the_installed_package_is_tested(source):
    assert not os.path.abspath(alcap.__file__).startswith(os.path.join(source, 'python'))


@pytest.mark.skipif(shutil.which('mypy') is None, reason='no mypy')
def test_types_hold(source, tmp_path):
    user = tmp_path / 'user.py'
    user.write_text('import alcap\nimport numpy as np\n'
                    'run = alcap.smoothest_field(alcap.Surface(np.eye(3), [[0, 1, 2]]), n=4)\n'
                    'reveal_type(run.u)\nn: int = run.n\nbad: str = run.n\n')
    settings = ['--config-file', os.path.join(source, 'pyproject.toml'), '--cache-dir', str(tmp_path)]
    package = subprocess.run(['mypy', *settings, os.path.join(source, 'python/alcap')], capture_output=True, text=True)
    assert package.returncode == 0, package.stdout
    environment = {**os.environ, 'MYPYPATH': os.path.join(source, 'python')}
    out = subprocess.run(['mypy', '--cache-dir', str(tmp_path), '--ignore-missing-imports', str(user)],
                         capture_output=True, text=True, env=environment)
    assert 'complex' in out.stdout and out.stdout.count('error:') == 1, out.stdout


def test_stubs_name_what_the_module_has(source):
    text = open(os.path.join(source, 'python/alcap/_alcap.pyi')).read()
    stubs = set(re.findall(r'^(?:def|class) (\w+)', text, re.M)) - {'_Run'}
    real = {name for name in dir(_alcap) if not name.startswith('__')}
    assert stubs == real
    for name in ('Surface', 'ConnectedSurface', 'Field', 'Frames', 'IntrinsicTriangulation', 'CurveSet', 'Polyline'):
        body = re.search(rf'^class {name}[(:].*?(?=^\S)', text, re.M | re.S).group(0)
        members = {m for m in re.findall(r'def (\w+)', body) if not m.startswith('__')}
        assert members == {m for m in vars(getattr(_alcap, name)) if not m.startswith('__')}, name


@pytest.mark.skipif('ALCAP_WHEEL' not in os.environ, reason='scripts/python.sh sets it')
def test_the_wheel():
    with zipfile.ZipFile(os.environ['ALCAP_WHEEL']) as wheel:
        names = wheel.namelist()
        record = wheel.read(next(n for n in names if n.endswith('RECORD'))).decode()
        assert wheel.testzip() is None
    assert {'alcap/__init__.py', 'alcap/py.typed', 'alcap/_alcap.pyi'} <= set(names)
    assert all(name in record for name in names)
    assert all(name.startswith(('alcap/', 'alcap-')) for name in names)


@pytest.mark.skipif(shutil.which('cmake') is None, reason='no cmake')
def test_the_sdist_has_all_that_a_build_needs(source, tmp_path):
    spec = importlib.util.spec_from_file_location('build_backend', os.path.join(source, 'python/build_backend.py'))
    backend = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(backend)
    with tarfile.open(tmp_path / backend.build_sdist(str(tmp_path))) as tar:
        tar.extractall(tmp_path)
    unpacked = tmp_path / f'alcap-{alcap.__version__}'
    assert (unpacked / 'PKG-INFO').read_text().startswith('Metadata-Version')
    made = subprocess.run(['cmake', '-S', unpacked, '-B', tmp_path / 'build', '-DCMAKE_BUILD_TYPE=Release',
                           '-DALCAP_BUILD_APPS=OFF', '-DALCAP_BUILD_TESTS=OFF', '-DALCAP_BUILD_C=OFF',
                           '-DALCAP_BUILD_EXAMPLES=OFF', '-DALCAP_BUILD_PYTHON=ON', f'-DALCAP_PYTHON_FOR={sys.executable}'],
                          capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    for folder in ('include', 'src', 'solvers', 'kernels', 'python/src', 'python/alcap'):
        for here, _, files in os.walk(os.path.join(source, folder)):
            for file in files:
                if file.endswith(('.cpp', '.h', '.py', '.pyi', '.typed')):
                    assert (unpacked / os.path.relpath(os.path.join(here, file), source)).exists(), file


@pytest.mark.skipif(not sys.platform.startswith('linux') or shutil.which('readelf') is None, reason='no readelf')
def test_the_module_exports_its_entry_alone_and_needs_known_libraries():
    elf = subprocess.run(['readelf', '-dW', _alcap.__file__], capture_output=True, text=True, check=True).stdout
    needed = set(re.findall(r'NEEDED.*\[(\w+)', elf))
    # Beside those that manylinux promises: what a wheel for other machines has to bring along.
    assert needed <= {'libstdc', 'libgcc_s', 'libc', 'libm', 'libpthread', 'libdl', 'ld', 'libtbb', 'libcholmod',
                      'libmetis', 'libamd', 'libcolamd', 'libsuitesparseconfig', 'libopenblas', 'libblas', 'liblapack'}
    assert 'RUNPATH' not in elf and 'RPATH' not in elf
    symbols = subprocess.run(['readelf', '--dyn-syms', '-W', _alcap.__file__], capture_output=True, text=True,
                             check=True).stdout
    exported = [line.split()[-1] for line in symbols.splitlines()
                if re.search(r'(GLOBAL|WEAK|UNIQUE)\s+DEFAULT\s+\d', line)]
    assert [name for name in exported if 'alcap' in name and name != 'PyInit__alcap'] == []
    assert 'PyInit__alcap' in exported


@pytest.mark.parametrize('name', ['backends', 'batch', 'design', 'first_field', 'operators', 'paper'])
def test_notebooks_print_what_the_page_shows(source, tmp_path, name):
    pytest.importorskip('matplotlib')
    subprocess.run([sys.executable, os.path.join(source, 'scripts/notebooks.py'), name], check=True, cwd=tmp_path,
                   timeout=300)


def test_notebooks_run_in_a_kernel(source, tmp_path):
    pytest.importorskip('nbconvert')
    pytest.importorskip('ipykernel')
    environment = dict(os.environ, PYTHONPATH=os.path.dirname(os.path.dirname(alcap.__file__)))
    for file in ('first_field.ipynb', 'batch.ipynb'):
        subprocess.run([sys.executable, '-m', 'nbconvert', '--to', 'notebook', '--execute', '--output-dir', tmp_path,
                        os.path.join(source, 'examples/python', file)], check=True, env=environment, timeout=300)
    text = (tmp_path / 'first_field.ipynb').read_text()
    assert '"image/png"' in text and 'certificate holds' in text


BUNNY = '/usr/share/glmark2/models/bunny.obj'  # of Debian's glmark2-data


def has_page(run):
    try:
        return run.page() != ''
    except alcap.Error:
        return False


def test_ten_lines_of_the_readme_show_the_page_in_a_notebook(source, tmp_path, cross):
    pytest.importorskip('nbconvert')
    pytest.importorskip('ipykernel')
    text = open(os.path.join(source, 'README.md')).read()
    lines = re.search(r'^```python\n(.*?)^```', text, re.M | re.S).group(1)
    assert len(lines.split('\n')) <= 11
    if os.path.exists(BUNNY):
        shutil.copy(BUNNY, tmp_path / 'bunny.obj')
    else:
        alcap.write_mesh(tmp_path / 'bunny.obj', *alcap.shapes.bumpy_sphere(4, 0.3, 4.0))
    cells = [{'cell_type': 'code', 'metadata': {}, 'execution_count': None, 'outputs': [], 'source': code, 'id': name}
             for name, code in (('lines', lines), ('run', 'run'))]
    (tmp_path / 'bunny.ipynb').write_text(json.dumps({'cells': cells, 'metadata': {}, 'nbformat': 4, 'nbformat_minor': 5}))
    environment = dict(os.environ, PYTHONPATH=os.path.dirname(os.path.dirname(alcap.__file__)))
    subprocess.run([sys.executable, '-m', 'nbconvert', '--to', 'notebook', '--execute', '--inplace', 'bunny.ipynb'],
                   check=True, env=environment, cwd=tmp_path, timeout=300)
    said, shown = json.loads((tmp_path / 'bunny.ipynb').read_text())['cells']
    assert re.search(r'\d+ singularities, smallest eigenvalue', ''.join(said['outputs'][0]['text']))
    page = ''.join(shown['outputs'][0]['data']['text/html'])
    assert ('<iframe srcdoc=' in page and '&lt;canvas' in page) or not has_page(cross)


def test_the_readme_runs(source, tmp_path, monkeypatch):
    text = open(os.path.join(source, 'README.md')).read() + open(os.path.join(source, 'docs/python.md')).read()
    blocks = re.findall(r'^```python\n(.*?)^```', text, re.M | re.S)
    assert len(blocks) >= 2
    monkeypatch.chdir(tmp_path)
    alcap.write_mesh('bunny.obj', *alcap.shapes.bumpy_sphere(4, 0.3, 4.0))
    for block in blocks:
        exec(compile(block, 'a page', 'exec'), {})
