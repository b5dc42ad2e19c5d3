# SPDX-License-Identifier: MIT
"""Tables (Markdown, CSV) and plots (SVG) from the results of bench_run.py. By hand: bench_report.py bench.json FOLDER."""
import csv
import datetime
import json
import math
import os
import pathlib
import platform
import re
import statistics
import subprocess
import sys

import bench_plot
from bench_targets import find, seconds, targets_table

# LTGD 2016, Sec. 8.3: 50K triangles, seconds.
PAPER = {"connection": 1.5, "eigen n=1": 1.0, "design_prepare": 5.0, "design_target": 0.5}


def level_of(faces):
    """Subdivision level of the sphere with exactly so many faces, or None."""
    level = round(math.log(faces / 20, 4))
    return level if 20 * 4**level == faces else None


def first_line(command, folder=None):
    try:
        return subprocess.run(command, capture_output=True, text=True, cwd=folder, check=True).stdout.splitlines()[0].strip()
    except (OSError, subprocess.CalledProcessError, IndexError):
        return "unknown"


def machine(build, cores):
    """What ran, and on what: for the report and the plots."""
    cache = build / "CMakeCache.txt"
    found = [l.split("=", 1)[1] for l in cache.read_text().splitlines() if l.startswith("CMAKE_CXX_COMPILER:")] if cache.exists() else []
    try:
        memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9
    except (OSError, ValueError):
        memory = 0
    source = pathlib.Path(__file__).resolve().parent.parent
    return {"cores": cores, "processor": processor(), "system": platform.platform(), "memory_gb": round(memory, 1),
            "compiler": first_line([found[0], "--version"]) if found else "unknown",
            "commit": first_line(["git", "describe", "--always", "--dirty"], source),
            "date": datetime.date.today().isoformat()}


def machine_text(m, load):
    return (f"{m['processor']}, {m['cores']} cores, {m['memory_gb']:.0f} GB, {m['system']}\n"
            f"{m['compiler']}, commit {m['commit']}, load {load:.1f}")


def processor():
    try:
        for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return "unknown"


def result_of(program, benchmark):
    """Google Benchmark's entry as a flat dictionary; the name is PHASE/family/size/key:value/... ."""
    parts = [p for p in benchmark["name"].split("/") if p not in ("process_time", "real_time", "machine")]
    scale = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}[benchmark["time_unit"]]
    result = {"program": program, "phase": parts[0], "seconds": benchmark["real_time"] * scale,
              "cpu_seconds": benchmark["cpu_time"] * scale}
    for part in parts[1:]:
        if ":" in part:
            key, value = part.split(":", 1)
            result[key] = int(value) if re.fullmatch(r"-?\d+", value) else value
        elif part.isdigit():
            result["size"] = int(part)
        else:
            result["family"] = part
    for key in ("faces", "vertices", "its", "residual", "GB/s", "GFlop/s", "bytes/vertex", "sweeps", "ns/triangle",
                "ns/triangle/its", "rows", "meshes/s", "bad", "converged", "singularities", "angle", "mesh s", "connection s", "assembly s", "eigen s", "analysis s"):
        if key in benchmark:
            result[key] = benchmark[key]
    if "label" in benchmark:
        result["label"] = benchmark["label"]
    return result


def key_of(result):
    return tuple(result.get(k) for k in ("phase", "family", "size", "n", "backend", "tolerance", "detail", "isa", "form",
                                            "threads"))


def medians(results):
    """Repetitions become one result with the medians of the times."""
    groups = {}
    for result in results:
        groups.setdefault(key_of(result), []).append(result)
    merged = []
    for group in groups.values():
        one = dict(group[-1])
        one["seconds"] = statistics.median(r["seconds"] for r in group)
        one["cpu_seconds"] = statistics.median(r["cpu_seconds"] for r in group)
        one["repetitions"] = len(group)
        for key in one:
            if key.endswith(" s") or key == "meshes/s":
                one[key] = statistics.median(r[key] for r in group)
        if "peak_bytes" in one:
            one["peak_bytes"] = max(r["peak_bytes"] for r in group)
        merged.append(one)
    return merged


def paper_table(report):
    results, lines = report["results"], ["| at about 50K triangles | paper (Sec. 8.3) | here |", "| --- | ---: | ---: |"]
    for what, paper in PAPER.items():
        phase = what.split()[0]
        found = [r for r in find(results, phase=phase, size=50000) if r.get("n", 1) in (1, 4) and
                 r.get("backend", "auto") == "auto" and r.get("detail", 1) == 1]
        if found:
            lines.append(f"| {phase} | {paper} s | {seconds(min(r['seconds'] for r in found))} |")
    return "\n".join(lines) + "\n"


def baseline_table(report):
    """Ours against inverse iteration, from the same run."""
    lines = ["| triangles | n | method | seconds (CPU) | residual | times ours |", "| ---: | ---: | --- | ---: | ---: | ---: |"]
    eigen = find(report["results"], phase="eigen")
    most = max((r["threads"] for r in eigen), default=1)
    for r in eigen:
        if r["threads"] != most:
            continue
        ours = find(eigen, size=r["size"], n=r["n"], family=r["family"], threads=most, backend="auto")
        ratio = f"{r['cpu_seconds'] / ours[0]['cpu_seconds']:.1f}" if ours else ""
        lines.append(f"| {r['size']:,} | {r['n']} | {r['backend']} | {r['seconds']:.3g} ({r['cpu_seconds']:.3g}) | "
                     f"{r['residual']:.1e} | {ratio} |")
    return "\n".join(lines) + "\n"


