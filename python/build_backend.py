# SPDX-License-Identifier: MIT
"""Builds the wheel and the sdist of alcap (PEP 517): CMake builds the module, and this file packs it. Needs only Python;
pybind11, CMake and Ninja are requested if they are not installed.

Config settings (pip: --config-settings=NAME=VALUE):
- build-dir: the build folder; an existing build there is used as it was configured (default: build/python)
- cmake-args: more arguments for CMake, separated by spaces; those of ALCAP_CMAKE_ARGS in the environment come first
"""
import base64
import hashlib
import io
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import zipfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
STAMP = (2020, 1, 1, 0, 0, 0)  # the same sources give the same wheel
SDIST = ('CMakeLists.txt', 'CMakePresets.json', 'pyproject.toml', 'README.md', 'CHANGELOG.md', 'CITATION.cff', 'LICENSE',
         'include', 'kernels', 'src', 'solvers', 'apps', 'c', 'cmake', 'python')
LEFT_OUT = {'build', 'node_modules', '__pycache__', '.pytest_cache', '.mypy_cache'}


def _read(*path):
    with open(os.path.join(ROOT, *path), encoding='utf-8') as file:
        return file.read()


def _version():
    return re.search(r'^project\(alcap VERSION ([0-9.]+)', _read('CMakeLists.txt'), re.M).group(1)


def _project():
    """Of pyproject.toml what the metadata needs. Python 3.9 and 3.10 have no reader of TOML."""
    text = _read('pyproject.toml')
    part = text[text.index('[project]'):text.index('[tool.')]
    value = lambda key: re.search(rf'^{key} = "(.*)"$', part, re.M).group(1)  # noqa: E731
    strings = lambda body: re.findall(r'"([^"]*)"', body)  # noqa: E731
    extras = part[part.index('[project.optional-dependencies]'):]
    return {
        'summary': value('description'),
        'python': value('requires-python'),
        'dependencies': strings(re.search(r'^dependencies = \[(.*)\]$', part, re.M).group(1)),
        'classifiers': strings(re.search(r'^classifiers = \[(.*?)\]', part, re.M | re.S).group(1)),
        'extras': {name: strings(body) for name, body in re.findall(r'^(\w+) = \[(.*)\]$', extras, re.M)},
    }


def _metadata():
    project = _project()
    lines = ['Metadata-Version: 2.1', 'Name: alcap', f'Version: {_version()}', f'Summary: {project["summary"]}',
             'License: MIT', f'Requires-Python: {project["python"]}']
    lines += [f'Classifier: {c}' for c in project['classifiers']]
    lines += [f'Requires-Dist: {d}' for d in project['dependencies']]
    for name, needs in project['extras'].items():
        lines += [f'Provides-Extra: {name}'] + [f'Requires-Dist: {n}; extra == "{name}"' for n in needs]
    lines += ['Description-Content-Type: text/markdown', '', _read('README.md')]
    return '\n'.join(lines)


def _has_pybind11():
    found = subprocess.run([sys.executable, '-c', 'import pybind11'], capture_output=True).returncode == 0
    return found or any(os.path.exists(os.path.join(p, 'include/pybind11/pybind11.h')) for p in ('/usr', '/usr/local'))


def get_requires_for_build_wheel(config_settings=None):
    """What is missing here."""
    needs = [] if _has_pybind11() else ['pybind11>=2.10']
    return needs + [f'{name}' for name in ('cmake', 'ninja') if shutil.which(name) is None]


def get_requires_for_build_sdist(config_settings=None):
    return []


def _setting(settings, name, default):
    value = (settings or {}).get(name, default)
    return ' '.join(value) if isinstance(value, list) else value


def _run(*command):
    print('+', ' '.join(command), flush=True)
    subprocess.run(command, check=True, cwd=ROOT)


