#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""coverage.py BUILD ROOT [--throws]: prints the line coverage per folder, from gcov's counts in a build with --coverage.
--throws also lists the statements that throw and were not run. scripts/coverage.sh builds, runs the tests and calls it."""
import collections
import concurrent.futures
import json
import os
import re
import subprocess
import sys

PARTS = ("include/alcap", "kernels", "src", "solvers", "apps/alcap", "c", "python")
# A statement that throws, by itself or by a helper that does nothing else. A line with a condition before it counts as
# run as soon as the condition was: what tells is gcov's mark of a block on it that was not.
THROWS = re.compile(r"\b(throw\b|(throw|fail|refuse)(_\w+)?\(|not_positive_definite\(|bad\()")
# What only says that such a helper exists, and comments.
NOT_A_CALL = re.compile(r"\[\[noreturn\]\]|^\s*//|\) (const )?\{$|= \[.*\]\(.*\{$|^\s*void \w+\(")


class Line:
    """What the objects together say of a line: how often it was run, and whether one of them ran every block of it."""

    def __init__(self):
        self.count, self.whole = 0, False

    def add(self, count, whole):
        self.count += count
        self.whole = self.whole or (count > 0 and whole)


def counts_of(build, data):
    """Per source file number, count and wholeness of its lines, of one object."""
    text = subprocess.run(["gcov", "--json-format", "--stdout", data], cwd=build, check=True, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout
    found = []
    for part in text.splitlines():
        if part.startswith("{"):
            for file in json.loads(part)["files"]:
                found.append((file["file"], [(line["line_number"], line["count"], not line["unexecuted_block"])
                                             for line in file["lines"]]))
    return found


def collect(build, root):
    data = [os.path.join(folder, name) for folder, _, names in os.walk(build) for name in names if name.endswith(".gcno")]
    lines = collections.defaultdict(lambda: collections.defaultdict(Line))
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for found in pool.map(lambda name: counts_of(build, name), sorted(data)):
            for name, counted in found:
                path = os.path.relpath(os.path.normpath(os.path.join(build, name)), root)
                if path.startswith(PARTS):
                    for number, count, whole in counted:
                        lines[path][number].add(count, whole)
    return lines


def folder_of(path):
    parts = os.path.dirname(path).split("/")
    return "/".join(parts[:2])


def table(lines):
    sums = collections.defaultdict(lambda: [0, 0])
    for path, counted in lines.items():
        for key in (folder_of(path), "all"):
            sums[key][0] += len(counted)
            sums[key][1] += sum(1 for line in counted.values() if line.count > 0)
    yield "| folder | lines | run | % |"
    yield "| --- | ---: | ---: | ---: |"
    for key in sorted(sums, key=lambda k: (k == "all", k)):
        total, run = sums[key]
        yield f"| `{key}/` | {total} | {run} | {100 * run / total:.1f} |".replace("`all/`", "all")


def throws(lines, root):
    """The statements that throw, as (text, whether it was run)."""
    for path in sorted(lines):
        with open(os.path.join(root, path), encoding="utf-8") as file:
            text = file.read().splitlines()
        for number in sorted(lines[path]):
            code = text[number - 1] if number <= len(text) else ""
            if THROWS.search(code) and not NOT_A_CALL.search(code):
                yield f"{path}:{number}: {code.strip()}", lines[path][number].whole


def main():
    build, root = sys.argv[1], os.path.abspath(sys.argv[2])
    lines = collect(os.path.abspath(build), root)
    if not lines:
        sys.exit("coverage.py: no counts in " + build)
    print("\n".join(table(lines)))
    if "--throws" in sys.argv[3:]:
        found = list(throws(lines, root))
        missing = [text for text, run in found if not run]
        print(f"\nOf {len(found)} statements that throw, {len(missing)} were not run:")
        print("\n".join(missing))


if __name__ == "__main__":
    main()