def limits(report, threads):
    """What the machine gives: GB/s of a triad, GFlop/s in double and in single precision."""
    best = lambda phase, key: max((r.get(key, 0) for r in find(report["results"], phase=phase, threads=threads)), default=0)
    return best("triad", "GB/s"), best("peak", "GFlop/s"), best("peak_float", "GFlop/s")


def kernels_table(report):
    """One thread: packs against scalars, float against double, series against closed forms."""
    triad, peak, peak_float = limits(report, 1)
    lines = [f"One thread. Triad {triad:.1f} GB/s, peak {peak:.0f} GFlop/s in double and {peak_float:.0f} in single "
             "precision. A sine counts as one operation.", "",
             "| kernel | precision | instructions | form | ns per simplex | GB/s (of triad) | GFlop/s (of peak) | times scalar |",
             "| --- | --- | --- | --- | ---: | ---: | ---: | ---: |"]
    for r in report["results"]:
        if "ns/triangle" not in r:
            continue
        scalar = find(report["results"], phase=r["phase"], family=r["family"], form=r.get("form"), isa="scalar")
        top = peak_float if r["family"] == "float" else peak
        rate = f"{r['GFlop/s']:.1f} ({100 * r['GFlop/s'] / top:.0f} %)" if "GFlop/s" in r and top else ""
        bandwidth = f"{r['GB/s']:.1f} ({100 * r['GB/s'] / triad:.0f} %)" if triad else ""
        name = {"kernels": "stiffness and mass", "edge_integral": "edge integral"}.get(r["phase"], r["phase"])
        lines.append(f"| {name} | {r['family']} | {r['isa']} | {r.get('form', '')} | {r['ns/triangle']:.2f} | {bandwidth} | "
                     f"{rate} | {scalar[0]['ns/triangle'] / r['ns/triangle']:.1f} |")
    return "\n".join(lines) + "\n"


def backends_table(report):
    """Every backend at every size: time, work in matrix products, memory, exactness."""
    lines = ["Most threads. A sweep is one product with the matrix in double.", "",
             "| what | triangles | backend | seconds (CPU) | iterations | sweeps | bytes per vertex | residual |",
             "| --- | ---: | --- | ---: | ---: | ---: | ---: | ---: |"]
    rows = [r for r in report["results"] if "sweeps" in r and not r["phase"].endswith("tolerance")]
    most = max((r["threads"] for r in rows), default=1)
    for r in rows:
        if r["threads"] != most:
            continue
        what = r["phase"] + (f", n = {r['n']}" if "n" in r else "") + f", {r['family']}"
        residual = f"{r['residual']:.1e}" if "residual" in r else ""
        lines.append(f"| {what} | {r['faces']:,.0f} | {r['backend']} | {r['seconds']:.3g} ({r['cpu_seconds']:.3g}) | "
                     f"{r.get('its', 0):.0f} | {r['sweeps']:.0f} | {r['bytes/vertex']:.0f} | {residual} |")
    return "\n".join(lines) + "\n"


def left_out_table(report):
    lines = [f"- {u['program']} {u['filter']} at {u['size']:,}: {u['lacks']}"
             for u in report.get("left_out", [])]
    return "\n".join(lines or ["Nothing."]) + "\n"


def phases_table(report):
    lines = ["| phase | triangles | 1 thread | most threads | speedup | ns CPU/triangle | its | residual |",
             "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"]
    results = [r for r in report["results"] if "size" in r and r["phase"] != "tool"]
    most = max((r["threads"] for r in results), default=1)
    for r in results:
        if r["threads"] != most:
            continue
        one = [o for o in results if key_of(o)[:-1] == key_of(r)[:-1] and o["threads"] == 1]
        speedup = f"{one[0]['seconds'] / r['seconds']:.2f}" if one and most > 1 else ""
        first = seconds(one[0]["seconds"]) if one else ""
        name = " ".join(str(v) for v in [r["phase"], r["family"], r.get("backend", ""),
                                         f"n={r['n']}" if "n" in r else "", f"detail={r['detail']}" if "detail" in r else ""] if v)
        residual = f"{r['residual']:.1e}" if "residual" in r else ""
        lines.append(f"| {name} | {r.get('faces', r['size']):,.0f} | {first} | {seconds(r['seconds'])} | {speedup} | "
                     f"{1e9 * r['cpu_seconds'] / r.get('faces', r['size']):.0f} | {r.get('its', '')} | {residual} |")
    return "\n".join(lines) + "\n"


def write_all(report, folder):
    (folder / "targets.md").write_text(targets_table(report))
    (folder / "tables.md").write_text(
        "# Targets\n\n" + targets_table(report) + "\n# The paper's times\n\n" + paper_table(report) +
        "\n# Against inverse iteration, ratios of CPU seconds\n\n" + baseline_table(report) + "\n# Backends\n\n" +
        backends_table(report) + "\n# Kernels\n\n" + kernels_table(report) + "\n# Phases\n\n" + phases_table(report) +
        "\n# Left out for lack of time or memory\n\n" + left_out_table(report))
    keys = sorted({k for r in report["results"] for k in r})
    with open(folder / "results.csv", "w", newline="") as out:
        writer = csv.DictWriter(out, keys)
        writer.writeheader()
        writer.writerows(report["results"])
    for name, svg in bench_plot.plots(report).items():
        (folder / f"{name}.svg").write_text(svg)


if __name__ == "__main__":
    write_all(json.loads(pathlib.Path(sys.argv[1]).read_text()), pathlib.Path(sys.argv[2]))
