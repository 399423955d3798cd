"""Frames in users' readers: h5py and VTK."""

import dataclasses

import h5py
import numpy

from .table import Unmeasured

UNITS = {"velocity": "m/s", "pressure": "Pa", "density": "kg/m3", "id": "1", "liquid": "1", "role": "1"}


@dataclasses.dataclass
class Findings:
    frames: int = 0
    fields: tuple = ()
    faults: list = dataclasses.field(default_factory=list)

    def expect(self, holds, fault):
        if not holds:
            self.faults.append(fault)

    def text(self):
        return f"{self.frames} frames with {', '.join(self.fields)}: {'; '.join(self.faults) or 'all agree'}"


def examine(frames, times, count):
    """frames: pairs of time and path as the index has them; times and count are what they must be, or None."""
    found = Findings(frames=len(frames))
    if times is not None:
        stated = [time for time, _ in frames]
        found.expect(len(stated) == len(times) and numpy.allclose(stated, times, rtol=0, atol=1e-9),
                     f"times {stated}, not {times}")
    for time, path in frames:
        with h5py.File(path, "r") as file:
            root = file["VTKHDF"]
            found.expect(root.attrs["time"] == time, f"{path.name}: time {root.attrs['time']}, {time} in the index")
            found.expect(unit_of(root["Points"]) == "m", f"{path.name}: Points in {unit_of(root['Points'])}")
            arrays = {name: values[()] for name, values in root["PointData"].items()}
            for name in arrays:
                unit = unit_of(root["PointData"][name])
                known = UNITS.get(name)
                found.expect(unit == known if known else unit is not None, f"{path.name}: {name} in {unit}")
            arrays["Points"] = root["Points"][()]
        if count is not None:
            found.expect(len(arrays["Points"]) == count, f"{path.name}: {len(arrays['Points'])} particles, not {count}")
        found.fields = tuple(name for name in arrays if name != "Points")
        compare_with_vtk(found, path, arrays)
    return found


def unit_of(data):
    unit = data.attrs.get("unit")
    return unit.decode() if isinstance(unit, bytes) else unit


def compare_with_vtk(found, path, arrays):
    try:
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkIOHDF import vtkHDFReader
    except ImportError as error:
        raise Unmeasured(f"needs python3-vtk9: {error}") from None
    reader = vtkHDFReader()
    if not reader.CanReadFile(str(path)):
        found.expect(False, f"{path.name}: VTK refuses it")
        return
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    found.expect(grid.GetNumberOfPoints() == grid.GetNumberOfCells() == len(arrays["Points"]),
                 f"{path.name}: VTK has {grid.GetNumberOfPoints()} points, {grid.GetNumberOfCells()} cells")
    for name, values in arrays.items():
        data = grid.GetPoints().GetData() if name == "Points" else grid.GetPointData().GetArray(name)
        found.expect(data is not None and numpy.array_equal(vtk_to_numpy(data), values),
                     f"{path.name}: VTK has another {name}")
