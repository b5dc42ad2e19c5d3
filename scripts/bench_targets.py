# SPDX-License-Identifier: MIT
"""The project's performance targets, and their table of targets and measured values for bench_report.py."""

# Seconds on two cores, median, and bytes.
TARGETS = {
    50000: {"field": 0.09, "eigen n=1": 0.03, "eigen n=4": 0.05, "tool": 0.25, "memory": 100e6, "connection": 0.05},
    327680: {"field": 0.65, "eigen n=1": 0.25, "eigen n=4": 0.35, "tool": 1.0, "memory": 350e6},
    1310720: {"field": 2.6, "eigen n=1": 1.0, "eigen n=4": 1.7, "tool": 3.5, "memory": 600e6, "connection": 1.2},
    5242880: {"eigen n=1": 4.5, "eigen n=4": 8.0, "tool": 17.0, "memory": 5e9},
    20971520: {"eigen n=1": 20.0, "eigen n=4": 33.0, "tool": 70.0, "memory": 9e9},
}
# Of one edit of a design, n = 4, by size: the phase, what it is, and its seconds.
DESIGN = {
    50000: [("design_target", "turn a target", 0.001), ("design_turn_pinned", "turn a pinned target", 0.001),
            ("design_move", "move a target to the next face", 0.01), ("design_stroke", "move a stroke of 40 points", 0.025)],
    1310720: [("design_target", "turn a target", 0.025), ("design_turn_pinned", "turn a pinned target", 0.025),
              ("design_move", "move a target to the next face", 0.3)],
}
# Meshes a second on two cores, n = 4: the phase, their triangles, what it is, the target (None: a figure of its own).
BATCHES = [("batch", "2K to 10K", "in memory", 150), ("batch_files", "2K to 10K", "from PLY to PLY", None),
           ("batch_1k", "1K", "in memory", 1000)]
# Bytes a second from a file in memory to a mesh.
READ = {"ply": 1e9, "obj": 500e6}
# Assembly of S and M against a parallel copy of their values, and on two threads against one.
ASSEMBLY_COPIES, ASSEMBLY_SPEEDUP = 2.5, 1.7
# A linear solve to 1e-8 is counted as the setup and this many cycles.
CYCLES = 12
# The global connection at detail 0.01 against 1.
DETAIL = 2
# Seconds per triangle at the largest size against those at the first of these, every phase.
GROWTH, GROWTH_FROM = 1.15, 327680
# Phases that must grow so, by what their results share; of the tool each phase that it reports, and all of it.
GROWING = [
    *[{"phase": phase} for phase in ("read", "halfedges", "topology", "geometry", "frames", "pattern", "assembly", "indices", "write")],
    {"phase": "connection", "detail": 1},
    {"phase": "eigen", "backend": "auto", "n": 1},
    {"phase": "eigen", "backend": "auto", "n": 4},
    {"phase": "linear_setup", "backend": "multigrid"},
    {"phase": "linear_solve", "backend": "multigrid"},
]


def find(results, **wanted):
    return [r for r in results if all(r.get(k) == v for k, v in wanted.items())]


def seconds(value):
    return f"{value:.3g} s"


def of_target(found):
    """Targets are held against jittered spheres, beyond 1.4 million triangles against noisy scans, if those have run."""
    wanted = lambda r: r.get("family") == ("jittered" if r["size"] < 1400000 else "scan")
    return next((r for r in found if wanted(r)), found[0] if found else None)


def runs(*of):
    return min(r.get("repetitions", 1) for r in of)


def row(size, what, target, measured, ratio, repetitions, residual=""):
    ratio = "" if ratio is None else f"{ratio:.2f}"
    return f"| {size} | {what} | {target} | {measured} | {ratio} | {repetitions} | {residual} |"


def on_mesh(result):
    """The family, and the number of triangles where it is not that of the target."""
    faces = result.get("faces", result["size"])
    return result["family"] + (f" of {faces:,.0f}" if faces != result["size"] else "")


