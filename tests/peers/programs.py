"""The programs in Python that are compared: each a function of a mesh and a number of faces.

`python programs.py NAME TARGET_FACES CALLS IN OUT [HINT]` runs one in a process of its own: it
reads the mesh, calls the program so many times on it, writes the result and prints, as JSON, the
mean of the seconds of the processor that a call took, and the process's memory before it held the
mesh and at most during the first call.

A program's function gets the mesh as the program wants it (made by its `prepare`, which is not
timed) and gives an object from which `result` reads positions and faces (not timed either).
"""

import ctypes
import gc
import json
import os
import sys
import time
from importlib.metadata import version
from pathlib import Path

import numpy as np

import meshes

FOLDER = Path(os.environ.get("MVE_PEERS", meshes.ROOT / "target" / "peers"))


class Meshoptimizer:
    """meshoptimizer by C, from the source that the crate of the benches ships."""

    REGULARIZE = 1 << 4
    package = None

    def __init__(self, function, options=0):
        self.function, self.options = function, options

    def prepare(self, positions, faces, target):
        self.library = ctypes.CDLL(str(FOLDER / "libmeshoptimizer.so"))
        self.library.meshopt_simplify.restype = ctypes.c_size_t
        self.library.meshopt_simplifyWithUpdate.restype = ctypes.c_size_t
        self.positions = np.ascontiguousarray(positions, dtype=np.float32)
        self.indices = np.ascontiguousarray(faces, dtype=np.uint32).ravel()

    def call(self, target):
        size, no_end = ctypes.c_size_t, ctypes.c_float(1e9)
        if self.function == "sloppy":
            return self.call_sloppy(size(3 * target), no_end)
        indices = self.indices.ctypes.data_as(ctypes.c_void_p)
        mesh = [indices, size(self.indices.size), self.positions.ctypes.data_as(ctypes.c_void_p)]
        mesh += [size(len(self.positions)), size(12)]
        stop = [size(3 * target), no_end, ctypes.c_uint(self.options), None]
        if self.function == "simplify":
            self.n = self.library.meshopt_simplify(indices, *mesh, *stop)
        else:
            attributes = [None, size(0), None, size(0), None]
            self.n = self.library.meshopt_simplifyWithUpdate(*mesh, *attributes, *stop)

    def call_sloppy(self, target, no_end):
        size, indices = ctypes.c_size_t, self.indices.ctypes.data_as(ctypes.c_void_p)
        positions = self.positions.ctypes.data_as(ctypes.c_void_p)
        self.library.meshopt_simplifySloppy.restype = ctypes.c_size_t
        kept = np.empty_like(self.indices)
        self.n = self.library.meshopt_simplifySloppy(
            kept.ctypes.data_as(ctypes.c_void_p), indices, size(self.indices.size), positions,
            size(len(self.positions)), size(12), None, target, no_end, None,
        )
        self.indices = kept

    def result(self):
        return self.positions, self.indices[: self.n].reshape(-1, 3)


class Vtk:
    """A filter of VTK, with the names of what is switched on in it."""

    package = "vtk"

    def __init__(self, name, *switches):
        self.name, self.switches = name, switches

    def prepare(self, positions, faces, target):
        import vtkmodules.vtkFiltersCore as core
        from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
        from vtkmodules.vtkCommonCore import vtkPoints
        from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

        points = vtkPoints()
        points.SetDataTypeToDouble()
        points.SetData(numpy_to_vtk(positions, deep=True))
        offsets = np.arange(0, 3 * len(faces) + 1, 3, dtype=np.int64)
        cells = vtkCellArray()
        cells.SetData(
            numpy_to_vtkIdTypeArray(offsets, deep=True),
            numpy_to_vtkIdTypeArray(faces.astype(np.int64).ravel(), deep=True),
        )
        mesh = vtkPolyData()
        mesh.SetPoints(points)
        mesh.SetPolys(cells)
        self.filter = getattr(core, self.name)()
        self.filter.SetInputData(mesh)
        self.aim(positions, target, len(faces))
        for switch in self.switches:
            getattr(self.filter, switch)()

    def aim(self, positions, target, n_faces):
        self.filter.SetTargetReduction(1 - target / n_faces)

    def call(self, target):
        self.filter.Update()

    def result(self):
        from vtkmodules.util.numpy_support import vtk_to_numpy

        mesh = self.filter.GetOutput()
        faces = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        return vtk_to_numpy(mesh.GetPoints().GetData()), faces


