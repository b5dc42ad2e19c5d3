#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
#
# backends_table.py PERF_BACKENDS [--faces N] [--degrees 1,4] [--family jittered] [--seconds 120] [--skip-linear]: prints the
# tables of docs/backends.md: every backend of the program, on the same matrices, to the same recomputed residual, on one
# thread, each run in its own process. Runs that take more than --seconds of CPU time are marked.
import argparse
import json
import os
import resource
import signal
import subprocess

EIGEN = [("auto", "auto"), ("lobpcg", "auto"), ("lanczos", "cholmod"), ("lanczos", "multigrid"),
         ("inverse-iteration", "cholmod"),
         ("lanczos", "petsc-mumps"),
         ("slepc-krylovschur", "petsc-mumps"), ("slepc-krylovschur", "cholmod"), ("slepc-krylovschur", "petsc-cg-gamg"),
         ("slepc-krylovschur", "multigrid"),
         ("slepc-lobpcg", "petsc-mumps"), ("slepc-lobpcg", "petsc-cg-gamg"), ("slepc-lobpcg", "multigrid"),
         ("slepc-gd", "petsc-mumps"), ("slepc-gd", "petsc-cg-gamg"), ("slepc-gd", "multigrid"),
         ("slepc-jd", "petsc-mumps"), ("slepc-jd", "petsc-cg-gamg"), ("slepc-jd", "multigrid")]


def measure(arguments, words):
    command = [arguments.program, arguments.family, str(arguments.faces), *words]
    environment = dict(os.environ, OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1")
    limit = lambda: resource.setrlimit(resource.RLIMIT_CPU, (arguments.seconds, arguments.seconds + 5))
    done = subprocess.run(command, capture_output=True, text=True, env=environment, preexec_fn=limit)
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return f"more than {arguments.seconds} s"
    return json.loads(done.stdout) if done.returncode == 0 else done.stderr.strip().splitlines()[-1]


def cells(row, wanted, keys):
    if isinstance(row, str):
        return [row] + [""] * (len(keys) - 1)
    texts = {"setup": f"{row['setup']:.2f}", "solve": f"{row['solve']:.2f}", "iterations": str(row["iterations"] or "direct"),
             "memory": f"{row['bytes'] / 1e6:.0f}", "tolerance": f"{row['tolerance']:.0e}",
             "residual": f"{row['residual']:.0e}" + ("" if row["residual"] <= wanted else " (not met)"),
             "lambda": f"{row['lambda']:.8f}"}
    return [texts[key] for key in keys]


def table(title, head, rows):
    print(f"\n{title}\n\n| " + " | ".join(head) + " |\n|" + " --- |" + " ---: |" * (len(head) - 1), flush=True)
    for row in rows:
        print("| " + " | ".join(row) + " |", flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--faces", type=int, default=50000)
    parser.add_argument("--degrees", default="1,4")
    parser.add_argument("--family", default="jittered")
    parser.add_argument("--seconds", type=int, default=120)
    parser.add_argument("--skip-linear", action="store_true")
    parser.add_argument("--linear-residual", type=float, default=1e-8)
    parser.add_argument("--eigen-residual", type=float, default=1e-6)
    arguments = parser.parse_args()
    listed = subprocess.run([arguments.program, "list"], check=True, capture_output=True, text=True).stdout.split("\n")
    known = {tuple(line.split()) for line in listed if line}
    names = [line.split()[1] for line in listed if line.startswith("linear")]

    wanted = arguments.linear_residual
    keys = ["setup", "solve", "iterations", "memory", "residual"]
    if not arguments.skip_linear:
        table(f"Linear systems, n = 4, {arguments.faces} triangles, {arguments.family}, residual {wanted:.0e}",
              ["backend", "setup, CPU s", "solve, CPU s", "iterations", "MB", "residual"],
              ([f"`{name}`", *cells(measure(arguments, ["4", str(wanted), "linear", name]), wanted, keys)] for name in names))

    wanted = arguments.eigen_residual
    keys = ["solve", "iterations", "memory", "tolerance", "residual", "lambda"]
    pairs = [(m, s) for m, s in EIGEN if (m == "auto" or ("eigen", m) in known) and (s == "auto" or s in names)]
    for n in arguments.degrees.split(","):
        table(f"Smallest eigenpair, n = {n}, {arguments.faces} triangles, {arguments.family}, residual {wanted:.0e}",
              ["method", "with", "CPU s", "iterations", "MB", "tolerance given", "residual", "eigenvalue"],
              ([f"`{m}`", f"`{s}`", *cells(measure(arguments, [n, str(wanted), "eigen", m, s]), wanted, keys)]
               for m, s in pairs))


main()
