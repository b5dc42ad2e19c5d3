# SPDX-License-Identifier: MIT
"""Input filter of Doxygen: docs_filter.py FILE prints the file as Doxygen needs it.

Pages (.md) are written for any Markdown reader. Doxygen 1.9 does not create anchors for headings and refers to pages by
name. So headings get the same anchors as on GitHub, and relative links become references. A link to a file that is not
part of the site is replaced by its text.

Headers (.h) begin with a comment that describes the file, and explain options in comments behind the fields. This filter
turns both into documentation, so the headers need no special marks.
"""
import os
import re
import sys
import unicodedata

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def slug(heading):
    """The anchor that GitHub gives a heading."""
    text = re.sub(r'\[([^\]]*)\]\([^)]*\)', r'\1', heading).replace('`', '').strip().lower()
    kept = [c for c in text if c in ' -_' or unicodedata.category(c)[0] in 'LNM']
    return ''.join(kept).replace(' ', '-')


def page(path):
    return os.path.splitext(os.path.basename(path))[0]


def outside_code(text, change):
    """Applies change(line) to the lines that are outside fenced code."""
    lines, fenced = [], False
    for line in text.split('\n'):
        if line.lstrip().startswith('```'):
            fenced = not fenced
            lines.append(line)
        else:
            lines.append(line if fenced else change(line))
    return '\n'.join(lines)


def filter_page(path, text):
    docs = os.path.join(ROOT, 'docs')
    here = page(path)

    def link(match):
        shown, target = match.group(1), match.group(2)
        if re.match(r'[a-z]+:', target):
            return match.group(0)
        file, _, anchor = target.partition('#')
        where = os.path.normpath(os.path.join(os.path.dirname(path), file)) if file else path
        if where.endswith('.md') and os.path.dirname(where) in (docs, os.path.join(docs, 'recipes')):
            return f'[{shown}](@ref {page(where)}_{anchor})' if anchor else f'[{shown}](@ref page_{page(where)})'
        if where.endswith('.h') and os.path.dirname(where) == os.path.join(ROOT, 'include', 'alcap'):
            return f'[{shown}](@ref {page(where)}.h)'
        return shown

    def change(line):
        line = re.sub(r'!\[([^\]]*)\]\(([^)]*/)?([^)/]+)\)', r'![\1](\3)', line)
        line = re.sub(r'(?<!!)\[([^\]]*)\]\(([^)\s]+)\)', link, line)
        heading = re.match(r'(#{1,4}) +(.*?) *$', line)
        if heading and (heading.group(1) == '#' or here != 'start'):  # the sections of the main page are no entries of their own
            name = f'page_{here}' if heading.group(1) == '#' else f'{here}_{slug(heading.group(2))}'
            return f'{heading.group(1)} {heading.group(2)} {{#{name}}}'
        return line

    # A first line that is a comment would hide the title from Doxygen.
    return outside_code(re.sub(r'\A(<!--.*?-->\s*)+', '', text, flags=re.S), change)


def plain(comment):
    """#V is a count here, not a name that Doxygen should look for."""
    return re.sub(r'#(?=[A-Za-z])', r'\\#', comment)


def file_comment(name, lines):
    """The comment on top of a header as a documentation block of as many lines; indented lines are examples."""
    out, code = [], False
    for line in lines:
        body = line[2:]
        if code and body.strip() and not body.startswith('   '):
            out.append('/// @endcode ' + plain(body).strip())
            code = False
        elif body.startswith('   ') and not code:
            # The mark takes the place of the empty line before, or goes in front.
            if out and out[-1] == '///':
                out[-1] = '/// @code{.cpp}'
                out.append('///' + body)
            else:
                out.append('/// @code{.cpp}' + body)
            code = True
        else:
            out.append('///' + (body if code else plain(body)))
    if code:
        out[-1] += ' @endcode'
    text = out[0][3:].strip()
    if text.startswith(name + ': '):
        text = text[len(name) + 2:]
        out[0] = '/// ' + text[:1].upper() + text[1:]
    return out


def function_name(lines):
    """Of the declaration that starts at lines[0], or None."""
    found = re.search(r'\b(\w+)\((?!\()', re.sub(r'template <.*?>\n|\[\[\w+\]\]|\w+\(x\)', '', '\n'.join(lines[:3])))
    return found and found.group(1)


def document_forms(lines):
    """Several forms of a function stand under one comment, without an empty line between; Doxygen wants one for each."""
    last, before = None, ''
    for i, line in enumerate(lines):
        starts = re.match(r' {0,2}(template <|\[\[nodiscard\]\]|[A-Za-z])', line) and '(' in ''.join(lines[i:i + 2])
        if starts and re.search(r'[;}]$|///.*$', before.rstrip()) and not before.startswith('}'):
            name = function_name(lines[i:])
            if name and name == last and before.rstrip().endswith((';', '}')):
                lines[i] = '/** The same in another form. */ ' + line
            last = name
        elif not line.strip():
            last = None
        before = line
    return lines


def filter_header(path, text):
    """The same lines, so that Doxygen's warnings name the right ones."""
    lines = text.split('\n')
    start = 1
    while start < len(lines) and lines[start].strip() == '//':
        start += 1
    end = start
    while end < len(lines) and lines[end].startswith('//'):
        end += 1
    out = ['/// @file'] + ['///'] * (start - 1)
    if end > start:
        out += file_comment(os.path.basename(path), lines[start:end])
    member = re.compile(r'^(\s+[A-Za-z_][\w:<>,()& ]*\s[\w]+(?:\s*(?:=|\{)[^;]*)?;\s+)//(?!/)(.*)$')
    behind = False
    for line in lines[end:]:
        found = member.match(line)
        continued = re.match(r'^\s{12,}//(?!/)(.*)$', line)
        if found:
            out.append(f'{found.group(1)}///<{plain(found.group(2))}')
            behind = True
        elif behind and continued:
            out.append(plain(line.replace('//', '///<', 1)))
        else:
            behind = False
            code, marks, comment = line.partition('//')
            out.append(code + marks + plain(comment))
    return '\n'.join(document_forms(out))


def main():
    path = os.path.abspath(sys.argv[1])
    with open(path, encoding='utf-8') as file:
        text = file.read()
    sys.stdout.reconfigure(encoding='utf-8')
    sys.stdout.write(filter_page(path, text) if path.endswith('.md') else filter_header(path, text))


if __name__ == '__main__':
    main()