class VtkCells(Vtk):
    """A filter of VTK that puts vertices into cells: as many along the longest axis as leave about
    the number of faces, which are searched for before the call that is timed."""

    def aim(self, positions, target, n_faces):
        size = positions.max(axis=0) - positions.min(axis=0)
        shares = size / size.max()
        if self.hint is None:
            low, high = 1, 2
            while self.n_faces(shares, high) < target:
                low, high = high, 2 * high
            while high - low > 1:
                middle = (low + high) // 2
                is_less = self.n_faces(shares, middle) < target
                low, high = (middle, high) if is_less else (low, middle)
            self.hint = min((abs(self.n_faces(shares, n) - target), n) for n in (low, high))[1]
        self.divide(shares, max(1, int(self.hint)))
        self.filter.Modified()

    def divide(self, shares, n):
        if hasattr(self.filter, "AutoAdjustNumberOfDivisionsOff"):
            self.filter.AutoAdjustNumberOfDivisionsOff()
        self.filter.SetNumberOfDivisions(*(max(1, round(share * n)) for share in shares))

    def n_faces(self, shares, n):
        self.divide(shares, n)
        self.filter.Update()
        return self.filter.GetOutput().GetNumberOfPolys()


class MeshLab:
    """MeshLab's quadric edge collapse, by options that differ from its defaults."""

    package = "pymeshlab"

    def __init__(self, **options):
        self.options = options

    def prepare(self, positions, faces, target):
        import pymeshlab

        self.meshes = pymeshlab.MeshSet()
        self.meshes.add_mesh(pymeshlab.Mesh(positions, faces.astype(np.int32)))

    def call(self, target):
        self.meshes.meshing_decimation_quadric_edge_collapse(targetfacenum=target, **self.options)

    def result(self):
        mesh = self.meshes.current_mesh()
        return mesh.vertex_matrix(), mesh.face_matrix()


class Open3d:
    """Open3D's quadric decimation."""

    package = "open3d-cpu"

    def prepare(self, positions, faces, target):
        import open3d

        utility = open3d.utility
        triangles = utility.Vector3iVector(faces.astype(np.int32))
        points = utility.Vector3dVector(positions)
        self.mesh = open3d.geometry.TriangleMesh(points, triangles)

    def call(self, target):
        self.simplified = self.mesh.simplify_quadric_decimation(target)

    def result(self):
        return np.asarray(self.simplified.vertices), np.asarray(self.simplified.triangles)


class Pyfqmr:
    """Fast-Quadric-Mesh-Simplification as pyfqmr wraps it."""

    package = "pyfqmr"

    def prepare(self, positions, faces, target):
        import pyfqmr

        self.simplifier = pyfqmr.Simplify()
        self.simplifier.setMesh(positions, faces.astype(np.int32))

    def call(self, target):
        self.simplifier.simplify_mesh(target_count=target, verbose=False)

    def result(self):
        return self.simplifier.getMesh()[:2]


class FastSimplification:
    """Fast-Quadric-Mesh-Simplification as fast-simplification wraps it."""

    package = "fast-simplification"

    def prepare(self, positions, faces, target):
        import fast_simplification

        self.simplify = fast_simplification.simplify
        self.mesh = positions, faces.astype(np.int32)

    def call(self, target):
        self.simplified = self.simplify(*self.mesh, target_count=target)

    def result(self):
        return self.simplified[:2]


class Manifold:
    """Manifold simplifies by a tolerance: the one that leaves the number of faces is searched for
    before the call that is timed. It takes closed manifold meshes alone."""

    package = "manifold3d"

    def prepare(self, positions, faces, target):
        import manifold3d

        mesh = manifold3d.Mesh(positions.astype(np.float32), faces.astype(np.uint32))
        self.mesh = manifold3d.Manifold(mesh)
        if self.mesh.status() != manifold3d.Error.NoError:
            raise SystemExit(f"takes no such mesh: {self.mesh.status().name}")
        self.size = np.linalg.norm(positions.max(axis=0) - positions.min(axis=0))
        self.hint = self.hint if self.hint is not None else self.search(target)

    def search(self, target):
        low, high = -7.0, -1.0
        for _ in range(14):
            middle = (low + high) / 2
            n = self.mesh.simplify(self.size * 10**middle).num_tri()
            low, high = (middle, high) if n > target else (low, middle)
        return self.size * 10**high

    def call(self, target):
        self.simplified = self.mesh.simplify(self.hint)
        self.simplified.num_tri()

    def result(self):
        mesh = self.simplified.to_mesh()
        return mesh.vert_properties[:, :3], mesh.tri_verts


