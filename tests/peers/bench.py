"""Runs all programs on all meshes, one after another, and writes what `tables.py` draws.

Started by `run`, in the environment that it makes.
"""

import argparse
import csv
import datetime
import json
import math
import os
import platform
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import measure
import meshes
import mve
import programs
import store
import tables

CGAL = {
    "CGAL Lindstrom-Turk": "lindstrom_turk",
    "CGAL Lindstrom-Turk, bounded": "lindstrom_turk_bounded",
    "CGAL Garland-Heckbert plane": "plane",
    "CGAL Garland-Heckbert triangle": "triangle",
    "CGAL probabilistic plane": "probabilistic_plane",
    "CGAL probabilistic triangle": "probabilistic_triangle",
}

COLUMNS = (
    "mesh input_faces target program version runs cpu seconds_a_million before peak "
    "bytes_a_face rms rms_there rms_back max faces euler_before euler non_manifold_before "
    "non_manifold folds_before folds slivers_before slivers error"
).split()

# One thread whatever a program takes its number of threads from.
ONE_THREAD = {
    name: "1"
    for name in ("OMP_NUM_THREADS", "RAYON_NUM_THREADS", "TBB_NUM_THREADS", "MKL_NUM_THREADS",
                 "OPENBLAS_NUM_THREADS", "VTK_SMP_MAX_THREADS")
}

# A program that takes longer than the first in a run is not run again; one that takes longer than
# the second is stopped.
LONG_SECONDS = 5.0
MOST_SECONDS = 900.0


class Bench:
    """Where things are, and what a run is made of."""

    def __init__(self, args, scratch):
        self.args, self.scratch = args, Path(scratch).resolve()
        self.pinned = ["taskset", "-c", str(args.core)]

    def once(self, name, mesh, case, hint):
        """Runs a program once; gives what it says, and its result."""
        source, result = mesh.with_suffix(".mesh"), self.scratch / "result.mesh"
        n_calls = meshes.n_calls(case["input_faces"])
        target = str(case["target"])
        if name in mve.ALL or name in mve.WALL:
            setting, n_threads = mve.ALL.get(name, {}), mve.WALL.get(name, 1)
            pinned = self.pinned if name in mve.ALL else []
            found = mve.run(setting, case["target"], n_calls, mesh.with_suffix(".obj"),
                            self.scratch, pinned, n_threads)
            found["cpu"] = found["cpu"] if name in mve.ALL else found["wall"]
            result = self.scratch / "simplified.obj"
            return found, lambda: meshes.read_obj(result)
        if name in CGAL:
            words = [str(programs.FOLDER / "cgal"), CGAL[name]]
        else:
            words = [sys.executable, str(Path(__file__).with_name("programs.py")), name]
        words += [target, str(n_calls), str(source), str(result)] + ([str(hint)] if hint else [])
        done = subprocess.run(
            self.pinned + words, capture_output=True, text=True, timeout=MOST_SECONDS,
            env={**os.environ, **ONE_THREAD},
        )
        if done.returncode != 0:
            lines = done.stderr.strip().splitlines() or [f"ended with {done.returncode}"]
            raise RuntimeError(lines[-1][:160])
        return json.loads(done.stdout.splitlines()[-1]), lambda: meshes.read(result)

    def row(self, name, mesh, case):
        """Runs a program as often as asked and measures its result."""
        row = {**case, "program": name, "error": ""}
        found = []
        try:
            while len(found) < self.args.runs:
                hint = found[-1].get("hint") if found else None
                one, result = self.once(name, mesh, case, hint)
                found.append(one)
                if one["cpu"] > LONG_SECONDS:
                    break
        except (RuntimeError, subprocess.TimeoutExpired) as error:
            return {**row, "error": str(error)}
        middle = statistics.median(one["cpu"] for one in found)
        known = [one for one in found if one["peak"] >= one["before"]]
        peak, before = (max((one[key] for one in known), default=math.nan)
                        for key in ("peak", "before"))
        simplified = result()
        row.update(measure.counts(*simplified))
        row.update(
            measure.distances(meshes.read(mesh.with_suffix(".mesh")), simplified, self.args.samples)
        )
        row.update(
            version=found[0].get("version", self.version(name)), runs=len(found), cpu=middle,
            seconds_a_million=middle / case["input_faces"] * 1e6, before=before, peak=peak,
            bytes_a_face=(peak - before) / case["input_faces"],
        )
        return row

    def version(self, name):
        """Of what has none in the package index."""
        if name in mve.ALL or name in mve.WALL:
            return mve.version()
        key = "cgal" if name in CGAL else "meshoptimizer"
        return json.loads((programs.FOLDER / "versions.json").read_text(encoding="utf-8"))[key]

    def case(self, name, path=None):
        """Makes a mesh and its files; gives the files' stem and what is known of the mesh."""
        mesh = meshes.make(name, path)
        if mesh is None:
            return None
        stem = self.scratch / re.sub(r"\W+", "_", name)
        meshes.write(stem.with_suffix(".mesh"), *mesh)
        meshes.write_obj(stem.with_suffix(".obj"), *mesh)
        counts = measure.counts(*mesh)
        kept = ("euler", "non_manifold", "folds", "slivers")
        case = {"mesh": name, "input_faces": counts["faces"]}
        case["target"] = meshes.target(name, counts["faces"])
        case.update({f"{key}_before": counts[key] for key in kept})
        return stem, case


