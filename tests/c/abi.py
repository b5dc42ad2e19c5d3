# SPDX-License-Identifier: MIT
"""Compares the binary interface of the C library with the recorded one: abi.py --cc CC --library FILE --nm NM --include
FOLDER --record FILE [--update].

The record has a line for every function with its types, every struct member with its offset and size, and every number
of an enumeration. A line that is gone or has changed breaks programs that were compiled before, and fails; so does a line
that is not recorded, until --update records it. The library exports the recorded functions and nothing else.
"""
import argparse
import os
import re
import subprocess
import sys
import tempfile


def without_comments(text):
    return re.sub(r'/\*.*?\*/', '', text, flags=re.S)


def functions(text):
    for match in re.finditer(r'^((?:const )?\w+\*? ?\*?)\b(alcap_\w+)\(([^)]*)\);', text, re.M):
        yield match.group(2), re.sub(r'\s+', ' ', f'function {match.group(1).strip()} {match.group(2)}({match.group(3)})')


def layout(text, cc, include):
    lines = []
    for body, name in re.findall(r'typedef struct \w+ \{(.*?)\} (\w+);', text, re.S):
        lines.append(f'printf("struct {name}: %zu bytes\\n", sizeof({name}));')
        for member in re.findall(r'(\w+|\(\*\w+\)\([^)]*\))(?:\[\d+\])?;', body):
            member = re.sub(r'\(\*(\w+)\).*', r'\1', member)
            lines.append(f'printf("member {name}.{member}: at %zu, %zu bytes\\n", offsetof({name}, {member}), '
                         f'sizeof((({name}*)0)->{member}));')
    for body in re.findall(r'typedef enum \w+ \{(.*?)\}', text, re.S):
        for name in re.findall(r'(ALCAP_\w+)', body):
            lines.append(f'printf("number {name}: %d\\n", (int){name});')
    program = '#include <alcap/alcap_c.h>\n#include <stdio.h>\nint main(void) {\n' + '\n'.join(lines) + '\nreturn 0;\n}\n'
    with tempfile.TemporaryDirectory() as folder:
        source, binary = os.path.join(folder, 'abi.c'), os.path.join(folder, 'abi')
        with open(source, 'w') as file:
            file.write(program)
        subprocess.run([cc, '-std=c99', '-I', include, source, '-o', binary], check=True)
        return subprocess.run([binary], check=True, capture_output=True, text=True).stdout.splitlines()


def main():
    parser = argparse.ArgumentParser()
    for name in ('cc', 'library', 'nm', 'include', 'record'):
        parser.add_argument('--' + name, required=True)
    parser.add_argument('--update', action='store_true')
    arguments = parser.parse_args()
    with open(os.path.join(arguments.include, 'alcap', 'alcap_c.h')) as file:
        text = without_comments(file.read())
    declared = dict(functions(text))
    now = sorted(declared.values()) + layout(text, arguments.cc, arguments.include)
    if arguments.update:
        with open(arguments.record, 'w') as file:
            file.write('\n'.join(now) + '\n')
    with open(arguments.record) as file:
        before = file.read().splitlines()
    problems = [f'gone or changed: {line}' for line in before if line not in now]
    problems += [f'not recorded (--update): {line}' for line in now if line not in before]
    out = subprocess.run([arguments.nm, '-D', '--defined-only', arguments.library], check=True, capture_output=True, text=True)
    exported = {line.split()[2].split('@')[0] for line in out.stdout.splitlines() if line.split()[1] in 'TtDBRVWiu'}
    problems += [f'exported without being declared: {name}' for name in sorted(exported - set(declared))]
    problems += [f'declared and not exported: {name}' for name in sorted(set(declared) - exported)]
    print('\n'.join(problems) or f'{len(declared)} functions, {len(now)} lines, as recorded')
    return 1 if problems else 0


if __name__ == '__main__':
    sys.exit(main())