def _build(settings):
    """Builds the module and returns its file."""
    folder = os.path.abspath(_setting(settings, 'build-dir', os.path.join(ROOT, 'build', 'python')))
    extra = os.environ.get('ALCAP_CMAKE_ARGS', '').split() + _setting(settings, 'cmake-args', '').split()
    if not os.path.exists(os.path.join(folder, 'CMakeCache.txt')) or extra:
        generator = ['-G', 'Ninja'] if shutil.which('ninja') else []
        _run('cmake', '-S', ROOT, '-B', folder, *generator, '-DCMAKE_BUILD_TYPE=Release', '-DALCAP_BUILD_APPS=OFF',
             '-DALCAP_BUILD_TESTS=OFF', '-DALCAP_BUILD_C=OFF', '-DALCAP_BUILD_EXAMPLES=OFF', '-DALCAP_BUILD_PYTHON=ON',
             f'-DALCAP_PYTHON_FOR={sys.executable}', *extra)
    _run('cmake', '--build', folder, '--target', 'alcap_python', '--config', 'Release', '-j', str(os.cpu_count() or 1))
    suffix = sysconfig.get_config_var('EXT_SUFFIX')
    for here, _, files in os.walk(os.path.join(folder, 'python')):
        if '_alcap' + suffix in files:
            return os.path.join(here, '_alcap' + suffix)
    raise FileNotFoundError(f'_alcap{suffix} was not built in {folder}: it was configured for another Python')


def _tag():
    python = f'cp{sys.version_info[0]}{sys.version_info[1]}'
    platform = sysconfig.get_platform().replace('-', '_').replace('.', '_')
    return f'{python}-{python}-{platform}'


class _Wheel:
    def __init__(self, path):
        self.zip = zipfile.ZipFile(path, 'w', zipfile.ZIP_DEFLATED)
        self.record = []

    def add(self, name, data, mode=0o644):
        data = data.encode() if isinstance(data, str) else data
        info = zipfile.ZipInfo(name, STAMP)
        info.compress_type = zipfile.ZIP_DEFLATED
        info.external_attr = (0o100000 | mode) << 16
        self.zip.writestr(info, data)
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b'=').decode()
        self.record.append(f'{name},sha256={digest},{len(data)}')

    def close(self, record):
        self.record.append(record + ',,')
        text = '\n'.join(self.record) + '\n'
        self.zip.writestr(zipfile.ZipInfo(record, STAMP), text)
        self.zip.close()


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """What pip asks for first, without building anything."""
    info = f'alcap-{_version()}.dist-info'
    os.makedirs(os.path.join(metadata_directory, info), exist_ok=True)
    with open(os.path.join(metadata_directory, info, 'METADATA'), 'w', encoding='utf-8') as file:
        file.write(_metadata())
    return info


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """The wheel: python/alcap with the module, the licence, the metadata."""
    module = _build(config_settings)
    name = f'alcap-{_version()}-{_tag()}.whl'
    wheel = _Wheel(os.path.join(wheel_directory, name))
    package = os.path.join(ROOT, 'python', 'alcap')
    for file in sorted(os.listdir(package)):
        if file.endswith(('.py', '.pyi')) or file == 'py.typed':
            with open(os.path.join(package, file), 'rb') as stream:
                wheel.add('alcap/' + file, stream.read())
    with open(module, 'rb') as stream:
        wheel.add('alcap/' + os.path.basename(module), stream.read(), 0o755)
    info = f'alcap-{_version()}.dist-info'
    wheel.add(info + '/LICENSE', _read('LICENSE'))
    wheel.add(info + '/METADATA', _metadata())
    wheel.add(info + '/WHEEL', f'Wheel-Version: 1.0\nGenerator: alcap\nRoot-Is-Purelib: false\nTag: {_tag()}\n')
    wheel.close(info + '/RECORD')
    return name


def build_sdist(sdist_directory, config_settings=None):
    """Everything that the wheel is built from."""
    base = f'alcap-{_version()}'

    def keep(info):
        info.uid = info.gid = 0
        info.uname = info.gname = ''
        return None if os.path.basename(info.name) in LEFT_OUT or info.name.endswith('.pyc') else info

    with tarfile.open(os.path.join(sdist_directory, base + '.tar.gz'), 'w:gz') as tar:
        for name in SDIST:
            tar.add(os.path.join(ROOT, name), f'{base}/{name}', filter=keep)
        data = _metadata().encode()
        info = tarfile.TarInfo(f'{base}/PKG-INFO')
        info.size = len(data)
        tar.addfile(info, io.BytesIO(data))
    return base + '.tar.gz'
