# SPDX-License-Identifier: MIT
"""bench_compare.py OLD.json NEW.json [--relative 0.15] [--absolute 0.005]: reports what became slower or faster.

A difference counts if it exceeds both thresholds: the fraction of the old time and the seconds. CPU seconds are compared
unless --wall is given, because they are more reliable on a machine that is also doing other work. Residuals that grew
tenfold or are not numbers count as well. Results that only one file has are listed but not judged: they may have been
skipped for lack of time. The exit code is 1 if anything got worse.
"""
import argparse
import json
import pathlib

import bench_report


def compare(old, new, relative, absolute, key):
    before = {bench_report.key_of(r): r for r in old["results"]}
    name_of = lambda key: "/".join(str(v) for v in key if v is not None)
    after = {bench_report.key_of(r) for r in new["results"]}
    worse, better = [], []
    alone = [name_of(key) for key in before if key not in after] + [name_of(key) for key in after if key not in before]
    for r in new["results"]:
        was = before.get(bench_report.key_of(r))
        if was is None:
            continue
        name = name_of(bench_report.key_of(r))
        difference = r[key] - was[key]
        if abs(difference) > absolute and abs(difference) > relative * was[key]:
            line = f"{name}: {was[key]:.4g} s -> {r[key]:.4g} s ({100 * difference / was[key]:+.0f} %)"
            (worse if difference > 0 else better).append(line)
        if "residual" in r and "residual" in was and not r["residual"] <= 10 * max(was["residual"], 1e-12):
            worse.append(f"{name}: residual {was['residual']:.1e} -> {r['residual']:.1e}")
    return worse, better, alone


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", type=pathlib.Path)
    parser.add_argument("new", type=pathlib.Path)
    parser.add_argument("--relative", type=float, default=0.15)
    parser.add_argument("--absolute", type=float, default=0.005)
    parser.add_argument("--wall", action="store_true")
    arguments = parser.parse_args()
    worse, better, alone = compare(json.loads(arguments.old.read_text()), json.loads(arguments.new.read_text()),
                                   arguments.relative, arguments.absolute, "seconds" if arguments.wall else "cpu_seconds")
    for title, lines in (("slower or less exact", worse), ("faster", better), ("in one of the files only", alone)):
        print(f"{title}: {len(lines)}")
        for line in lines:
            print("  " + line)
    return 1 if worse else 0


if __name__ == "__main__":
    raise SystemExit(main())
