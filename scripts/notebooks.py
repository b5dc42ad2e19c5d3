#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the notebooks of examples/python and compares what they print with docs/notebooks.md.

notebooks.py [--update] [--html FOLDER] [NAME...]

--update writes their output to the page, and the picture of the first notebook. --html also converts the executed
notebooks, including figures, to HTML with nbconvert, if that is installed. Needs the package alcap in its Python.
The cells are run one after another as plain Python, so no notebook server is needed. The output of cells tagged `timing`
depends on the machine and is not compared. The exit code is 1 if the output differs from the page.
"""
import contextlib
import io
import json
import os
import re
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
FOLDER = os.path.join(ROOT, 'examples', 'python')
PAGE = os.path.join(ROOT, 'docs', 'notebooks.md')
PICTURE = os.path.join(ROOT, 'docs', 'images', 'first_field.png')


def names():
    return sorted(f[:-6] for f in os.listdir(FOLDER) if f.endswith('.ipynb'))


def cells(name):
    """(source, whether its output is of this machine) of the cells with code."""
    with open(os.path.join(FOLDER, name + '.ipynb'), encoding='utf-8') as file:
        notebook = json.load(file)
    for cell in notebook['cells']:
        if cell['cell_type'] == 'code':
            yield ''.join(cell['source']), 'timing' in cell['metadata'].get('tags', ())


def run(name, update=False):
    """What the notebook prints; raises what a cell raises."""
    import matplotlib.pyplot
    matplotlib.use('Agg')
    scope, printed = {'__name__': '__main__'}, []
    for number, (source, timing) in enumerate(cells(name)):
        out = io.StringIO()
        code = '\n'.join(line for line in source.split('\n') if not line.startswith('%'))
        with contextlib.redirect_stdout(out):
            exec(compile(code, f'{name}.ipynb, cell {number}', 'exec'), scope)
        if not timing:
            printed.append(out.getvalue())
    if update and name == 'first_field':
        scope['figure'].set_size_inches(4, 4)
        scope['figure'].savefig(PICTURE, dpi=75)
    matplotlib.pyplot.close('all')
    return ''.join(printed)


def shown(page, name):
    """The block of text behind the link to a notebook, as a match."""
    match = re.search(rf'\(\.\./examples/python/{name}\.ipynb\).*?^```text\n(.*?)^```$', page, re.M | re.S)
    if match is None:
        raise SystemExit(f'docs/notebooks.md: no link to {name}.ipynb with a block of text behind it')
    return match


def html(folder):
    import alcap
    os.makedirs(folder, exist_ok=True)
    here = os.path.dirname(os.path.dirname(os.path.abspath(alcap.__file__)))
    environment = dict(os.environ, PYTHONPATH=os.pathsep.join(filter(None, [here, os.environ.get('PYTHONPATH')])))
    subprocess.run([sys.executable, '-m', 'nbconvert', '--to', 'html', '--execute', '--output-dir', folder,
                    *(os.path.join(FOLDER, name + '.ipynb') for name in names())], check=True, env=environment)


def main(arguments):
    update = '--update' in arguments
    wanted = [a for a in arguments if a in names()] or names()
    with open(PAGE, encoding='utf-8') as file:
        page = file.read()
    wrong = 0
    for name in wanted:
        text, match = run(name, update), shown(page, name)
        if text == match.group(1):
            print(f'{name}: as the page says')
        elif update:
            page = page[:match.start(1)] + text + page[match.end(1):]
            print(f'{name}: the page is new')
        else:
            wrong += 1
            print(f'{name}: prints\n{text}docs/notebooks.md has\n{match.group(1)}')
    if update:
        with open(PAGE, 'w', encoding='utf-8') as file:
            file.write(page)
    if '--html' in arguments:
        html(arguments[arguments.index('--html') + 1])
    return 1 if wrong else 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
