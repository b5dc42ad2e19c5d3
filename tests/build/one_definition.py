#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Every type has one definition (C++20 [basic.def.odr]).

Two types of one name in one namespace compile, link, and then share what the compiler makes of them, such as the
functions of std::vector: memory is corrupted where their sizes differ. No compiler sees both at once. This reads all
sources as text: one_definition.py FOLDER... fails on names that are defined in two files, outside of anonymous namespaces.
With --selftest it checks itself on made-up sources.
"""
import collections
import pathlib
import re
import sys

TOKEN = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"\((?:.*?)\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\''  # to be left out
    r'|^[ \t]*#(?:[^\n]*\\\n)*[^\n]*'
    r'|\bnamespace\b|\b(?:struct|class|union|enum)\b|[A-Za-z_]\w*|::|[{}();<>=:,]', re.S | re.M)


def definitions(text):
    """(namespace, name) of each type that is defined at namespace level; None for what is local to a file."""
    tokens = [t for t in TOKEN.findall(text) if not t.startswith(('//', '/*', '"', "'", 'R"')) and not t.lstrip().startswith('#')]
    found, scopes, k = [], [], 0  # a scope: name of a namespace, '' for an anonymous one, None for anything else
    while k < len(tokens):
        token = tokens[k]
        if token == 'namespace':
            end = k + 1
            while end < len(tokens) and tokens[end] not in ('{', ';', '='):
                end += 1
            if end < len(tokens) and tokens[end] == '{':
                scopes.append('::'.join(t for t in tokens[k + 1:end] if t not in ('::', 'inline')))
            k = end + 1
            continue
        if token in ('struct', 'class', 'union', 'enum') and None not in scopes:
            before = tokens[k - 1] if k else ''
            if before in ('<', ',', 'enum', '('):  # a parameter of a template, `enum class`, a type in passing
                k += 1
                continue
            end = k + 1
            while end < len(tokens) and tokens[end] not in ('{', ';', '(', ')', '='):
                end += 1
            words = tokens[k + 1:end]
            if end < len(tokens) and tokens[end] == '{' and words:
                if words[0] in ('class', 'struct'):
                    words = words[1:]
                head = words[:words.index(':')] if ':' in words else words
                # Specialisations have the same name and other arguments, members of classes a qualified one.
                if head and '<' not in head and '::' not in head and '' not in scopes:
                    found.append(('::'.join(scopes), [w for w in head if w != 'final'][-1]))
                scopes.append(None)
                k = end + 1
                continue
        if token == '{':
            scopes.append(None)
        elif token == '}' and scopes:
            scopes.pop()
        k += 1
    return found


def twice(sources):
    """Of (file, text): the types with definitions in several files."""
    places = collections.defaultdict(set)
    for file, text in sources:
        for kind in definitions(text):
            places[kind].add(file)
    return {kind: sorted(files) for kind, files in places.items() if len(files) > 1}


def selftest():
    one = 'namespace a::b {\nstruct Row { int x; };\nnamespace { struct Local {}; }\ntemplate <class T> struct Of {};\n}'
    same = '#include "x"\nnamespace a {\nnamespace b {\n// struct Row\nclass Row final : public Base { struct Inner {}; };\n} }'
    other = 'namespace a::b { namespace { struct Row {}; struct Local {}; } struct Row; void f() { struct Row {}; } }'
    special = 'namespace a::b { template <> struct Of<int> {}; enum class Kind { x }; struct Outer { struct Row {}; }; }'
    assert definitions(one) == [('a::b', 'Row'), ('a::b', 'Of')], definitions(one)
    assert definitions(same) == [('a::b', 'Row')], definitions(same)
    assert definitions(other) == [], definitions(other)
    assert definitions(special) == [('a::b', 'Kind'), ('a::b', 'Outer')], definitions(special)
    assert twice([('1', one), ('2', same), ('3', other), ('4', special)]) == {('a::b', 'Row'): ['1', '2']}


def main():
    if sys.argv[1:] == ['--selftest']:
        selftest()
        return
    files = [f for folder in sys.argv[1:] for f in pathlib.Path(folder).rglob('*') if f.suffix in ('.h', '.cpp')]
    assert len(files) > 100, 'there are few sources here'
    found = twice((str(f), f.read_text()) for f in files)
    for (space, name), places in sorted(found.items()):
        print(f'{space}::{name} is defined in {" and ".join(places)}')
    sys.exit(1 if found else 0)


main()
