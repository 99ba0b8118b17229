"""Open Inventor files both ways: mve beside Coin and vtkIVWriter.

Started by `run inventor`, in the environment that it makes. mve writes meshes, Coin reads them, and
what Coin would draw is compared with the mesh; Coin and VTK write them, as text, packed by gzip and
in binary, and mve reads what they wrote. Of binary files mve says that they are.
"""

import argparse
import gzip
import json
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import meshes
import mve
import programs

COIN = programs.FOLDER / "coin"
# Coin holds floats, and adds up their products; the bounds are those of floats.
CLOSE = 1e-5


def counts(positions, faces):
    """Triangles, area, volume and bounds, as Coin's program gives them."""
    a, b, c = (positions[faces[:, k]] for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    used = positions[np.unique(faces)]
    return [len(faces), area, volume, *used.min(axis=0), *used.max(axis=0)]


def by_coin(path):
    """What Coin reads."""
    done = subprocess.run([str(COIN), str(path)], check=True, capture_output=True, text=True)
    line = done.stdout.rsplit(": ", 1)[1]
    if "triangles" not in line:
        raise RuntimeError(f"Coin: {done.stdout.strip()}")
    words = line.replace(",", " ").split()
    return [float(word) for word in words if re.fullmatch(r"[-+.\denaif]+", word)]


def convert(source, destination):
    """mve reads a file and writes another; gives the seconds of both, or what it says is wrong."""
    modules = {".iv": "Iv", ".gz": "Iv", ".obj": "Obj"}
    nodes = {
        "load": {"module": modules[source.suffix] + "Loader", "params": {"path": str(source)}},
        "save": {"module": modules[destination.suffix] + "Saver",
                 "params": {"path": destination.name}},
    }
    path = destination.with_name("map.json")
    map_text = {"mve": 1, "nodes": nodes, "links": ["load.mesh -> save.mesh"]}
    path.write_text(json.dumps(map_text), encoding="utf-8")
    words = [str(mve.COMMAND), "run", str(path), "--json", "--out", str(destination.parent)]
    done = subprocess.run([*words, "--threads", "1"], capture_output=True, text=True)
    if done.returncode != 0:
        return None, done.stdout + done.stderr
    events = [json.loads(line) for line in done.stdout.splitlines()]
    ends = [event for event in events if event["event"] == "ended"]
    return {event["node"]: event["record"]["seconds"] for event in ends}, ""


def by_mve(path):
    """What mve reads, through an OBJ file of it; and the seconds that it took."""
    text = path.with_name("read.obj")
    seconds, message = convert(path, text)
    if seconds is None:
        raise RuntimeError(message[-400:])
    return counts(*meshes.read_obj(text)), seconds["load"]


def by_vtk(path, positions, faces):
    """vtkIVWriter writes it."""
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

    points, cells, data = vtk.vtkPoints(), vtk.vtkCellArray(), vtk.vtkPolyData()
    points.SetData(numpy_to_vtk(positions.astype(np.float32), deep=True))
    starts = np.arange(0, 3 * len(faces) + 1, 3, dtype=np.int64)
    corners = faces.astype(np.int64).ravel()
    cells.SetData(*(numpy_to_vtkIdTypeArray(ids, deep=True) for ids in (starts, corners)))
    data.SetPoints(points)
    data.SetPolys(cells)
    writer = vtk.vtkIVWriter()
    writer.SetInputData(data)
    writer.SetFileName(str(path))
    writer.Write()


class Checks:
    """Counts what agrees, and says what does not."""

    def __init__(self):
        self.n, self.n_wrong = 0, 0

    def same(self, what, found, expected, close=CLOSE):
        """Compares counts, relative to the area, its volume and the size."""
        self.n += 1
        size = max(abs(value) for value in expected[3:])
        scale = [0.5, expected[1], expected[1] * size, *[size] * 6]
        is_same = all(abs(a - b) <= close * s for a, b, s in zip(found, expected, scale))
        is_same = is_same and len(found) == len(expected)
        self.n_wrong += not is_same
        shown = ", ".join(f"{value:.7g}" for value in found[:3])
        print(f"{'same' if is_same else 'OTHER'}  {what}: {shown}", flush=True)
        if not is_same:
            print(f"       expected {expected}\n       found    {found}")

    def that(self, what, is_so):
        self.n += 1
        self.n_wrong += not is_so
        print(f"{'same' if is_so else 'OTHER'}  {what}", flush=True)


def check(name, mesh, folder, checks):
    """A mesh both ways."""
    source, written, packed = folder / "mesh.obj", folder / "mve.iv", folder / "packed.iv.gz"
    meshes.write_obj(source, *mesh)
    # As the text says it.
    mesh = meshes.read_obj(source)
    expected = counts(*mesh)
    seconds, message = convert(source, written)
    if seconds is None:
        return checks.that(f"{name}: mve writes: {message[-300:]}", False)
    label = f"{name}, mve wrote in {seconds['save']:.2f} s"
    checks.same(f"{label}, Coin reads", by_coin(written), expected)
    with open(written, "rb") as plain, gzip.open(packed, "wb", compresslevel=1) as file:
        shutil.copyfileobj(plain, file)
    checks.same(f"{name}, mve wrote, packed, Coin reads", by_coin(packed), expected)
    # With all digits: to the last of a sum.
    for path in (written, packed):
        found, seconds = by_mve(path)
        checks.same(f"{name}, {path.name}, mve reads in {seconds:.2f} s", found, expected, 1e-12)
    for form in ("ascii", "gzip", "binary"):
        path = folder / f"coin-{form}.iv"
        words = [str(COIN), "--write", form, str(written), str(path)]
        subprocess.run(words, check=True)
        if form == "binary":
            seconds, message = convert(path, folder / "read.obj")
            is_said = seconds is None and "binary Open Inventor file" in message
            checks.that(f"{name}, Coin wrote in binary, mve says so", is_said)
            continue
        found, seconds = by_mve(path)
        checks.same(f"{name}, Coin wrote {form}, mve reads in {seconds:.2f} s", found, expected)
    path = folder / "vtk.iv"
    by_vtk(path, *mesh)
    found, seconds = by_mve(path)
    checks.same(f"{name}, vtkIVWriter wrote, mve reads in {seconds:.2f} s", found, expected)
    checks.same(f"{name}, vtkIVWriter wrote, Coin reads", by_coin(path), expected)


def main():
    parser = argparse.ArgumentParser(prog="tests/peers/run inventor")
    parser.add_argument("--quick", action="store_true", help="without the million faces")
    args = parser.parse_args()
    checks, start = Checks(), time.time()
    names = ["tetrahedron", "cow", "bunny"] + ([] if args.quick else ["noisy 1M"])
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        for name in names:
            mesh = meshes.tetrahedron() if name == "tetrahedron" else meshes.make(name)
            if mesh is None:
                print(f"{name}: skipped, not among the models in {meshes.folder()}")
                continue
            check(name, mesh, folder, checks)
        for path in sorted((meshes.ROOT / "tests" / "data").glob("*.iv")):
            copy = folder / path.name
            shutil.copyfile(path, copy)
            found, coin = by_mve(copy)[0], by_coin(copy)
            # Coin leaves what a transform mirrors inside out, so volumes differ.
            found[2] = coin[2]
            checks.same(f"{path.name}, both read", found, coin)
    print(f"{checks.n - checks.n_wrong} of {checks.n} agree, {time.time() - start:.0f} s")
    sys.exit(checks.n_wrong > 0)


if __name__ == "__main__":
    main()
