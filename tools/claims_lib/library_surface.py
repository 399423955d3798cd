"""A library's surface of the same particles: VTK's SPH splat on the same grid, and its marching cubes."""

import dataclasses
import time

import numpy

from .table import Unmeasured


@dataclasses.dataclass(frozen=True)
class Surface:
    volume: float   # [m3]
    seconds: float  # of splat and marching cubes
    triangles: int


def make(points, spacing, width=1.25, step=0.5):
    """The surface at one half of the volume fraction, by cubic splines of a width and on a grid of a step, in spacings."""
    try:
        from vtkmodules.util.numpy_support import numpy_to_vtk
        from vtkmodules.vtkCommonCore import vtkPoints
        from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData
        from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D, vtkMassProperties
        from vtkmodules.vtkFiltersPoints import vtkSPHCubicKernel, vtkSPHInterpolator
    except ImportError as error:
        raise Unmeasured(f"needs VTK for Python: {error}") from None

    low, high = points.min(axis=0) - 3 * spacing, points.max(axis=0) + 3 * spacing
    begin = time.perf_counter()
    places = vtkPoints()
    places.SetData(numpy_to_vtk(numpy.ascontiguousarray(points, dtype=float), deep=1))
    particles = vtkPolyData()
    particles.SetPoints(places)
    for name, value in (("mass", spacing ** 3), ("density", 1.0)):
        array = numpy_to_vtk(numpy.full(len(points), value), deep=1)
        array.SetName(name)
        particles.GetPointData().AddArray(array)
    grid = vtkImageData()
    grid.SetDimensions(*(int(n) for n in numpy.ceil((high - low) / (step * spacing)) + 1))
    grid.SetOrigin(*low)
    grid.SetSpacing(*(3 * [step * spacing]))
    kernel = vtkSPHCubicKernel()
    kernel.SetDimension(3)
    kernel.SetSpatialStep(width * spacing)
    splat = vtkSPHInterpolator()
    splat.SetInputData(grid)
    splat.SetSourceData(particles)
    splat.SetKernel(kernel)
    splat.SetMassArrayName("mass")
    splat.SetDensityArrayName("density")
    splat.SetComputeShepardSum(True)
    splat.SetShepardSumArrayName("fraction")
    splat.ShepardNormalizationOff()
    splat.Update()
    field = splat.GetOutput()
    field.GetPointData().SetActiveScalars("fraction")
    edges = vtkFlyingEdges3D()
    edges.SetInputData(field)
    edges.SetValue(0, 0.5)
    edges.ComputeNormalsOn()
    edges.Update()
    seconds = time.perf_counter() - begin
    figures = vtkMassProperties()
    figures.SetInputData(edges.GetOutput())
    figures.Update()
    return Surface(figures.GetVolume(), seconds, edges.GetOutput().GetNumberOfPolys())
