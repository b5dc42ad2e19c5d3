#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
#
# read_matrices.py ALCAP: what `alcap export-matrices` writes, read by SciPy and by the readers of docs/backends.md: the
# three formats hold the same Hermitian matrices, and their smallest eigenvalue is the one that `alcap field` reports.
# Exits with 77 (skipped) where SciPy is missing.
import json
import pathlib
import subprocess
import sys
import tempfile

try:
    import numpy as np
    import scipy.io
    import scipy.linalg
    import scipy.sparse
except ImportError:
    print("SciPy is missing, so the exported matrices are not read by it")
    sys.exit(77)


def read_petsc(path):
    with open(path, "rb") as file:
        kind, rows, columns, entries = np.fromfile(file, ">i4", 4)
        assert kind == 1211216
        counts = np.fromfile(file, ">i4", rows)
        column = np.fromfile(file, ">i4", entries)
        values = np.fromfile(file, ">c16", entries)
        assert file.read() == b""
    starts = np.concatenate([[0], np.cumsum(counts)])
    return scipy.sparse.csr_matrix((values, column, starts), shape=(rows, columns))


READERS = {"npz": scipy.sparse.load_npz, "mtx": scipy.io.mmread, "petsc": read_petsc}


def run(tool, *arguments):
    return json.loads(subprocess.run([tool, *map(str, arguments), "--json"], check=True, capture_output=True).stdout)


def check_mesh(tool, folder, kind, n, connection):
    mesh = folder / "mesh.ply"
    run(tool, "make", kind, "-o", mesh)
    found = {}
    for form, read in READERS.items():
        out = folder / f"{form}-{n}"
        report = run(tool, "export-matrices", mesh, "-n", n, "--connection", connection, "--format", form, "-o", out)
        found[form] = [read(out / f"{name}.{form}").tocsr() for name in ("stiffness", "mass")]
        for A in found[form]:
            A.sort_indices()
        assert report["matrices"]["rows"] == found[form][0].shape[0] == report["mesh"]["vertices"]
        assert report["matrices"]["entries"]["mass"] == found[form][1].nnz
        assert sorted(p.name for p in out.iterdir()) == sorted([f"stiffness.{form}", f"mass.{form}", "report.json"])
    S, M = (A.toarray() for A in found["npz"])
    for form, matrices in found.items():
        for A, B in zip(matrices, (S, M)):
            assert np.array_equal(A.toarray(), B), (form, kind, n)
    for A in (S, M):
        assert np.abs(A - A.conj().T).max() <= 1e-14 * np.abs(A).max()
        assert np.abs(A.imag).max() > 1e-3 * np.abs(A).max()  # so that a wrong conjugate would show
    values = scipy.linalg.eigh(S, M, eigvals_only=True)
    told = run(tool, "field", mesh, "-n", n, "--connection", connection)["eigen"]["lambda"]
    assert abs(values[0] - told) <= 1e-7 * max(told, 1), (kind, n, values[0], told)


def main():
    with tempfile.TemporaryDirectory() as folder:
        for k, (kind, n, connection) in enumerate([("bumpy:3", 1, "global"), ("bumpy:3", 4, "polar"), ("disk:8", 2, "local")]):
            here = pathlib.Path(folder) / str(k)
            here.mkdir()
            check_mesh(sys.argv[1], here, kind, n, connection)
    print("exported matrices: all formats agree, with each other and with alcap field")


main()
