# SPDX-License-Identifier: MIT
"""Runs the benchmark programs and the tool and writes one JSON of all results.

Called by bench.sh. The work is a list of units, one program on one size each, the targets' first. Before a unit starts its
time is predicted from the same unit on a smaller mesh; what does not fit into the limit is left out and named, so that
nothing is stopped in the middle. A program that crashes costs its own numbers only.
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

LIMIT = {"quick": 170.0, "full": 6 * 3600.0}
# A prediction scales with the size; solvers that are not linear get this much more.
MARGIN = 1.3
# Bytes per triangle that the tool needs: beyond what is free a size is left out.
TOOL_BYTES = 1000


def quick_units(sizes, most, one_and_most):
    """What the table of targets needs first, then the rest where it is short."""
    small = [s for s in sizes if s <= 100000] or sizes[:1]
    middle = [s for s in sizes if s <= 400000] or sizes[:1]
    units = [("kernels", small[0], one_and_most, [], 1)]
    for size in sizes:
        units += [
            ("eigen", size, most, ["--benchmark_filter=^eigen/.*backend:auto/"], 5 if size <= 400000 else 1),
            ("connection", size, most, ["--benchmark_filter=detail:1/"], 5 if size <= 400000 else 1),
            ("tool", size, most, [], 3 if size <= 400000 else 1),
        ]
    for size in middle:
        units.append(("assembly", size, one_and_most, [], 1))
        units.append(("pipeline", size, one_and_most, ["--benchmark_filter=^(read|half|topo|geom|frames)|field/.*n:4"], 1))
    for size in small:
        units += [
            ("eigen", size, most, ["--benchmark_filter=backend:(l|i|p)"], 1),
            ("pipeline", size, one_and_most, ["--benchmark_filter=^batch"], 1),
            ("design", size, most, [], 1),
            ("connection", size, one_and_most, ["--benchmark_filter=polar|detail:"], 1),
        ]
    units += [("linear", size, most, [], 1) for size in middle]
    for size in sizes:
        if size not in middle:
            units.append(("assembly", size, one_and_most, [], 1))
            units.append(("pipeline", size, most, ["--benchmark_filter=^(read|half|topo|geom|frames)"], 1))
            units.append(("linear", size, most, ["--benchmark_filter=product|multigrid"], 1))
    for size in middle:
        units.append(("eigen", size, [1], ["--degrees=4", "--benchmark_filter=^eigen/.*backend:auto/"], 1))
    return units


def full_units(sizes, threads):
    return [(name, size, threads, [], 5)
            for size in sizes
            for name in (["kernels"] if size == sizes[0] else []) +
            ["tool", "eigen", "connection", "assembly", "pipeline", "linear", "design"]]


def memory_available():
    try:
        for line in pathlib.Path("/proc/meminfo").read_text().splitlines():
            if line.startswith("MemAvailable:"):
                return 1024 * int(line.split()[1])
    except OSError:
        pass
    return 1 << 62


def run_program(build, name, size, threads, families, flags):
    """The benchmarks of one program, with their names taken apart; empty when it fails."""
    with tempfile.NamedTemporaryFile(suffix=".json") as out:
        command = [
            str(build / "perf" / f"perf_{name}"),
            f"--faces={size}",
            f"--threads={','.join(map(str, threads))}",
            f"--families={','.join(families)}",
            f"--benchmark_out={out.name}",
            "--benchmark_out_format=json",
            *flags,
        ]
        status = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode
        if status != 0:
            print(f"   {name} at {size:,} ended with {status}: what it had finished is kept")
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


def run_tool(build, faces, repeats):
    """`alcap field` from PLY to files, n = 4: median seconds, CPU seconds and the largest resident set."""
    if faces * TOOL_BYTES > memory_available():
        print(f"   tool at {faces:,}: not enough memory")
        return []
    level = bench_report.level_of(faces)
    across = round((faces / 4) ** 0.5)
    tool = build / "apps" / "alcap" / "alcap"
    with tempfile.TemporaryDirectory() as folder:
        mesh = pathlib.Path(folder) / "mesh.ply"
        kind = f"torus:{2 * across},{across}" if level is None else f"scan:{level},0.1"
        subprocess.run([tool, "make", kind, "-o", mesh, "--quiet"], check=True)
        walls, cpus, peaks = [], [], []
        for k in range(repeats):
            start = time.monotonic()
            out = pathlib.Path(folder) / f"out{k}"
            child = subprocess.Popen([tool, "field", mesh, "-n", "4", "--tolerance", "1e-6", "-o", out, "--quiet"],
                                     stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
            if child.returncode not in (0, 5):
                print(f"   tool at {faces:,} ended with {child.returncode}")
                return []
            walls.append(time.monotonic() - start)
            cpus.append(usage.ru_utime + usage.ru_stime)
            peaks.append(usage.ru_maxrss * 1024)
        report = json.loads((pathlib.Path(folder) / "out0" / "report.json").read_text())
    return [{
        "program": "tool", "phase": "tool", "family": "scan" if level is not None else "torus", "size": faces,
        "faces": report["mesh"]["faces"], "n": 4, "threads": os.cpu_count(), "seconds": statistics.median(walls),
        "cpu_seconds": statistics.median(cpus), "peak_bytes": max(peaks), "all_seconds": walls,
    }]


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
    numbers = lambda text: sorted({int(v) for v in text.split(",")})
    sizes = [50000, 327680, 1310720] if quick else [20480, 50000, 81920, 327680, 1310720, 5242880, 20971520]
    if arguments.sizes:
        sizes = numbers(arguments.sizes)
    threads = numbers(arguments.threads) if arguments.threads else sorted({1, min(2, cores), cores})
    families = ["jittered"] if quick else ["jittered", "torus", "scan", "cad", "icosphere"]
    if quick:
        units = quick_units(sizes, [threads[-1]], sorted({threads[0], threads[-1]}))
    else:
        units = full_units(sizes, threads)

    started = time.monotonic()
    results, left_out, took = [], [], {}
    for name, size, unit_threads, flags, repetitions in units:
        what = (name, *flags)
        before = took.get(what)
        predicted = MARGIN * before[1] * size / before[0] * repetitions / before[2] if before else 0.0
        elapsed = time.monotonic() - started
        if elapsed + predicted > LIMIT[arguments.mode]:
            left_out.append({"program": name, "size": size, "filter": " ".join(flags), "predicted_seconds": predicted})
            print(f"   {name} at {size:,}: left out, it would take about {predicted:.0f} s")
            continue
        print(f"== {name} {size:,} ({elapsed:.0f} s)", flush=True)
        if name == "tool":
            found = run_tool(arguments.build, size, repetitions)
        else:
            extra = [f"--benchmark_repetitions={repetitions}", f"--benchmark_min_time={'0.01' if quick else '0.1'}"]
            found = run_program(arguments.build, name, size, unit_threads, families, extra + flags)
        results += found
        took[what] = (size, time.monotonic() - started - elapsed, repetitions)

    report = {
        "machine": {"cores": cores, "processor": bench_report.processor(), "system": platform.platform()},
        "mode": arguments.mode,
        "load_at_end": os.getloadavg()[0],
        "seconds": time.monotonic() - started,
        "left_out": left_out,
        "results": bench_report.medians(results),
    }
    (arguments.out / "bench.json").write_text(json.dumps(report, indent=1) + "\n")
    bench_report.write_all(report, arguments.out)
    print((arguments.out / "targets.md").read_text())
    print(f"Everything is in {arguments.out} ({report['seconds']:.0f} s)")


if __name__ == "__main__":
    main()