class MeshLib:
    """MeshLib's decimation, by settings that differ from its defaults."""

    package = "meshlib"

    def __init__(self, **settings):
        self.options = settings

    def prepare(self, positions, faces, target):
        from meshlib import mrmeshnumpy, mrmeshpy

        self.library = mrmeshpy
        self.mesh = mrmeshnumpy.meshFromFacesVerts(faces.astype(np.int32), positions)
        self.settings = mrmeshpy.DecimateSettings()
        self.settings.maxError = 3e38
        self.settings.maxDeletedFaces = len(faces) - target
        self.settings.packMesh = True
        for name, value in self.options.items():
            setattr(self.settings, name, value)

    def call(self, target):
        self.library.decimateMesh(self.mesh, self.settings)

    def result(self):
        from meshlib import mrmeshnumpy

        faces = mrmeshnumpy.getNumpyFaces(self.mesh.topology)
        return mrmeshnumpy.getNumpyVerts(self.mesh), faces


class Libigl:
    """A function of libigl."""

    package = "libigl"

    def __init__(self, name):
        self.name = name

    def prepare(self, positions, faces, target):
        import igl

        self.function = getattr(igl, self.name)
        self.mesh = np.asfortranarray(positions), np.asfortranarray(faces.astype(np.int32))

    def call(self, target):
        self.simplified = self.function(*self.mesh, target, False)

    def result(self):
        return self.simplified[:2]


PROGRAMS = {
    "meshoptimizer": Meshoptimizer("simplify"),
    "meshoptimizer, update": Meshoptimizer("update"),
    "meshoptimizer, update, regularize": Meshoptimizer("update", Meshoptimizer.REGULARIZE),
    "VTK QuadricDecimation": Vtk("vtkQuadricDecimation"),
    "VTK QuadricDecimation, regularize": Vtk("vtkQuadricDecimation", "RegularizeOn"),
    "MeshLab": MeshLab(),
    "MeshLab, topology, boundary": MeshLab(preservetopology=True, preserveboundary=True),
    "Open3D": Open3d(),
    "pyfqmr": Pyfqmr(),
    "fast-simplification": FastSimplification(),
    "Manifold": Manifold(),
    "MeshLib": MeshLib(),
    "MeshLib, 16 parts": MeshLib(subdivideParts=16, decimateBetweenParts=True),
    "libigl qslim": Libigl("qslim"),
}

# What `run clusters` compares.
CLUSTERS = {
    "vtkBinnedDecimation": VtkCells("vtkBinnedDecimation"),
    "vtkQuadricClustering": VtkCells("vtkQuadricClustering"),
    "vtkDecimatePro": Vtk("vtkDecimatePro", "PreserveTopologyOn"),
    "meshoptimizer, sloppy": Meshoptimizer("sloppy"),
}


def status(key):
    """Bytes of a line of /proc/self/status."""
    with open("/proc/self/status", encoding="ascii") as lines:
        line = next(line for line in lines if line.startswith(key + ":"))
    return 1024 * int(line.split()[1])


def give_back():
    """Hands freed memory back to the system, so that it does not hide what a call takes."""
    gc.collect()
    ctypes.CDLL(None).malloc_trim(0)


def main():
    name, target, n_calls = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    source, destination = sys.argv[4:6]
    program = {**PROGRAMS, **CLUSTERS}[name]
    # A small mesh first: what the program loads is no memory of the mesh.
    program.hint = 0.0
    program.prepare(*meshes.tetrahedron(), 2)
    give_back()
    before = status("VmRSS")
    program.hint = float(sys.argv[6]) if len(sys.argv) > 6 else None
    seconds = []
    for _ in range(n_calls):
        program.prepare(*meshes.read(source), target)
        give_back()
        if not seconds:
            Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
        start = time.process_time()
        program.call(target)
        seconds.append(time.process_time() - start)
        peak = peak if len(seconds) > 1 else status("VmHWM")
    positions, faces = program.result()
    meshes.write(destination, np.asarray(positions), np.asarray(faces))
    cpu = sum(seconds) / n_calls
    found = {"cpu": cpu, "before": before, "peak": peak, "hint": program.hint}
    if program.package:
        found["version"] = version(program.package)
    print("\n" + json.dumps(found))


if __name__ == "__main__":
    main()
