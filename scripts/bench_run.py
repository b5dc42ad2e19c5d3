# SPDX-License-Identifier: MIT
"""Runs the benchmark programs and the tool and writes one JSON of all results.

Called by bench.sh. The work is a list of units, each one program at one size, those of the targets first. Before a unit
starts, its time and memory are predicted from the same unit on smaller meshes. If its repetitions do not all fit into the
remaining time, as many as fit are run; a unit that does not fit at all is skipped and listed, so nothing is stopped in the
middle. If a program crashes, only its own numbers are missing. Results are saved after every unit.
"""
import argparse
import json
import math
import os
import pathlib
import platform
import shutil
import subprocess
import tempfile
import time
import typing

import bench_report

MINUTES = {"quick": 3, "full": 360}
# Of the limit, for the tables and plots at the end.
LAST_SECONDS = 10
# A prediction scales with the size, or faster where two sizes have shown that; what they do not show gets this much more.
MARGIN = 1.3
# Seconds at 50,000 triangles of what has not run yet.
GUESS = {"kernels": 5, "tool": 1, "eigen": 12, "heuristic": 2, "connection": 1, "assembly": 2, "pipeline": 5, "linear": 12, "design": 4}
# Bytes per triangle of what has not run yet (700 to 830 were measured), and on disk, for the files of the tool.
MEMORY_BYTES = 1000
DISK_BYTES = 800


class Unit(typing.NamedTuple):
    program: str
    size: int
    threads: list
    families: list
    flags: list
    repetitions: int

    def kind(self):
        """What units of different sizes have in common, without the families."""
        return (self.program, len(self.threads), *self.flags)


def only(pattern):
    return ["--benchmark_filter=" + pattern]


AUTO = only("^eigen/.*backend:auto/")
FIELD = only("^field/.*backend:(auto|heuristic)/")
DEFAULT_DETAIL = only("^connection/.*detail:1/")
PHASES = only("^(read/.*ply|half|topo|geom|frames|indices|write)")
MULTIGRID = only("^product|^linear_(setup|solve)/.*backend:multigrid")


def quick_units(sizes, most, one_and_most):
    """Once what the table of targets needs, at every size; then everything else where it is short; then the targets
    again, for medians."""
    small = [s for s in sizes if s <= 100000] or sizes[:1]
    middle = [s for s in sizes if s <= 400000] or sizes[:1]
    large_linear = "product|(setup|solve)/.*multigrid"
    phases = only("^(read|half|topo|geom|frames|indices|write)")

    def unit(program, size, threads, flags=(), repetitions=1):
        return Unit(program, size, threads, ["jittered"], list(flags), repetitions)

    def targets(size, repetitions):
        return [unit("heuristic", size, most, FIELD, repetitions), unit("eigen", size, most, AUTO, repetitions),
                unit("connection", size, most, DEFAULT_DETAIL, repetitions),
                unit("tool", size, most, [], repetitions)]

    units = [unit("kernels", small[0], one_and_most)]
    for size in sizes:
        units += targets(size, 1)
    for size in small:
        units += [
            unit("eigen", size, most, only("^eigen/.*backend:(lan|lob|inv|pol)")),
            unit("eigen", size, most, ["--degrees=4", *only("^eigen_tol")]),
            unit("linear", size, most),
            unit("pipeline", size, one_and_most, only("^batch")),
            unit("design", size, most),
        ]
    for size in middle:
        units += [
            unit("assembly", size, one_and_most),
            unit("pipeline", size, one_and_most, phases),
            unit("connection", size, one_and_most[:1], DEFAULT_DETAIL),
            unit("connection", size, most, only("detail:0.01/")),
            unit("eigen", size, one_and_most[:1], ["--degrees=4", *AUTO]),
        ]
    for size in small + middle:
        units += targets(size, 2)
    for size in middle:
        units += [unit("linear", size, most, only(part)) for part in (large_linear, "backend:cholmod/")]
    for size in sizes:
        if size not in middle:
            units += [unit("assembly", size, one_and_most), unit("pipeline", size, one_and_most, phases),
                      unit("linear", size, most, only(large_linear))]
    return units


