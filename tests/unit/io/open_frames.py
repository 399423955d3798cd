#!/usr/bin/env python3
"""Opens the files of frame_sample with h5py and VTK: times, counts, units, values."""
import json
import os
import sys

try:
    import h5py
    import numpy as np
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOHDF import vtkHDFReader
    from vtkmodules.vtkIOPLY import vtkPLYReader
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
except ImportError as error:
    print(f"skipped: {error}; Debian's packages are python3-vtk9, python3-h5py, python3-numpy")
    sys.exit(77)

COUNTS = {0: 70, 10: 9, 20: 0, 30: 100}
UNITS = {"velocity": "m/s", "density": "kg/m^3", "id": "1", "role": "1", "phase": "1"}
folder = sys.argv[1]


def expected(n):
    i = np.arange(n)
    return {
        "Points": np.column_stack([0.25 * i, -0.5 * i, np.full(n, 1 / 3)]),
        "velocity": np.column_stack([0.1 * i, 0.0 * i, np.full(n, -1.0)]),
        "density": 1000.0 + i,
        "id": 2**40 + i,
        "role": i % 4 - 1,
        "phase": 200 + i % 2,
    }


def same(what, got, want, exact):
    """Float32 files hold a value to a relative 2^-24; float64 files and integers are exact."""
    assert got.shape == want.shape, f"{what}: shape {got.shape}, expected {want.shape}"
    tolerance = 0.0 if exact or got.dtype.kind in "iu" else 2.0**-24
    assert np.all(np.abs(got - want) <= tolerance * np.abs(want)), f"{what}: values differ"


def open_h5py(path, step, exact):
    with h5py.File(path) as file:
        group = file["VTKHDF"]
        assert list(group.attrs["Version"]) == [1, 0] and group.attrs["Type"] == b"UnstructuredGrid"
        assert group.attrs["time"] == 0.0125 * step and group.attrs["step"] == step
        assert group["Points"].attrs["unit"] == b"m"
        same(path + " Points", group["Points"][:], expected(COUNTS[step])["Points"], exact)
        assert set(group["PointData"]) == set(UNITS), list(group["PointData"])
        for name, unit in UNITS.items():
            data = group["PointData"][name]
            assert data.attrs["unit"] == unit.encode(), (name, data.attrs["unit"])
            same(f"{path} {name}", data[:], expected(COUNTS[step])[name], exact)
        assert group["PointData/velocity"].dtype == (np.float64 if exact else np.float32)
        assert group["PointData/id"].dtype == np.int64 and group["PointData/phase"].dtype == np.uint8


def check_vtk(path, data, step, exact, cells):
    n = COUNTS[step]
    assert data.GetNumberOfPoints() == n, f"{path}: {data.GetNumberOfPoints()} points, expected {n}"
    assert cells == n, f"{path}: {cells} cells, expected {n}"
    if n == 0:
        return
    want = expected(n)
    same(path + " Points", vtk_to_numpy(data.GetPoints().GetData()), want["Points"], exact)
    bounds = data.GetBounds()
    assert bounds[0] == 0 and bounds[1] == 0.25 * (n - 1) and bounds[2] == -0.5 * (n - 1), bounds
    for name in UNITS:
        array = data.GetPointData().GetArray(name)
        assert array is not None, f"{path}: no array {name}"
        same(f"{path} {name}", vtk_to_numpy(array), want[name], exact)


def open_vtkhdf(path, step, exact):
    reader = vtkHDFReader()
    assert reader.CanReadFile(path), path
    reader.SetFileName(path)
    reader.Update()
    grid = reader.GetOutput()
    if COUNTS[step] > 0:
        assert grid.GetCellType(COUNTS[step] - 1) == 1, "the cells are vertices"
        last = grid.GetCell(COUNTS[step] - 1)
        assert last.GetNumberOfPoints() == 1 and last.GetPointId(0) == COUNTS[step] - 1
    check_vtk(path, grid, step, exact, grid.GetNumberOfCells())


def open_vtp(path, step, exact):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(path)
    reader.Update()
    data = reader.GetOutput()
    time = data.GetFieldData().GetArray("TimeValue")
    assert time is not None and time.GetValue(0) == 0.0125 * step, path
    check_vtk(path, data, step, exact, data.GetNumberOfVerts())


def open_ply(path, step, exact):
    reader = vtkPLYReader()
    reader.SetFileName(path)
    reader.Update()
    assert reader.GetOutput().GetNumberOfPoints() == COUNTS[step], path
    with open(path, "rb") as file:
        head, _, body = file.read().partition(b"end_header\n")
    types = {"float": "<f4", "double": "<f8", "int": "<i4"}
    fields = [(line.split()[2], types[line.split()[1]]) for line in head.decode().splitlines()
              if line.startswith("property")]
    table = np.frombuffer(body, dtype=fields)
    want = expected(COUNTS[step])
    same(path, np.column_stack([table[c] for c in "xyz"]), want["Points"], exact)
    same(path, table["velocity_z"], want["velocity"][:, 2], exact)
    same(path, table["id"].astype(np.int64), want["id"], exact)
    assert b"comment unit velocity m/s" in head


def open_csv(path, step, exact):
    with open(path) as file:
        names = file.readline().strip().split(",")
        rows = [line.split(",") for line in file]
    assert names[:3] == ["x [m]", "y [m]", "z [m]"] and "velocity_x [m/s]" in names, names
    assert len(rows) == COUNTS[step], path
    want = expected(COUNTS[step])
    column = lambda name: np.array([float(row[names.index(name)]) for row in rows])
    same(path, column("y [m]"), want["Points"][:, 1], exact)
    same(path, column("velocity_x [m/s]"), want["velocity"][:, 0], exact)
    assert [int(row[names.index("id [1]")]) for row in rows] == list(want["id"])


for name, exact in (("liquid", False), ("solid", True)):
    with open(os.path.join(folder, f"{name}.hdf.series")) as file:
        series = json.load(file)
    assert series["file-series-version"] == "1.0"
    assert [f["time"] for f in series["files"]] == [0.0, 0.125, 0.25, 0.375], series
    for entry, step in zip(series["files"], COUNTS):
        assert entry["name"] == f"{name}_{step:06d}.hdf", entry
        path = os.path.join(folder, entry["name"])
        open_h5py(path, step, exact)
        open_vtkhdf(path, step, exact)
for name, step, exact in (("liquid", 0, False), ("liquid", 20, False), ("solid", 30, True)):
    base = os.path.join(folder, f"{name}_{step:06d}")
    open_vtp(base + ".vtp", step, exact)
    open_ply(base + ".ply", step, exact)
    open_csv(base + ".csv", step, exact)
print("h5py and VTK agree: 8 frames, 9 exports")