def machine():
    """The machine, in words."""
    with open("/proc/cpuinfo", encoding="utf-8") as lines:
        names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    name = f"{names[0]}, " if names else ""
    system = f"{platform.system()} {platform.release()}"
    return f"{name}{os.cpu_count()} cores at a load of {os.getloadavg()[2]:.0f}, {system}"


def arguments():
    parser = argparse.ArgumentParser(prog="tests/peers/run", description=__doc__.split("\n")[0])
    parser.add_argument("files", nargs="*", type=Path, help="further meshes, OBJ or PLY")
    parser.add_argument("--quick", action="store_true", help="the bunny alone, one run")
    parser.add_argument("--growth", action="store_true", help="also 100 k and 4 M faces of noise")
    parser.add_argument("--runs", type=int, default=3, help="runs of which the median counts [3]")
    parser.add_argument("--mesh", default="", help="only meshes whose name has this pattern")
    parser.add_argument("--program", default="", help="only programs whose name has this pattern")
    parser.add_argument("--core", type=int, default=0, help="the processor to run on [0]")
    parser.add_argument("--samples", type=int, default=measure.N_SAMPLES,
                        help="samples each way [1000000]")
    parser.add_argument("--out", type=Path, default=programs.FOLDER / "out",
                        help="folder of results.csv and the tables [target/peers/out]")
    parser.add_argument("--keep", action="store_true",
                        help="keep the rows that results.csv has and make those that lack")
    parser.add_argument("--write", action="store_true",
                        help="put the tables into docs/BENCHMARKS.md, and draw the plot")
    args = parser.parse_args()
    if args.quick:
        args.runs, args.mesh = 1, "^bunny$"
    return args


def main():
    args = arguments()
    measure.check()
    args.out.mkdir(parents=True, exist_ok=True)
    table = args.out / "results.csv"
    rows = tables.read(table) if args.keep and table.exists() else []
    done = {(row["mesh"], row["program"]) for row in rows}
    names = [(name, None) for name in [*meshes.MODELS, "noisy 1M"]]
    names += [(name, None) for name in ("noisy 100k", "noisy 4M") if args.growth]
    names += [(path.name.split(".")[0], path) for path in args.files]
    names = [(name, path) for name, path in names if re.search(args.mesh, name)]
    all_programs = [*mve.SETTINGS, *programs.PROGRAMS, *CGAL]
    with tempfile.TemporaryDirectory(dir=args.out) as scratch:
        bench = Bench(args, scratch)
        for name, path in names:
            wanted = all_programs if name not in tables.GROWTH else [tables.DEFAULT]
            if args.growth and name == tables.LARGE:
                wanted = wanted + list(mve.WALL)
            wanted = [p for p in wanted if re.search(args.program, p) and (name, p) not in done]
            made = bench.case(name, path) if wanted else None
            if wanted and made is None:
                print(f"{name}: skipped, not among the models in {meshes.folder()}; MVE_MODELS "
                      "names their folder", flush=True)
                continue
            for program in wanted:
                row = bench.row(program, *made)
                row["date"] = datetime.date.today().isoformat()
                rows.append(row)
                print(tables.line(row), flush=True)
                with open(table, "w", encoding="utf-8", newline="") as file:
                    writer = csv.DictWriter(file, [*COLUMNS, "date"], extrasaction="ignore")
                    writer.writeheader()
                    writer.writerows(rows)
    rows = tables.read(table)
    text = tables.markdown(rows, machine())
    (args.out / "results.md").write_text(text + "\n", encoding="utf-8")
    print(text)
    if store.write(rows, args.out / "store"):
        draw(args.out / "store", meshes.ROOT / "docs" / "pictures" if args.write else args.out)
    if args.write:
        tables.put(text, meshes.ROOT / "docs" / "BENCHMARKS.md")


def draw(folder, destination):
    """The report of the store, and its plot of the distances against the time."""
    words = [str(mve.COMMAND), "report", str(folder)]
    subprocess.run([*words, "--out", str(folder.with_name("report.html"))], check=True)
    subprocess.run([*words, "--format", "svg", "--out", str(folder / "plots")], check=True)
    shutil.copyfile(folder / "plots" / store.PLOT, destination / "peers.svg")


if __name__ == "__main__":
    main()
