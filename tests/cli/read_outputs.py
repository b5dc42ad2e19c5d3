# SPDX-License-Identifier: MIT
#
# Reads what the command line tool writes with readers that are not ours (VTK, meshio: whatever is installed) and
# compares it with alcap's own text files. Usage: read_outputs.py ALCAP. Exit code 77: none of them is installed.
import json
import os
import subprocess
import sys
import tempfile

readers = {}
try:
    from vtkmodules.vtkIOGeometry import vtkOBJReader
    from vtkmodules.vtkIOImage import vtkPNGReader
    from vtkmodules.vtkIOPLY import vtkPLYReader
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
    from vtkmodules.vtkRenderingCore import vtkPolyDataMapper

    readers["VTK"] = "python3-vtk9"
except ImportError:
    pass
try:
    import meshio

    readers["meshio"] = "python3-meshio"
except ImportError:
    pass
if not readers:
    print("SKIPPED: no file was read back. On Debian: apt-get install python3-vtk9 python3-meshio")
    sys.exit(77)

checked = []


def read(reader, path):
    complaints = []
    for event in ("ErrorEvent", "WarningEvent"):
        reader.AddObserver(event, lambda _, name: complaints.append(name))
    reader.SetFileName(path)
    reader.Update()
    assert not complaints, f"{path}: VTK complains"
    return reader.GetOutput()


def near(a, b, tolerance=0.0):
    return len(a) == len(b) and all(abs(x - y) <= tolerance for x, y in zip(a, b))


def lines_of(poly):
    """Every polyline as the list of its points."""
    from vtkmodules.vtkCommonCore import vtkIdList

    ids, out, cells = vtkIdList(), [], poly.GetLines()
    cells.InitTraversal()
    while cells.GetNextCell(ids):
        out.append([poly.GetPoint(ids.GetId(k)) for k in range(ids.GetNumberOfIds())])
    return out


def check_curves(folder):
    with open(f"{folder}/curves.json", encoding="utf-8") as file:
        curves = json.load(file)["curves"]
    assert len(curves) > 3
    for curve in curves:
        assert len(curve["points"]) == len(curve["faces"]) == len(curve["barycentric"]) >= 2
        assert curve["start"] in ("singularity", "separation", "loop", "length", "seed")
    if "VTK" not in readers:
        return
    data = read(vtkXMLPolyDataReader(), f"{folder}/curves.vtp")
    found = lines_of(data)
    assert len(found) == len(curves)
    for got, want in zip(found, curves):
        assert len(got) == len(want["points"])
        assert all(near(p, q) for p, q in zip(got, want["points"])), "curves.vtp and curves.json differ"
    faces = data.GetPointData().GetArray("face")
    assert [int(faces.GetValue(i)) for i in range(faces.GetNumberOfTuples())] == sum((c["faces"] for c in curves), [])
    checked.append("curves.vtp with VTK")
    found = lines_of(read(vtkOBJReader(), f"{folder}/curves.obj"))  # VTK keeps the points of .obj as float
    assert len(found) == len(curves)
    for got, want in zip(found, curves):
        assert all(near(p, q, 1e-6) for p, q in zip(got, want["points"])), "curves.obj and curves.json differ"
    checked.append("curves.obj with VTK")


def check_field(folder):
    """Positions and faces against mesh.obj, directions against the raw field per vertex."""
    with open(f"{folder}/mesh.obj", encoding="utf-8") as file:
        rows = [line.split() for line in file if line[:2] in ("v ", "f ")]
    points = [[float(x) for x in row[1:4]] for row in rows if row[0] == "v"]
    faces = [[int(x.split("/")[0]) - 1 for x in row[1:4]] for row in rows if row[0] == "f"]
    with open(f"{folder}/out/field.vertex.rawfield", encoding="utf-8") as file:
        head, *body = file.read().splitlines()
    n, count = (int(x) for x in head.split())
    raw = [[float(x) for x in line.split()] for line in body]
    assert n == 4 and count == len(points) == len(raw)
    if "VTK" in readers:
        data = read(vtkXMLPolyDataReader(), f"{folder}/out/field.vtp")
        assert data.GetNumberOfPolys() == len(faces)
        for k in range(n):
            d = data.GetPointData().GetArray(f"d_{k}")
            assert all(near(d.GetTuple(i), raw[i][3 * k : 3 * k + 3]) for i in range(count)), f"field.vtp d_{k}"
        singular = read(vtkXMLPolyDataReader(), f"{folder}/out/field_singularities.vtp")
        for shown, group in ((data, data.GetCellData()), (singular, singular.GetPointData())):
            mapper = vtkPolyDataMapper()
            mapper.SetInputData(shown)
            colours, index = mapper.MapScalars(1.0), group.GetArray("index")
            drawn = {(index.GetTuple1(i), colours.GetTuple(i)[:3]) for i in range(index.GetNumberOfTuples())}
            assert drawn <= {(-1, (0, 114, 178)), (0, (235, 229, 216)), (1, (213, 94, 0))}, drawn
            assert any(k > 0 for k, _ in drawn)
        checked.append("field.vtp and its singularities, in their colours, with VTK")
        ply = read(vtkPLYReader(), f"{folder}/out/field.ply")
        assert ply.GetNumberOfPoints() == count and ply.GetNumberOfPolys() == len(faces)
        checked.append("field.ply (mesh) with VTK")
        if os.path.exists(f"{folder}/picture.png"):
            picture = read(vtkPNGReader(), f"{folder}/picture.png")
            assert picture.GetDimensions() == (320, 240, 1) and picture.GetNumberOfScalarComponents() == 3
            checked.append("picture.png with VTK")
    if "meshio" in readers:
        mesh = meshio.read(f"{folder}/out/field.ply")
        assert all(near(p, q) for p, q in zip(mesh.points.tolist(), points))
        assert mesh.cells_dict["triangle"].tolist() == faces
        d = [mesh.point_data[name].tolist() for name in ("d_x", "d_y", "d_z")]
        assert all(near(p, q[:3]) for p, q in zip(zip(*d), raw)), "field.ply: directions differ"
        checked.append("field.ply (mesh and directions) with meshio")


def main():
    with tempfile.TemporaryDirectory() as folder:

        def alcap(*arguments, good=(0,)):
            run = subprocess.run([sys.argv[1], *arguments], cwd=folder, capture_output=True, text=True, check=False)
            assert run.returncode in good, f"alcap {' '.join(arguments)}: {run.stderr}"
            return run.returncode

        alcap("make", "icosphere:3", "-o", "mesh.obj", "-q")
        alcap("field", "mesh.obj", "-n", "4", "-o", "out", "--formats", "all", "-q")
        for format in ("vtp", "obj", "json"):
            alcap("field", "mesh.obj", "--curves", f"curves.{format}", "--curve-spacing", "0.04", "-q")
        # A build without pictures, or a machine without OpenGL, says so with code 6; test_cli_picture looks at that.
        alcap("field", "mesh.obj", "--png", "picture.png", "--png-size", "320,240", "-q", good=(0, 6))
        check_curves(folder)
        check_field(folder)
    print("read back: " + ", ".join(checked))


main()
