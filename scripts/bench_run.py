# SPDX-License-Identifier: MIT
"""Runs the benchmark programs and the tool, within a time limit, and writes one JSON of all results.

Called by bench.sh. Every program runs apart, so that one that crashes or takes too long costs its own numbers only.
"""
import argparse
import json
import os
import pathlib
import platform
import statistics
import subprocess
import tempfile
import time

import bench_report

# Order: what the targets of the table need comes first, so that a slow machine cuts the rest.
PROGRAMS = ["kernels", "connection", "eigen", "assembly", "pipeline", "design", "linear"]
LIMIT = {"quick": 165.0, "full": 6 * 3600.0}


def run_program(build, name, plan, flags, budget):
    """The benchmarks of one program, with their names taken apart; empty when it fails."""
    with tempfile.NamedTemporaryFile(suffix=".json") as out:
        command = [
            str(build / "perf" / f"perf_{name}"),
            f"--faces={','.join(map(str, plan['sizes']))}",
            f"--threads={','.join(map(str, plan['threads']))}",
            f"--families={','.join(plan['families'])}",
            f"--benchmark_out={out.name}",
            "--benchmark_out_format=json",
            *flags,
        ]
        try:
            subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=budget, check=False)
        except (subprocess.TimeoutExpired, OSError) as error:
            print(f"   {name}: {type(error).__name__}, what it had finished is kept")
        text = pathlib.Path(out.name).read_text()
    try:
        found = json.loads(text)["benchmarks"]
    except ValueError:
        found = salvage(text)
    return [bench_report.result_of(name, b) for b in found if b.get("run_type") != "aggregate"]


def salvage(text):
    """Whole entries of a file that was cut."""
    entries, decoder = [], json.JSONDecoder()
    at = text.find('"benchmarks"')
    at = text.find("{", at) if at >= 0 else -1
    while at >= 0:
        try:
            entry, end = decoder.raw_decode(text, at)
        except ValueError:
            break
        entries.append(entry)
        at = text.find("{", end)
    return entries


def run_tool(build, faces, repeats, deadline):
    """`alcap field` from PLY to files, n = 4: median seconds, CPU seconds and the largest resident set."""
    level = bench_report.level_of(faces)
    tool = build / "apps" / "alcap" / "alcap"
    with tempfile.TemporaryDirectory() as folder:
        mesh = pathlib.Path(folder) / "mesh.ply"
        kind = "torus:%d,%d" % (2 * round((faces / 4) ** 0.5), round((faces / 4) ** 0.5)) if level is None else f"scan:{level},0.1"
        subprocess.run([tool, "make", kind, "-o", mesh, "--quiet"], check=True)
        walls, cpus, peaks = [], [], []
        for k in range(repeats):
            if walls and time.monotonic() + walls[-1] > deadline:
                break
            start = time.monotonic()
            command = [tool, "field", mesh, "-n", "4", "--tolerance", "1e-6", "-o", pathlib.Path(folder) / f"out{k}", "--quiet"]
            child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
            if child.returncode not in (0, 5):
                return None
            walls.append(time.monotonic() - start)
            cpus.append(usage.ru_utime + usage.ru_stime)
            peaks.append(usage.ru_maxrss * 1024)
    return {
        "program": "tool", "phase": "tool", "family": "scan" if level is not None else "torus", "size": faces,
        "n": 4, "threads": os.cpu_count(), "seconds": statistics.median(walls), "cpu_seconds": statistics.median(cpus),
        "peak_bytes": max(peaks), "all_seconds": walls,
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--mode", choices=["quick", "full"], default="quick")
    parser.add_argument("--sizes")
    parser.add_argument("--threads")
    arguments = parser.parse_args()
    quick = arguments.mode == "quick"
    cores = os.cpu_count() or 1
    plan = {
        "sizes": [50000, 327680, 1310720] if quick else [20480, 50000, 81920, 327680, 1310720, 5242880, 20971520],
        "threads": sorted({1, min(2, cores), cores}),
        "families": ["jittered"] if quick else ["jittered", "torus", "scan", "cad", "icosphere"],
    }
    for key in ("sizes", "threads"):
        if getattr(arguments, key):
            plan[key] = [int(v) for v in getattr(arguments, key).split(",")]

    started = time.monotonic()
    deadline = started + LIMIT[arguments.mode]
    results = []
    # The whole command first, on a third of the time.
    print("== the tool")
    for faces in plan["sizes"]:
        share = started + LIMIT[arguments.mode] / 3
        if time.monotonic() > share:
            break
        found = run_tool(arguments.build, faces, 2 if quick else 5, share)
        if found:
            results.append(found)
    for k, name in enumerate(PROGRAMS):
        left = deadline - time.monotonic()
        if left < 1:
            print(f"   {name}: no time left")
            continue
        # Sizes one by one, small ones first: what is cut is the largest.
        budget = left / (len(PROGRAMS) - k)
        until = time.monotonic() + budget
        print(f"== {name} ({budget:.0f} s at most)")
        repetitions = [] if quick else ["--benchmark_repetitions=5"]
        flags = repetitions + [f"--benchmark_min_time={'0.01' if quick else '0.1'}"]
        if quick and name == "connection":
            flags.append("--benchmark_filter=polar|detail:1/")
        sizes = plan["sizes"] if name != "kernels" else plan["sizes"][:1]
        for size in sizes:
            left = until - time.monotonic()
            if left > 1:
                results += run_program(arguments.build, name, {**plan, "sizes": [size]}, flags, left)

    report = {
        "machine": {"cores": cores, "processor": bench_report.processor(), "system": platform.platform()},
        "mode": arguments.mode,
        "load_at_end": os.getloadavg()[0],
        "seconds": time.monotonic() - started,
        "results": bench_report.medians(results),
    }
    (arguments.out / "bench.json").write_text(json.dumps(report, indent=1) + "\n")
    bench_report.write_all(report, arguments.out)
    print((arguments.out / "targets.md").read_text())
    print(f"Everything is in {arguments.out} ({report['seconds']:.0f} s)")


if __name__ == "__main__":
    main()
