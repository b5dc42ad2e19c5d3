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
import subprocess
import tempfile
import time

import bench_report

LIMIT = {"quick": 170.0, "full": 6 * 3600.0}
# A prediction scales with the size; what is not linear gets this much more.
MARGIN = 1.3
# Seconds at 50,000 triangles of what has not run yet.
GUESS = {"kernels": 5, "tool": 1, "eigen": 12, "connection": 1, "assembly": 2, "pipeline": 5, "linear": 12, "design": 4}
# Bytes per triangle that the tool needs: beyond what is free a size is left out.
TOOL_BYTES = 1000


def quick_units(sizes, most, one_and_most):
    """Once what the table of targets needs, at every size; then everything else where it is short; then the targets
    again, for medians."""
    small = [s for s in sizes if s <= 100000] or sizes[:1]
    middle = [s for s in sizes if s <= 400000] or sizes[:1]

    def targets(size, repetitions):
        return [("eigen", size, most, ["--benchmark_filter=^eigen/.*backend:auto/"], repetitions),
                ("connection", size, most, ["--benchmark_filter=detail:1/"], repetitions),
                ("tool", size, most, [], repetitions)]

    units = [("kernels", small[0], one_and_most, [], 1)]
    for size in sizes:
        units += targets(size, 1)
    for size in small:
        units += [
            ("eigen", size, most, ["--benchmark_filter=^eigen/.*backend:(lan|lob|inv|pol)"], 1),
            ("eigen", size, most, ["--degrees=4", "--benchmark_filter=^eigen_tol"], 1),
            ("linear", size, most, [], 1),
            ("pipeline", size, one_and_most, ["--benchmark_filter=^batch"], 1),
            ("design", size, most, [], 1),
        ]
    large_linear = "product|(setup|solve)/.*multigrid"
    phases = "^(read|half|topo|geom|frames)"
    for size in middle:
        units += [
            ("assembly", size, one_and_most, [], 1),
            ("pipeline", size, one_and_most, ["--benchmark_filter=" + phases], 1),
            ("connection", size, one_and_most[:1], ["--benchmark_filter=detail:1/"], 1),
            ("eigen", size, one_and_most[:1], ["--degrees=4", "--benchmark_filter=^eigen/.*backend:auto/"], 1),
        ]
    for size in small + middle:
        units += targets(size, 2)
    for size in middle:
        units += [("linear", size, most, ["--benchmark_filter=" + part], 1) for part in (large_linear, "backend:cholmod/")]
    for size in sizes:
        if size not in middle:
            units += [("assembly", size, one_and_most, [], 1),
                      ("pipeline", size, one_and_most, ["--benchmark_filter=" + phases], 1),
                      ("linear", size, most, ["--benchmark_filter=" + large_linear], 1)]
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
        try:
            status = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode
        except OSError as error:
            print(f"   {name}: {error}")
            return []
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
    """`alcap field` from PLY to files, n = 4: seconds, CPU seconds and the largest resident set of each run."""
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
        runs = []
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
            runs.append({
                "program": "tool", "phase": "tool", "family": "scan" if level is not None else "torus", "size": faces,
                "n": 4, "threads": os.cpu_count(), "seconds": time.monotonic() - start,
                "cpu_seconds": usage.ru_utime + usage.ru_stime, "peak_bytes": usage.ru_maxrss * 1024,
                "faces": json.loads((out / "report.json").read_text())["mesh"]["faces"],
            })
    return runs


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
        what = (name, len(unit_threads), *flags)
        before = took.get(what, {})
        # From the nearest size that has run, the same one if it has.
        nearest = min(before, key=lambda ran: abs(ran - size), default=None)
        predicted = (MARGIN * before[nearest] * size / nearest * repetitions if before
                     else GUESS[name] * size / 50000 if quick else 0.0)
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
        took.setdefault(what, {})[size] = (time.monotonic() - started - elapsed) / repetitions

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
