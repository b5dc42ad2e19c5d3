# SPDX-License-Identifier: MIT
"""Compares the types and functions of the C interface with the recorded ones by abidiff (Debian: abigail-tools):
abidiff.py --cc CC --include FOLDER --map FILE --record FILE [--update].

A library of empty functions is compiled from alcap_c.h, with debug information, which the real one has no need of; so
what is compared is what programs in C see. abi.py compares the symbols of the real library. The record has the types
that this machine's C has: it is read on x86-64 only. Exits with 77 where abidiff or abidw is missing.
"""
import argparse
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile

from abi import functions, without_comments


def stub(text):
    """C that defines every function of the header."""
    lines = ['#include <alcap/alcap_c.h>']
    for name, line in functions(text):
        head = line[len('function '):]
        lines.append(head + (' { for (;;) {} }'))
        assert name in head
    return '\n'.join(lines) + '\n'


def build(arguments, folder):
    with open(os.path.join(arguments.include, 'alcap', 'alcap_c.h')) as file:
        text = without_comments(file.read())
    source, library = os.path.join(folder, 'alcap_c.c'), os.path.join(folder, 'libalcap_c.so')
    with open(source, 'w') as file:
        file.write(stub(text))
    subprocess.run([arguments.cc, '-std=c99', '-g', '-O0', '-fPIC', '-shared', '-I', arguments.include, source, '-o', library,
                    '-Wl,-soname,libalcap_c.so.0', '-Wl,--version-script=' + arguments.map], check=True)
    return library


def main():
    parser = argparse.ArgumentParser()
    for name in ('cc', 'include', 'map', 'record'):
        parser.add_argument('--' + name, required=True)
    parser.add_argument('--update', action='store_true')
    arguments = parser.parse_args()
    if not all(map(shutil.which, ('abidiff', 'abidw'))) or platform.machine() != 'x86_64':
        print('SKIPPED: no abidiff for x86-64; on Debian: apt-get install abigail-tools')
        return 77
    with tempfile.TemporaryDirectory() as folder:
        library = build(arguments, folder)
        if arguments.update:
            # Without paths of this machine.
            written = subprocess.run(['abidw', '--no-corpus-path', '--no-comp-dir-path', '--no-show-locs', library],
                                     check=True, capture_output=True, text=True).stdout
            with open(arguments.record, 'w') as file:
                file.write(re.sub(r" path='[^']*'", "", written))
        result = subprocess.run(['abidiff', '--no-show-locs', arguments.record, library], capture_output=True, text=True)
    print(result.stdout + result.stderr)
    # Additions alone break no program. Bit 4 of the exit code: something has changed; bit 8: it breaks programs.
    added_only = result.returncode == 4 and not re.search(r'[1-9]\d* (?:Removed|Changed)\b', result.stdout)
    if result.returncode == 0:
        return 0
    print('programs compiled before still work; record it with --update' if added_only else
          'programs compiled before would break: change it back, or raise the soname and record it with --update')
    return 1


if __name__ == '__main__':
    sys.exit(main())
