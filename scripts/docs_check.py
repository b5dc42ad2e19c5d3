# SPDX-License-Identifier: MIT
"""Checks the pages: docs_check.py [--update] [ROOT].

Every .md file of the repository:
- a relative link leads to a file, its anchor to a heading;
- a path in `code` that begins with a folder of the repository exists (* matches within a name).
docs/notation.md, docs/architecture.md and docs/api.md, per row of a table that names files or links to them:
- every identifier in `code` occurs in one of these files;
- a test in "quotes" is the beginning of a TEST_CASE of a test file that the row names.
docs/recipes.md:
- the C++ block after a link to examples/NAME.cpp is that file without its first line. --update writes it there.

Prints one line per problem; the exit code is 1 if there are any.
"""
import glob
import os
import re
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from docs_filter import slug  # noqa: E402

OURS = ('include', 'src', 'kernels', 'solvers', 'apps', 'examples', 'tests', 'perf', 'scripts', 'docs', 'datasets', 'cmake', 'python', 'c')
SKIPPED = {'build', 'out', 'node_modules', '.git', '.cache'}
LINK = re.compile(r'!?\[[^\]]*\]\(([^)\s]+)\)')
CODE = re.compile(r'`([^`]+)`')
IDENTIFIER = re.compile(r'^[A-Za-z_][A-Za-z_0-9]*(?:(?:::|\.)[A-Za-z_][A-Za-z_0-9]*)*(?:\(\))?$')


def pages(root):
    for folder, folders, files in os.walk(root):
        folders[:] = [f for f in folders if f not in SKIPPED and not f.startswith('build')]
        for name in sorted(files):
            if name.endswith('.md'):
                yield os.path.join(folder, name)


def prose(text):
    """(line number, line) outside fenced code."""
    fenced = False
    for number, line in enumerate(text.split('\n'), 1):
        if line.lstrip().startswith('```'):
            fenced = not fenced
        elif not fenced:
            yield number, line


def anchors(text):
    seen, found = {}, set()
    for _, line in prose(text):
        heading = re.match(r'#{1,6} +(.*?) *$', line)
        if heading:
            name = slug(heading.group(1))
            count = seen.get(name, 0)
            seen[name] = count + 1
            found.add(f'{name}-{count}' if count else name)
    return found


def read(path):
    with open(path, encoding='utf-8') as file:
        return file.read()


class Checker:
    def __init__(self, root):
        self.root = root
        self.problems = []

    def wrong(self, path, number, message):
        self.problems.append(f'{os.path.relpath(path, self.root)}:{number}: {message}')

    def links(self, path, text):
        for number, line in prose(text):
            for target in LINK.findall(re.sub(r'`[^`]*`', '', line)):
                if re.match(r'[a-z]+:', target):
                    continue
                file, _, anchor = target.partition('#')
                where = os.path.normpath(os.path.join(os.path.dirname(path), file)) if file else path
                if not os.path.exists(where):
                    self.wrong(path, number, f'dead link {target}')
                elif anchor and (not where.endswith('.md') or anchor not in anchors(read(where))):
                    self.wrong(path, number, f'no heading for the anchor of {target}')

    def paths(self, path, text):
        for number, line in prose(text):
            for code in CODE.findall(line):
                if self.is_path(code) and not self.files(code):
                    self.wrong(path, number, f'there is no {code}')

    @staticmethod
    def is_path(code):
        return re.match(r'(?:%s)/[\w./*+-]*$' % '|'.join(OURS), code) is not None

    def files(self, code):
        return glob.glob(os.path.join(self.root, code))

    def rows(self, path, text):
        for number, line in prose(text):
            if not line.startswith('|'):
                continue
            codes = CODE.findall(line)
            files = [f for code in codes if self.is_path(code) for f in self.files(code) if os.path.isfile(f)]
            linked = [os.path.join(os.path.dirname(path), t.partition('#')[0]) for t in LINK.findall(line)]
            files += [f for f in linked if os.path.isfile(f) and not f.endswith('.md')]
            if not files:
                continue
            contents = [read(f) for f in files]
            for code in codes:
                name = code.rstrip('()')
                if self.is_path(code) or not IDENTIFIER.match(code):
                    continue
                last = re.split(r'::|\.', name)[-1]
                if not any(re.search(r'\b%s\b' % re.escape(last), content) for content in contents):
                    self.wrong(path, number, f'{code} is in none of the files of its row')
            cases = [re.findall(r'TEST_CASE(?:_TEMPLATE)?\(\s*"((?:[^"\\]|\\.)*)"', c) for c in contents]
            for test in re.findall(r'"([^"]+)"', re.sub(r'`[^`]*`', '', line)):
                if not any(case.startswith(test) for found in cases for case in found):
                    self.wrong(path, number, f'no test of its row is called "{test}"')

    def programs(self, path, text, update):
        block = re.compile(r'(\]\(\.\./(examples/[\w]+\.cpp)\)(?:(?!```|\]\(\.\./examples).)*?```cpp\n)(.*?)(```)', re.S)
        shown = set()

        def compare(match):
            file = os.path.join(self.root, match.group(2))
            shown.add(match.group(2))
            if not os.path.isfile(file):
                return match.group(0)  # already a dead link
            program = read(file).split('\n', 1)[1]
            if match.group(3) != program and not update:
                self.wrong(path, text[:match.start(3)].count('\n') + 1,
                           f'this is not {match.group(2)}; scripts/docs_check.py --update copies it')
            return match.group(1) + program + match.group(4)

        updated = block.sub(compare, text)
        for file in sorted(glob.glob(os.path.join(self.root, 'examples', '*.cpp'))):
            name = 'examples/' + os.path.basename(file)
            if name not in shown:
                self.wrong(path, 1, f'{name} is not shown')
        if update and updated != text:
            with open(path, 'w', encoding='utf-8') as out:
                out.write(updated)


def main():
    arguments = sys.argv[1:]
    update = '--update' in arguments
    rest = [a for a in arguments if a != '--update']
    here = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    root = os.path.abspath(rest[0]) if rest else here
    checker, count = Checker(root), 0
    for path in pages(root):
        text = read(path)
        name = os.path.relpath(path, root)
        count += 1
        checker.links(path, text)
        checker.paths(path, text)
        if name in ('docs/notation.md', 'docs/architecture.md', 'docs/api.md'):
            checker.rows(path, text)
        if name == 'docs/recipes.md':
            checker.programs(path, text, update)
    for problem in checker.problems:
        print(problem, file=sys.stderr)
    if not count:
        print(f'{root}: no pages found', file=sys.stderr)
    if checker.problems or not count:
        sys.exit(1)
    print(f'{count} pages: links, files, names, tests and programs are as they say')


if __name__ == '__main__':
    main()