def size_rows(results, threads):
    for size, targets in TARGETS.items():
        for what, target in targets.items():
            if what in ("tool", "memory"):
                found = find(results, phase="tool", size=size)
            elif what == "field":
                found = find(results, phase="field", size=size, threads=threads, n=4, backend="auto")
            elif what == "connection":
                found = find(results, phase="connection", size=size, threads=threads, detail=1)
            else:
                found = find(results, phase="eigen", size=size, threads=threads, n=int(what[-1]), backend="auto")
            best = of_target(found)
            if not best:
                continue
            name = {"tool": "whole `alcap field`, n = 4", "memory": "peak memory of it",
                    "field": "connection to 1e-6, S and M, eigen to 0.01 degrees, n = 4"}.get(what, what) + ", " + on_mesh(best)
            if what == "memory":
                yield row(f"{size:,}", name, f"{target / 1e6:.0f} MB", f"{best['peak_bytes'] / 1e6:.0f} MB",
                          target / best["peak_bytes"], runs(best))
            else:
                residual = f"{best['residual']:.1e}" if "residual" in best else ""
                yield row(f"{size:,}", name, seconds(target), f"{seconds(best['seconds'])} ({best['cpu_seconds']:.3g})",
                          target / best["seconds"], runs(best), residual)


def batch_rows(results, threads):
    for phase, faces, what, target in BATCHES:
        for batch in find(results, phase=phase, threads=threads)[:1]:
            bad = f", {batch['bad']:.0f} not solved" if batch.get("bad") else ""
            yield row(faces, f"batch {what}, n = 4 ({batch['faces']:,.0f} triangles on average{bad})",
                      f"{target} meshes/s" if target else "", f"{batch['meshes/s']:.0f} meshes/s",
                      batch["meshes/s"] / target if target else None, runs(batch))


def read_rows(results, threads):
    for extension, target in READ.items():
        for read in find(results, phase="read", backend=extension, threads=threads, size=GROWTH_FROM)[:1]:
            yield row(f"{read['size']:,}", f"reading {extension.upper()}", f"{target / 1e6:.0f} MB/s",
                      f"{read['GB/s'] * 1000:.0f} MB/s", read["GB/s"] * 1e9 / target, runs(read))


def design_rows(results, threads):
    for size, edits in DESIGN.items():
        for phase, what, target in edits:
            found = find(results, phase=phase, size=size, threads=threads)
            if found:
                best = next((r for r in found if r["family"] == "icosphere"), found[0])
                yield row(f"{size:,}", f"design, {what}, {on_mesh(best)}", seconds(target),
                          f"{seconds(best['seconds'])} ({best['cpu_seconds']:.3g})", target / best["seconds"], runs(best))


