"""Seconds of the processor that mve and other programs take to read the same mesh files.

Started by `run loaders`, in the environment that it makes. Each program reads a file so many times
in a process of its own, on one core, with one thread; the median counts.
"""

import argparse
import datetime
import json
import os
import statistics
import subprocess
import sys
import tempfile
import textwrap
import time
from importlib.metadata import version
from pathlib import Path

import numpy as np

import bench
import meshes
import programs
import tables

MARKS = "<!-- tests/peers/loaders begins -->", "<!-- tests/peers/loaders ends -->"
FORMATS = {
    "OBJ": "obj", "PLY": "ply", "PLY, ASCII": "ascii.ply", "STL": "stl", "OFF": "off",
    "glb": "glb", "Open Inventor": "iv",
}


def write_text(path, head, middle, end, positions, faces, row):
    """A text file of rows of three coordinates, all digits of a float, and rows of faces."""
    with open(path, "w", encoding="ascii") as file:
        file.write(head)
        np.savetxt(file, positions, fmt=("v " if row.startswith("f") else "") + "%.9g %.9g %.9g"
                   + ("," if row.endswith(",") else ""))
        file.write(middle)
        np.savetxt(file, faces, fmt=row)
        file.write(end)


def write_all(stem, positions, faces):
    """The mesh as a file of each format, by nobody who is compared."""
    import trimesh

    positions, faces = positions.astype("<f4"), faces.astype("<i4")
    sizes = f"{len(positions)} {len(faces)} 0\n"
    head = f"ply\nformat %s 1.0\nelement vertex {len(positions)}\n"
    head += "".join(f"property float {name}\n" for name in "xyz")
    head += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    write_text(f"{stem}.obj", "", "", "", positions, faces + 1, "f %d %d %d")
    write_text(f"{stem}.off", f"OFF\n{sizes}", "", "", positions, faces, "3 %d %d %d")
    write_text(f"{stem}.ascii.ply", head % "ascii", "", "", positions, faces, "3 %d %d %d")
    write_text(f"{stem}.iv", "#Inventor V2.1 ascii\nSeparator {\nCoordinate3 { point [\n",
               "] }\nIndexedFaceSet { coordIndex [\n", "] }\n}\n", positions, faces,
               "%d, %d, %d, -1,")
    rows = np.zeros(len(faces), dtype=[("n", "u1"), ("corners", "<i4", 3)])
    rows["n"], rows["corners"] = 3, faces
    binary = (head % "binary_little_endian").encode() + positions.tobytes() + rows.tobytes()
    Path(f"{stem}.ply").write_bytes(binary)
    rows = np.zeros(len(faces), dtype=[("normal", "<f4", 3), ("corners", "<f4", 9), ("n", "<u2")])
    rows["corners"] = positions[faces].reshape(-1, 9)
    head = b"binary STL".ljust(80) + np.uint32(len(faces)).tobytes()
    Path(f"{stem}.stl").write_bytes(head + rows.tobytes())
    trimesh.Trimesh(positions, faces, process=False).export(f"{stem}.glb")


def pymeshlab(path):
    import pymeshlab

    found = pymeshlab.MeshSet()
    found.load_new_mesh(path)
    return found.current_mesh().vertex_number(), found.current_mesh().face_number()


def vtk(path):
    import vtk

    readers = {"obj": vtk.vtkOBJReader, "ply": vtk.vtkPLYReader, "stl": vtk.vtkSTLReader,
               "off": vtk.vtkOFFReader, "glb": vtk.vtkGLTFReader}
    reader = readers[path.rsplit(".", 1)[1]]()
    reader.SetFileName(path)
    reader.Update()
    found = reader.GetOutput()
    while found.IsA("vtkMultiBlockDataSet"):
        found = found.GetBlock(0)
    return found.GetNumberOfPoints(), found.GetNumberOfCells()


def trimesh(path):
    import trimesh

    # By processing, trimesh joins what STL has apart.
    found = trimesh.load(path, force="mesh", process=path.endswith(".stl"))
    return len(found.vertices), len(found.faces)


def open3d(path):
    import open3d

    found = open3d.io.read_triangle_mesh(path)
    return len(found.vertices), len(found.triangles)


# Each reads a file; gives the numbers of vertices and faces.
PEERS = {"pymeshlab": pymeshlab, "VTK": vtk, "trimesh": trimesh, "Open3D": open3d}
KNOWS = {"tobj": ("obj",), "Coin": ("iv",)}
KNOWS |= {name: ("obj", "ply", "ascii.ply", "stl", "off", "glb") for name in PEERS}


