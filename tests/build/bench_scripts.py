# SPDX-License-Identifier: MIT
"""bench_compare.py and bench_report.py on reports made here: what is slower, and what the tables hold."""
import json
import pathlib
import subprocess
import sys
import tempfile

scripts = pathlib.Path(__file__).resolve().parents[2] / "scripts"


def result(phase, size, seconds, **more):
    return {"program": phase, "phase": phase, "family": "jittered", "size": size, "threads": 2, "seconds": seconds,
            "cpu_seconds": 2 * seconds, "faces": size, "vertices": size // 2, "bytes/vertex": 400, "repetitions": 1} | more


def report(*results):
    return {"machine": {"cores": 2, "processor": "none", "system": "none"}, "mode": "quick", "load_at_end": 0.0,
            "seconds": 1.0, "left_out": [], "results": list(results)}


def compare(old, new, *flags):
    with tempfile.TemporaryDirectory() as folder:
        files = [pathlib.Path(folder) / name for name in ("old.json", "new.json")]
        for file, content in zip(files, (old, new)):
            file.write_text(json.dumps(content))
        return subprocess.run([sys.executable, "-B", scripts / "bench_compare.py", *files, *flags], capture_output=True, text=True)


def check(what, holds):
    if not holds:
        raise SystemExit(f"not so: {what}")


eigen = {"n": 4, "backend": "auto", "its": 9}
old = report(result("eigen", 50000, 0.1, residual=1e-7, **eigen), result("assembly", 50000, 0.001))
same = compare(old, old)
check("equal reports differ in nothing", same.returncode == 0 and "slower or less exact: 0" in same.stdout)


def changed(seconds=0.1, assembly=0.001, residual=1e-7):
    return report(result("eigen", 50000, seconds, residual=residual, **eigen), result("assembly", 50000, assembly))


check("slower beyond both thresholds is worse", compare(old, changed(seconds=0.2)).returncode == 1)
check("faster is not worse", compare(old, changed(seconds=0.05)).returncode == 0)
check("twice a millisecond is below the absolute threshold", compare(old, changed(assembly=0.002)).returncode == 0)
check("five percent are below the relative threshold", compare(old, changed(seconds=0.105)).returncode == 0)
check("thresholds can be set", compare(old, changed(seconds=0.105), "--relative=0.01", "--absolute=0.001").returncode == 1)
check("a residual that grew is worse", compare(old, changed(residual=1e-5)).returncode == 1)
check("a residual that is no number is worse", compare(old, changed(residual=float("nan"))).returncode == 1)
check("what is gone is named", "assembly" in compare(old, report(*old["results"][:1])).stdout)

with tempfile.TemporaryDirectory() as folder:
    file = pathlib.Path(folder) / "bench.json"
    file.write_text(json.dumps(report(result("eigen", 50000, 0.025, residual=1e-7, **eigen),
                                      result("design_turn_pinned", 50000, 0.002))))
    subprocess.run([sys.executable, "-B", scripts / "bench_report.py", file, folder], check=True)
    rows = [line for line in (pathlib.Path(folder) / "targets.md").read_text().splitlines() if line.startswith("| 50,000 ")]
    # Asked for: 0.05 s.
    check("the table has target / measured", any("0.025" in row and "2.00" in row for row in rows))
    check("and that of edits", any("turn a pinned target" in row and "0.50" in row for row in rows))
    check("results go into the table of values", "jittered" in (pathlib.Path(folder) / "results.csv").read_text())

sys.path.insert(0, str(scripts))
import bench_plot  # noqa: E402

drawn = bench_plot.log_plot("Time", "triangles", "s", {"two": [(10, 1), (100, 10)], "lonely": [(10, 2)]}, slopes=True)
check("a plot by size leaves out what has one size, and says so", "lonely" not in drawn and "1 more at one size only" in drawn)
check("if there is nothing else, it is drawn", "lonely" in bench_plot.log_plot("Time", "x", "s", {"lonely": [(10, 2)]}, slopes=True))