def full_units(sizes, threads):
    """The table of targets at every size, its last rows (ratios and growth) at every size, then all the rest from small
    to large. Fields with matrices in hand and connections are taken on jittered spheres, beyond 1.4 million triangles on
    noisy scans, and on scans below as well from 300,000 on, for the growth."""
    two = [min(2, threads[-1])]
    one_and_two = sorted({threads[0], two[0]})
    families = ["jittered", "torus", "scan", "cad", "icosphere"]
    is_scan = lambda size: bench_report.level_of(size) is not None and size > 300000
    by_size = lambda size: (["jittered"] if size < 1400000 else []) + (["scan"] if is_scan(size) or size >= 1400000 else [])

    units = [Unit("kernels", sizes[0], one_and_two, ["jittered"], [], 5),
             Unit("pipeline", sizes[0], one_and_two, ["jittered"], only("^batch"), 5)]
    for size in sizes:
        for family in by_size(size):
            units += [Unit("heuristic", size, two, [family], FIELD, 5), Unit("eigen", size, two, [family], AUTO, 5),
                      Unit("connection", size, two, [family], DEFAULT_DETAIL, 5)]
        units.append(Unit("tool", size, two, [], [], 5))
    for size in sizes:
        family = by_size(size)[-1:]
        units += [Unit("assembly", size, one_and_two, family, [], 5),
                  Unit("linear", size, two, family, MULTIGRID, 5),
                  Unit("pipeline", size, two, family, PHASES, 5)]
        if size < 1400000:
            units.append(Unit("connection", size, two, by_size(size)[:1], only("detail:0.01/"), 5))

    # Program, which of its benchmarks, up to which size: direct solvers and hundreds of solves only waste time beyond.
    rest = [("eigen", AUTO, math.inf), ("eigen", only("-" + AUTO[0].split("=")[1]), 400000), ("connection", [], math.inf),
            ("assembly", [], math.inf), ("pipeline", only("-^batch"), math.inf), ("linear", MULTIGRID, math.inf),
            ("linear", only("^linear_[^t].*backend:cholmod"), math.inf),
            ("linear", only("^linear_tolerance|^linear_solve8/.*multigrid|backend:eigen"), 400000), ("design", [], math.inf)]
    for size in sizes:
        units += [Unit(program, size, threads, [family], flags, 5)
                  for program, flags, largest in rest if size <= largest for family in families]
    return units


class Costs:
    """What units took, and from that what others will."""

    def __init__(self):
        self.ran = {}

    def add(self, unit, repetitions, fixed, timed, peak_bytes):
        sizes = self.ran.setdefault(unit.kind(), {}).setdefault(tuple(unit.families), {})
        sizes[unit.size] = {"repetitions": repetitions, "fixed": fixed, "each": timed / repetitions, "bytes": peak_bytes}

    def before(self, unit):
        """Size -> cost of the same families, or else of others."""
        of_kind = self.ran.get(unit.kind(), {})
        return of_kind.get(tuple(unit.families)) or next(iter(of_kind.values()), {})

    def nearest(self, unit):
        """The nearest size that has run, the same one if it has."""
        return min(self.before(unit).items(), key=lambda ran: abs(ran[0] - unit.size), default=(0, None))

    def seconds(self, unit, repetitions):
        size, cost = self.nearest(unit)
        if not cost:
            # However small the mesh, a benchmark is repeated for a while.
            return GUESS[unit.program] * max(1.0, unit.size / 50000) * len(unit.threads) * repetitions
        # Outside of what is timed some work is done once and some in every repetition.
        seconds = lambda c: c["fixed"] * max(1.0, repetitions / c["repetitions"]) + c["each"] * repetitions
        exponent = 1.0
        for smaller, its in self.before(unit).items():
            if smaller < size < unit.size:
                slope = math.log(seconds(cost) / seconds(its)) / math.log(size / smaller)
                exponent = max(exponent, min(slope, 2.0))
        return MARGIN * seconds(cost) * (unit.size / size) ** exponent

    def bytes(self, unit):
        size, cost = self.nearest(unit)
        return 1.1 * cost["bytes"] * unit.size / size if cost else MEMORY_BYTES * unit.size


