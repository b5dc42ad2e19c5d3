#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""coverage.py BUILD ROOT [--throws]: prints the line coverage per folder, from gcov's counts in a build with --coverage.
--throws also lists the lines that throw and were not run. scripts/coverage.sh builds, runs the tests and calls it."""
import collections
import concurrent.futures
import json
import os
import re
import subprocess
import sys

PARTS = ("include/alcap", "kernels", "src", "solvers", "apps/alcap", "c", "python")


def counts_of(build, data):
    """Per source file the counts of its lines, of one object."""
    text = subprocess.run(["gcov", "--json-format", "--stdout", data], cwd=build, check=True, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout
    found = []
    for part in text.splitlines():
        if part.startswith("{"):
            for file in json.loads(part)["files"]:
                found.append((file["file"], [(line["line_number"], line["count"]) for line in file["lines"]]))
    return found


def collect(build, root):
    data = [os.path.join(folder, name) for folder, _, names in os.walk(build) for name in names if name.endswith(".gcno")]
    lines = collections.defaultdict(lambda: collections.defaultdict(int))
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for found in pool.map(lambda name: counts_of(build, name), sorted(data)):
            for name, counted in found:
                path = os.path.relpath(os.path.normpath(os.path.join(build, name)), root)
                if path.startswith(PARTS):
                    for number, count in counted:
                        lines[path][number] += count
    return lines


def folder_of(path):
    parts = os.path.dirname(path).split("/")
    return "/".join(parts[:2])


def table(lines):
    sums = collections.defaultdict(lambda: [0, 0])
    for path, counted in lines.items():
        for key in (folder_of(path), "all"):
            sums[key][0] += len(counted)
            sums[key][1] += sum(1 for count in counted.values() if count > 0)
    yield "| folder | lines | run | % |"
    yield "| --- | ---: | ---: | ---: |"
    for key in sorted(sums, key=lambda k: (k == "all", k)):
        total, run = sums[key]
        yield f"| `{key}/` | {total} | {run} | {100 * run / total:.1f} |".replace("`all/`", "all")


def throws(lines, root):
    for path in sorted(lines):
        with open(os.path.join(root, path), encoding="utf-8") as file:
            text = file.read().splitlines()
        for number in sorted(lines[path]):
            if lines[path][number] == 0 and number <= len(text) and re.search(r"\bthrow [A-Z(]|\bfail\(", text[number - 1]):
                yield f"{path}:{number}: {text[number - 1].strip()}"


def main():
    build, root = sys.argv[1], os.path.abspath(sys.argv[2])
    lines = collect(os.path.abspath(build), root)
    if not lines:
        sys.exit("coverage.py: no counts in " + build)
    print("\n".join(table(lines)))
    if "--throws" in sys.argv[3:]:
        print("\nNot run:")
        print("\n".join(throws(lines, root)))


if __name__ == "__main__":
    main()
