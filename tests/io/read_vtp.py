# SPDX-License-Identifier: MIT
#
# Reads what the library writes with VTK itself and compares every array, bit for bit, with what the test program says is
# in it. Usage: read_vtp.py TEST_OUTPUT_EXECUTABLE. Exit code 77: VTK is not installed.
import os
import subprocess
import sys
import tempfile

try:
    from vtkmodules.vtkIOPLY import vtkPLYReader
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
except ImportError as error:
    print(f"SKIPPED: .vtp files were NOT checked with VTK ({error}). On Debian: apt-get install python3-vtk9")
    sys.exit(77)


def read(reader, path):
    """The polydata in a file; any error or warning of VTK is one of the test."""
    complaints = []
    for event in ("ErrorEvent", "WarningEvent"):
        reader.AddObserver(event, lambda _, name: complaints.append(name))
    reader.SetFileName(path)
    reader.Update()
    assert not complaints and reader.GetErrorCode() == 0, f"{path}: VTK complains"
    return reader.GetOutput()


def rows(array):
    return [list(array.GetTuple(i)) for i in range(array.GetNumberOfTuples())]


def cells(cell_array):
    cell_array.InitTraversal()
    from vtkmodules.vtkCommonCore import vtkIdList

    ids, out = vtkIdList(), []
    while cell_array.GetNextCell(ids):
        out.append([float(ids.GetId(k)) for k in range(ids.GetNumberOfIds())])
    return out


def expected(path):
    """(file, place, name) -> rows, from the text of the test program."""
    out, lines = {}, open(path, encoding="utf-8").read().split("\n")
    at = 0
    while at < len(lines) and lines[at]:
        _, file, place, _, count, name = lines[at].split(" ", 5)
        out[file, place, name] = [[float(x) for x in line.split()] for line in lines[at + 1 : at + 1 + int(count)]]
        at += 1 + int(count)
    return out


def close(a, b):
    """Equal up to rounding: positions of singularities are recomputed by the test program in another order."""
    return len(a) == len(b) and all(
        abs(x - y) <= 1e-14 * (1 + abs(y)) for p, q in zip(a, b) for x, y in zip(p, q, strict=True)
    )


def check_colours(data, place):
    """What VTK draws of a file as it is opened: orange above 0, blue below, pale at 0; returns how many of each."""
    from vtkmodules.vtkRenderingCore import vtkPolyDataMapper

    mapper = vtkPolyDataMapper()
    mapper.SetInputData(data)  # and nothing else is set
    group = data.GetCellData() if place == "cell" else data.GetPointData()
    assert group.GetScalars().GetName() == "index_rgb"
    drawn, index, counts = mapper.MapScalars(1.0), group.GetArray("index"), [0, 0, 0]
    assert drawn.GetNumberOfTuples() == index.GetNumberOfTuples()
    for i in range(index.GetNumberOfTuples()):
        k, (r, g, b) = index.GetTuple1(i), drawn.GetTuple(i)[:3]
        assert drawn.GetTuple(i)[:3] == group.GetArray("index_rgb").GetTuple(i)
        assert (r > g > b) if k > 0 else (b > g and b > r) if k < 0 else (min(r, g, b) > 200), (k, r, g, b)
        counts[0 if k < 0 else 1 if k == 0 else 2] += 1
    return counts


def check(name, folder):
    compared = 0
    want = expected(os.path.join(folder, name + ".txt"))
    files = {
        "surface": read(vtkXMLPolyDataReader(), os.path.join(folder, name + ".vtp")),
        "singularities": read(vtkXMLPolyDataReader(), os.path.join(folder, name + "_singularities.vtp")),
    }
    for (file, place, title), values in want.items():
        data = files[file]
        if place == "points":
            found = [list(data.GetPoint(i)) for i in range(data.GetNumberOfPoints())]
        elif place in ("polys", "verts"):
            found = cells(data.GetPolys() if place == "polys" else data.GetVerts())
        else:
            group = {"point": data.GetPointData(), "cell": data.GetCellData(), "field": data.GetFieldData()}[place]
            array = group.GetArray(title)
            assert array is not None, f"{name} {file}: no array {title!r} in {place} data"
            found = rows(array)
        same = close if (file, place) == ("singularities", "points") else lambda a, b: a == b
        assert same(found, values), f"{name} {file}: {place} {title!r} differs"
        compared += sum(map(len, values))
    for file, data in files.items():
        for place, group in (("point", data.GetPointData()), ("cell", data.GetCellData())):
            names = {group.GetArrayName(i) for i in range(group.GetNumberOfArrays())}
            assert names == {t for f, p, t in want if (f, p) == (file, place)}, f"{name} {file}: {place} data {names}"
    surface = files["surface"]
    found = check_colours(surface, "cell")
    assert name != "busy" or all(found), f"{name}: {found} faces below, at and above 0"
    assert check_colours(files["singularities"], "point") == [found[0], 0, found[2]]
    assert surface.GetPointData().GetVectors().GetName() == "d_0"
    assert surface.GetPointData().GetScalars() is None  # they would hide the colours of the faces
    assert surface.GetNumberOfCells() == len(want["surface", "polys", "-"])

    # .ply as a mesh: VTK keeps its coordinates as float.
    ply = read(vtkPLYReader(), os.path.join(folder, name + ".ply"))
    assert cells(ply.GetPolys()) == want["surface", "polys", "-"]
    for i, point in enumerate(want["surface", "points", "-"]):
        assert all(abs(a - b) <= 1e-6 * (1 + abs(b)) for a, b in zip(ply.GetPoint(i), point)), f"{name}.ply point {i}"
    return compared


def main():
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(
            [sys.argv[1], "--no-skip", "--test-case=write samples for VTK"],
            env={**os.environ, "ALCAP_SAMPLE_FOLDER": folder},
            check=True,
        )
        for name in ("busy", "plain"):
            print(f"{name}: {check(name, folder)} numbers agree")


main()