def read(name, path, runs):
    """What a process of this file does: reads so many times."""
    cpu, load = [], PEERS[name]
    for _ in range(runs + 1):
        start = time.process_time()
        vertices, faces = load(path)
        cpu.append(time.process_time() - start)
    # The first loads the program as well.
    print(json.dumps({"cpu": cpu[1:], "vertices": vertices, "faces": faces}))


def executable():
    """The bench of the formats, by cargo."""
    words = ["cargo", "bench", "--locked", "--no-run", "-p", "mve-formats", "--bench", "loading"]
    done = subprocess.run([*words, "--message-format=json"], check=True, cwd=meshes.ROOT,
                          capture_output=True, text=True)
    built = (json.loads(line) for line in done.stdout.splitlines())
    return next(one["executable"] for one in built if one.get("executable"))


def once(words, core):
    done = subprocess.run(["taskset", "-c", str(core), *words], capture_output=True, text=True,
                          env={**os.environ, **bench.ONE_THREAD}, timeout=bench.MOST_SECONDS)
    if done.returncode != 0:
        raise RuntimeError((done.stderr.strip().splitlines() or [f"{done.returncode}"])[-1][:160])
    return json.loads(done.stdout.splitlines()[-1])


def words_of(name, mve, path, runs):
    if name in ("mve", "tobj"):
        return [mve, name, path, str(runs)]
    if name == "Coin":
        return [str(programs.FOLDER / "coin"), "--time", str(runs), path]
    return [sys.executable, __file__, "--read", name, path, str(runs)]


def cell(found, expected, best):
    if found is None:
        return ""
    text = tables.brief(1000 * statistics.median(found["cpu"]))
    text = f"**{text}**" if found is best else text
    vertices = found.get("vertices", expected)
    return text if vertices == expected else f"{text} ({vertices:,} vertices)"


def table_of(results, mesh, size):
    """Rows of programs, columns of formats; the fastest of each is bold."""
    head = f"milliseconds, {mesh}, {size[0]:,} vertices, {size[1]:,} faces"
    lines = [f"| {head} | {' | '.join(FORMATS)} |", "| --- " * (len(FORMATS) + 1) + "|"]
    median = lambda found: statistics.median(found["cpu"])
    best = {}
    for ending in FORMATS.values():
        all_found = [row[ending] for row in results.values() if row.get(ending)]
        best[ending] = min(all_found, key=median, default=None)
    for name, row in results.items():
        cells = [cell(row.get(ending), size[0], best[ending]) for ending in FORMATS.values()]
        lines.append(f"| {name} | {' | '.join(cells)} |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(prog="tests/peers/run loaders")
    parser.add_argument("--runs", type=int, default=5, help="readings whose median counts [5]")
    parser.add_argument("--core", type=int, default=0, help="the processor to run on [0]")
    parser.add_argument("--mesh", default="", help="only the mesh of this name: bunny or noisy 1M")
    parser.add_argument("--write", action="store_true", help="into docs/BENCHMARKS.md")
    args = parser.parse_args()
    mve, parts = executable(), []
    for mesh in ("bunny", "noisy 1M"):
        made = meshes.make(mesh, None) if args.mesh in ("", mesh) else None
        if made is None:
            continue
        size, results = (len(made[0]), len(made[1])), {}
        with tempfile.TemporaryDirectory() as folder:
            stem = str(Path(folder) / "mesh")
            write_all(stem, *made)
            for name in ("mve", "tobj", *PEERS, "Coin"):
                row = results[name] = {}
                for ending in FORMATS.values():
                    if ending not in KNOWS.get(name, FORMATS.values()):
                        continue
                    path = f"{stem}.{ending}"
                    try:
                        row[ending] = once(words_of(name, mve, path, args.runs), args.core)
                    except (RuntimeError, subprocess.TimeoutExpired) as error:
                        print(f"{mesh} {name} {ending}: {error}", file=sys.stderr)
                        continue
                    print(mesh, name, ending, json.dumps(row[ending]), flush=True)
        parts.append(table_of(results, mesh, size))
    packages = {"pymeshlab": "pymeshlab", "VTK": "vtk", "trimesh": "trimesh", "Open3D": "open3d"}
    known = ", ".join(f"{name} {found}" for name, package in packages.items()
                      if (found := version_of(package)))
    head = f"{datetime.date.today()}; {bench.machine()}. Medians of {args.runs} readings. {known}."
    text = "\n\n".join([textwrap.fill(head, 100), *parts])
    print(text)
    if args.write:
        tables.put(text, meshes.ROOT / "docs" / "BENCHMARKS.md", *MARKS)


def version_of(package):
    for name in (package, f"{package}-cpu"):
        try:
            return version(name)
        except ModuleNotFoundError:
            pass
    return None


if __name__ == "__main__":
    if sys.argv[1:2] == ["--read"]:
        read(sys.argv[2], sys.argv[3], int(sys.argv[4]))
    else:
        main()