def memory_available():
    try:
        for line in pathlib.Path("/proc/meminfo").read_text().splitlines():
            if line.startswith("MemAvailable:"):
                return 1024 * int(line.split()[1])
    except OSError:
        pass
    return 1 << 62


def wait_for(child):
    """Exit code and the system's account of a child: CPU seconds, peak memory."""
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    return child.returncode, usage


def run_program(build, unit, repetitions, min_time):
    """The benchmarks of one program, with their names taken apart (empty when it fails), seconds of them that were timed,
    and the peak memory."""
    with tempfile.NamedTemporaryFile(suffix=".json") as out:
        command = [
            str(build / "perf" / f"perf_{unit.program}"),
            f"--faces={unit.size}",
            f"--threads={','.join(map(str, unit.threads))}",
            f"--families={','.join(unit.families)}",
            f"--benchmark_repetitions={repetitions}",
            f"--benchmark_min_time={min_time}",
            f"--benchmark_out={out.name}",
            "--benchmark_out_format=json",
            *unit.flags,
        ]
        try:
            child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        except OSError as error:
            print(f"   {unit.program}: {error}")
            return [], 0.0, 0
        status, usage = wait_for(child)
        if status != 0:
            print(f"   {unit.program} at {unit.size:,} ended with {status}: what it had finished is kept")
        text = pathlib.Path(out.name).read_text()
    try:
        found = json.loads(text)["benchmarks"]
    except ValueError:
        found = salvage(text)
    found = [b for b in found if b.get("run_type") != "aggregate"]
    results = [bench_report.result_of(unit.program, b) for b in found]
    timed = sum(r["seconds"] * b["iterations"] for r, b in zip(results, found))
    return results, timed, usage.ru_maxrss * 1024


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