def ratio_rows(results, threads):
    """Targets that are ratios of two measurements on the same mesh, and cycles."""
    sizes = sorted({r["size"] for r in results if "size" in r})

    def pairs(one, other):
        """The results that agree with `one`, and for each that of the same mesh that agrees with `other`."""
        for size in sizes:
            both = [(a, b) for a in find(results, size=size, **one) for b in find(results, size=size, **other)
                    if a["family"] == b["family"]]
            a = of_target([a for a, _ in both])
            if a:
                yield a, next(b for first, b in both if first is a)

    for a, copy in pairs({"phase": "assembly", "threads": threads}, {"phase": "assembly_copy", "threads": threads}):
        times = a["seconds"] / copy["seconds"]
        yield row(f"{a['size']:,}", f"S and M against a copy of their values, {on_mesh(a)}", f"{ASSEMBLY_COPIES} times",
                  f"{times:.2f} times", ASSEMBLY_COPIES / times, runs(a, copy))
    if threads > 1:
        for a, one in pairs({"phase": "assembly", "threads": threads}, {"phase": "assembly", "threads": 1}):
            speedup = one["seconds"] / a["seconds"]
            yield row(f"{a['size']:,}", f"S and M, speedup on {threads} threads, {on_mesh(a)}", f"{ASSEMBLY_SPEEDUP} times",
                      f"{speedup:.2f} times", speedup / ASSEMBLY_SPEEDUP, runs(a, one))
    # What the heuristics of remeshers do, and a field that is an eigenvector to a known angle.
    for a, heuristic in pairs({"phase": "field", "backend": "auto", "threads": threads},
                              {"phase": "field", "backend": "heuristic", "threads": threads}):
        times = a["seconds"] / heuristic["seconds"]
        yield row(f"{a['size']:,}", f"field against the heuristic ({a['singularities']:.0f} singularities, "
                  f"{heuristic['singularities']:.0f}), {on_mesh(a)}", "1 times", f"{times:.2f} times", 1 / times,
                  runs(a, heuristic))
    for size in sizes:
        a = of_target(find(results, phase="linear_solve", backend="multigrid", size=size, threads=threads))
        if a:
            yield row(f"{size:,}", f"linear solve to 1e-8, cycles beside setup, {on_mesh(a)}", CYCLES, f"{a['its']:.0f}",
                      CYCLES / a["its"], runs(a), f"{a['residual']:.1e}")
    for a, usual in pairs({"phase": "connection", "detail": "0.01", "threads": threads},
                          {"phase": "connection", "detail": 1, "threads": threads}):
        times = a["seconds"] / usual["seconds"]
        yield row(f"{a['size']:,}", f"connection, detail 0.01 against 1, {on_mesh(a)}", f"{DETAIL} times", f"{times:.2f} times",
                  DETAIL / times, runs(a, usual))


def growth_rows(results, threads):
    """Against linear growth, on the family that reaches the largest size."""
    def growth(wanted, key, name):
        found = [r for r in find(results, **wanted) if key in r and r.get("backend", "ply") in ("ply", "auto", "multigrid")]
        starts = {r["family"]: r for r in found if r["size"] == GROWTH_FROM}
        ends = [r for r in found if r["size"] > GROWTH_FROM and r["family"] in starts]
        if ends:
            end = max(ends, key=lambda r: r["size"])
            start = starts[end["family"]]
            times = end[key] / end["faces"] / (start[key] / start["faces"])
            yield row(f"{GROWTH_FROM:,} to {end['size']:,}", f"growth of {name} against linear, {end['family']}", f"{GROWTH} times",
                      f"{times:.2f} times", GROWTH / times, runs(start, end))

    for wanted in GROWING:
        yield from growth({**wanted, "threads": threads}, "seconds", " ".join(
            wanted["phase"].split("_") + [f"{k}={wanted[k]}" for k in ("n", "detail") if k in wanted]))
    phases = sorted({k for r in find(results, phase="tool") for k in r if k.endswith(" s")})
    for key in phases:
        yield from growth({"phase": "tool"}, key, f"`alcap field`, {key[:-2]}")
    yield from growth({"phase": "tool"}, "seconds", "`alcap field`, all of it")


def targets_table(report):
    results = report["results"]
    eigen = find(results, phase="eigen", backend="auto")
    most = max((r["threads"] for r in eigen), default=1)
    threads = 2 if any(r["threads"] == 2 for r in eigen) else most
    triad = max((r.get("GB/s", 0) for r in find(results, phase="triad", threads=threads)), default=0)
    lines = [f"Wall seconds, {threads} threads; in brackets CPU seconds. Triad of this run: {triad:.1f} GB/s. "
             "target / measured above 1 is better than asked.", "",
             "| triangles | what | target | measured (CPU) | target / measured | runs | residual |",
             "| ---: | --- | ---: | ---: | ---: | ---: | ---: |",
             *size_rows(results, threads), *batch_rows(results, threads), *read_rows(results, threads),
             *design_rows(results, threads), *ratio_rows(results, threads),
             *growth_rows(results, threads)]
    return "\n".join(lines) + "\n"
