"""Compares clusters and decimation of vertices with those of other programs.

Started by `run clusters`, in the environment that it makes, with the options of `bench.py`.
"""

import datetime
import re
import tempfile
import textwrap

import bench
import measure
import meshes
import mve
import programs
import tables

MESHES = ("bunny", "noisy 1M")
BEGIN, END = "<!-- tests/peers/clusters begins -->", "<!-- tests/peers/clusters ends -->"

# What was to be reached: seconds a million faces, RMS on the bunny in 1e-4 of the diagonal, and
# whether no edge may become non-manifold and none folded.
TARGETS = {
    "mve, uniform cells": (0.06, 6.2, False),
    "mve, floating cells": (0.15, 5.3, False),
    "mve, vertex decimation": (3.0, 7.3, True),
}


def row(results, program):
    """A program's line: seconds and distances on each mesh, and faults that are new."""
    cells = [tables.name_of(program)]
    for mesh in MESHES:
        found = results.row(program, mesh)
        if found is None:
            cells += ["", "", ""]
            continue
        new = [found[key] - found[f"{key}_before"] for key in ("non_manifold", "folds")]
        cells += [tables.brief(found["seconds_a_million"]), tables.brief(found["rms"] * 1e4)]
        cells.append(" / ".join(str(max(0, number)) for number in new))
    return cells


def targets(results):
    """What was to be reached on the bunny, and what was."""
    lines = []
    for program, (seconds, rms, is_clean) in TARGETS.items():
        found = results.row(program, "bunny")
        if found is None:
            continue
        figures = [(found["seconds_a_million"], seconds, "s a million faces"),
                   (found["rms"] * 1e4, rms, "RMS")]
        for value, most, what in figures:
            met = "yes" if value <= most else "no"
            lines.append([f"{program}: at most {most} {what}", tables.brief(value), met])
        if is_clean:
            new = [found[key] - found[f"{key}_before"] for key in ("non_manifold", "folds")]
            met = "yes" if max(new) <= 0 else "no"
            lines.append([f"{program}: no edge non-manifold or folded", " / ".join(map(str, new)), met])
    return tables.table(["to be reached on the bunny", "found", "met"], lines)


def markdown(rows):
    """The section of docs/BENCHMARKS.md."""
    results = tables.Results(rows)
    names = [name for name in results.programs if results.row(name, MESHES[0])]
    names.sort(key=lambda name: results.row(name, MESHES[0])["rms"])
    header = ["program"]
    for mesh in MESHES:
        header += [f"{mesh}: s/M", "RMS", "non-manifold / folds"]
    about = (
        f"{datetime.date.today().isoformat()}; {bench.machine()}. To a tenth of the faces: seconds "
        "of the processor a million faces, RMS both ways in 1e-4 of the diagonal, and edges that "
        "became non-manifold or folded."
    )
    body = tables.table(header, [row(results, name) for name in names])
    failed = [f"{found['program']} on {found['mesh']}: {found['error']}" for found in results.errors]
    lines = [*textwrap.wrap(about, 100), "", *body, "", *targets(results)]
    if failed:
        lines += ["", *textwrap.wrap("Not run: " + "; ".join(failed) + ".", 100)]
    return "\n".join(lines)


def main():
    args = bench.arguments()
    measure.check()
    # A few milliseconds are no measure, and the first call touches memory that is new.
    meshes.n_calls = lambda n_faces: 10 if n_faces < 100_000 else 3
    args.out.mkdir(parents=True, exist_ok=True)
    rows = []
    with tempfile.TemporaryDirectory(dir=args.out) as scratch:
        run = bench.Bench(args, scratch)
        for mesh in (name for name in MESHES if re.search(args.mesh, name)):
            made = run.case(mesh)
            if made is None:
                print(f"{mesh}: skipped, not among the models in {meshes.folder()}", flush=True)
                continue
            for name in [*mve.CLUSTERS, *programs.CLUSTERS]:
                if re.search(args.program, name):
                    rows.append(run.row(name, *made))
                    print(tables.line(rows[-1]), flush=True)
    text = markdown(rows)
    print(text)
    if args.write:
        tables.put(text, meshes.ROOT / "docs" / "BENCHMARKS.md", BEGIN, END)


if __name__ == "__main__":
    main()
