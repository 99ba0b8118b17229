"""Meshes: the models that are compared, read from OBJ or PLY or generated, and their files.

A mesh is a pair of arrays: positions, float64 of n x 3, and faces, int64 of m x 3. All programs get
the same one: polygons cut in fans, vertices without faces left out, coordinates rounded to float32,
which is what half of the programs hold.
"""

import gzip
import os
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]

# Models of the folder that MVE_MODELS names, or `shared/models` beside the checkout, and the number
# of faces asked for where it is not a tenth.
MODELS = {
    "bunny": ("stanford-bunny.obj", None),
    "cow": ("cow.obj", 580),
    "fandisk": ("fandisk.obj", None),
    "spot": ("spot.obj", None),
    "blob": ("hoppe/standingblob.obj.gz", None),
    "body": ("bodies/person1_scan.obj.gz", None),
}


def folder():
    """The folder of the real models."""
    return Path(os.environ.get("MVE_MODELS", ROOT / "shared" / "models"))


def noisy_torus(n_faces, noise=0.05, seed=1):
    """A closed torus with bumps of two sizes and normally distributed noise.

    The surface is that of the benches (`bumpy_torus` in `modules/benches/models/mod.rs`); the
    standard deviation of the noise, along each axis, is `noise` times the mean length of an edge.
    """
    side = int(np.sqrt(n_faces / 2))
    turn = 2 * np.pi / side
    i = np.arange(side * side)
    u, v = (i // side) * turn, (i % side) * turn
    r = 0.4 + 0.03 * np.sin(7 * u) * np.cos(9 * v) + 0.003 * np.sin(61 * u + 37 * v)
    from_axis = 1 + r * np.cos(v)
    positions = np.stack([from_axis * np.cos(u), from_axis * np.sin(u), r * np.sin(v)], axis=1)

    def at(down, right):
        return (i // side + down) % side * side + (i % side + right) % side

    quads = [at(0, 0), at(1, 0), at(1, 1), at(0, 0), at(1, 1), at(0, 1)]
    faces = np.stack(quads, axis=1).reshape(-1, 3)
    edges = positions[faces[:, 0]] - positions[faces[:, 1]]
    scale = noise * np.linalg.norm(edges, axis=1).mean()
    random = np.random.Generator(np.random.PCG64(seed))
    return positions + random.normal(scale=scale, size=positions.shape), faces


def tetrahedron():
    """The corner of a cube."""
    return np.eye(4, 3), np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])


def read_obj(path):
    """Positions and faces of an OBJ file, which may be packed by gzip."""
    positions, faces = [], []
    opened = gzip.open(path, "rt") if path.suffix == ".gz" else open(path, encoding="utf-8")
    with opened as lines:
        for line in lines:
            if line.startswith("v "):
                positions.append([float(word) for word in line.split()[1:4]])
            elif line.startswith("f "):
                ids = [int(word.split("/")[0]) for word in line.split()[1:]]
                ids = [k - 1 if k > 0 else len(positions) + k for k in ids]
                faces.extend([ids[0], ids[k - 1], ids[k]] for k in range(2, len(ids)))
    return np.array(positions, dtype=float).reshape(-1, 3), np.array(faces).reshape(-1, 3)


def read_any(path):
    """A mesh of a file that is named by a person: OBJ here, anything else by MeshLab."""
    if path.name.endswith((".obj", ".obj.gz")):
        return read_obj(path)
    import pymeshlab

    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(path))
    mesh = meshes.current_mesh()
    return mesh.vertex_matrix(), mesh.face_matrix().astype(np.int64)


def tidy(positions, faces):
    """The mesh as all programs get it."""
    used, faces = np.unique(faces, return_inverse=True)
    return positions[used].astype(np.float32).astype(np.float64), faces.reshape(-1, 3)


def write(path, positions, faces):
    """Two numbers of 64 bits, n and m; n x 3 float64; m x 3 uint32."""
    with open(path, "wb") as file:
        np.array([len(positions), len(faces)], dtype=np.uint64).tofile(file)
        np.ascontiguousarray(positions, dtype=np.float64).tofile(file)
        np.ascontiguousarray(faces, dtype=np.uint32).tofile(file)


def read(path):
    """What `write` wrote."""
    with open(path, "rb") as file:
        n, m = (int(count) for count in np.fromfile(file, np.uint64, 2))
        positions = np.fromfile(file, np.float64, 3 * n).reshape(-1, 3)
        return positions, np.fromfile(file, np.uint32, 3 * m).reshape(-1, 3).astype(np.int64)


def write_obj(path, positions, faces):
    """The mesh for mve, every digit of float32 kept."""
    with open(path, "w", encoding="utf-8") as file:
        for block in np.array_split(positions, max(1, len(positions) // 100_000)):
            file.write("v %.9g %.9g %.9g\n" * len(block) % tuple(block.ravel()))
        for block in np.array_split(faces + 1, max(1, len(faces) // 100_000)):
            file.write("f %d %d %d\n" * len(block) % tuple(block.ravel()))


def make(name, path=None):
    """A mesh by its name, or of a file. None where the model is not on this machine."""
    if path is not None:
        return tidy(*read_any(path))
    if name.startswith("noisy "):
        n_faces = {"100k": 100_000, "1M": 1_000_000, "4M": 4_000_000}[name.split()[1]]
        return tidy(*noisy_torus(n_faces))
    path = folder() / MODELS[name][0]
    return tidy(*read_obj(path)) if path.is_file() else None


def target(name, n_faces):
    """The number of faces asked for."""
    asked = MODELS.get(name, (None, None))[1]
    return asked if asked is not None else n_faces // 10


def n_calls(n_faces):
    """How often a mesh is simplified in one run: small ones take less time than a clock is good
    for."""
    return 10 if n_faces < 30_000 else 1