def run_tool(build, unit, repetitions):
    """`alcap field` from PLY to files, n = 4: the same as run_program."""
    level = bench_report.level_of(unit.size)
    across = round((unit.size / 4) ** 0.5)
    tool = build / "apps" / "alcap" / "alcap"
    runs = []
    with tempfile.TemporaryDirectory() as folder:
        mesh = pathlib.Path(folder) / "mesh.ply"
        kind = f"torus:{2 * across},{across}" if level is None else f"scan:{level},0.1"
        if subprocess.run([tool, "make", kind, "-o", mesh, "--quiet"], check=False).returncode != 0:
            print(f"   tool at {unit.size:,}: no mesh")
            return [], 0.0, 0
        for _ in range(repetitions):
            start = time.monotonic()
            out = pathlib.Path(folder) / "out"
            status, usage = wait_for(subprocess.Popen(
                [tool, "field", mesh, "-n", "4", "--tolerance", "1e-6", "-o", out, "--quiet", "--threads",
                 str(unit.threads[-1])], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
            seconds = time.monotonic() - start
            if status not in (0, 5):
                print(f"   tool at {unit.size:,} ended with {status}")
                break
            report = json.loads((out / "report.json").read_text())
            runs.append({
                "program": "tool", "phase": "tool", "family": "scan" if level is not None else "torus", "size": unit.size,
                "n": 4, "threads": unit.threads[-1], "seconds": seconds, "cpu_seconds": usage.ru_utime + usage.ru_stime,
                "peak_bytes": usage.ru_maxrss * 1024, "faces": report["mesh"]["faces"],
                **{f"{phase} s": took for phase, took in report["times"].items() if phase != "total"},
            })
            shutil.rmtree(out)  # 13 GB at 21 million triangles
    return runs, sum(r["seconds"] for r in runs), max((r["peak_bytes"] for r in runs), default=0)


def lacking(unit, costs):
    """Why this machine cannot run it, or None."""
    needed = costs.bytes(unit)
    if needed > memory_available():
        return f"{needed / 1e9:.1f} GB of memory"
    if unit.program == "tool" and unit.size * DISK_BYTES > shutil.disk_usage(tempfile.gettempdir()).free:
        return f"{unit.size * DISK_BYTES / 1e9:.1f} GB in {tempfile.gettempdir()}"
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--mode", choices=["quick", "full"], default="quick")
    parser.add_argument("--minutes", type=float)
    parser.add_argument("--sizes")
    parser.add_argument("--threads")
    arguments = parser.parse_args()
    quick = arguments.mode == "quick"
    limit = 60 * (arguments.minutes or MINUTES[arguments.mode]) - LAST_SECONDS
    cores = os.cpu_count() or 1
    numbers = lambda text: sorted({int(v) for v in text.split(",")})
    sizes = [50000, 327680, 1310720] if quick else [20480, 50000, 81920, 327680, 1310720, 5242880, 20971520]
    if arguments.sizes:
        sizes = numbers(arguments.sizes)
    threads = numbers(arguments.threads) if arguments.threads else sorted({1, min(2, cores), cores})
    if quick:
        units = quick_units(sizes, [threads[-1]], sorted({threads[0], threads[-1]}))
    else:
        units = full_units(sizes, threads)

    machine, load = bench_report.machine(arguments.build, cores), os.getloadavg()[0]
    print(bench_report.machine_text(machine, load), flush=True)
    started = time.monotonic()
    results, left_out, costs = [], [], Costs()

    def report():
        return {
            "machine": machine,
            "mode": arguments.mode,
            "load_at_start": load,
            "load_at_end": os.getloadavg()[0],
            # Something else was running: times are upper bounds.
            "under_load": load > 0.3 * cores,
            "seconds": time.monotonic() - started,
            "left_out": left_out,
            "results": bench_report.medians(results),
        }

    def write(finished):
        (arguments.out / "bench.json").write_text(json.dumps(finished, indent=1) + "\n")

    for unit in units:
        elapsed = time.monotonic() - started
        what = f"{' '.join([unit.program, *unit.families])} {unit.size:,}"
        # As many repetitions as fit.
        repetitions = next((r for r in range(unit.repetitions, 0, -1) if elapsed + costs.seconds(unit, r) <= limit), 0)
        predicted = costs.seconds(unit, max(repetitions, 1))
        lacks = lacking(unit, costs) or (None if repetitions else f"about {predicted:.0f} s")
        if lacks:
            left_out.append({"program": unit.program, "size": unit.size, "filter": " ".join(unit.families + unit.flags),
                             "predicted_seconds": predicted, "lacks": lacks})
            print(f"   {what}: left out, it would take {lacks}")
            continue
        fewer = f", {repetitions} of {unit.repetitions} repetitions" if repetitions < unit.repetitions else ""
        print(f"== {what}{fewer} ({elapsed:.0f} s)", flush=True)
        if unit.program == "tool":
            found, timed, peak = run_tool(arguments.build, unit, repetitions)
        else:
            found, timed, peak = run_program(arguments.build, unit, repetitions, 0.01 if quick else 0.1)
        results += found
        if found:
            costs.add(unit, repetitions, max(0.0, time.monotonic() - started - elapsed - timed), timed, peak)
        write(report())

    finished = report()
    write(finished)
    bench_report.write_all(finished, arguments.out)
    print((arguments.out / "targets.md").read_text())
    if finished["under_load"]:
        print(f"The machine was not idle (load {load:.1f} at the start): these times are upper bounds.")
    if left_out:
        print("Left out: " + "; ".join(f"{l['program']} {l['size']:,} {l['filter']}".strip() for l in left_out))
    print(f"Everything is in {arguments.out} ({finished['seconds']:.0f} s)")


if __name__ == "__main__":
    main()
