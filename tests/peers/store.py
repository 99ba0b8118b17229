"""A store that `mve report` draws: a step for each program on each mesh.

The report has what a report of mve has: tables with the best of each row, and plots of the
distances against the time with the Pareto front.
"""

import hashlib
import json
import shutil

import tables

# What the report shows of a step: name, title, unit, and part in the report.
MEASURES = {
    "ratio": ("RMS to Lindstrom-Turk", "", "chief"),
    "rms": ("RMS distance", "of the diagonal", "chief"),
    "max": ("largest distance", "of the diagonal", "chief"),
    "seconds_a_million": ("time", "s a million faces", "detail"),
    "folds": ("folded edges", "", "detail"),
    "slivers": ("slivers", "", "detail"),
}


# Programs of a larger RMS, in the mean over the meshes, are in the tables alone.
LARGEST_RATIO = 2.6

# The file of the plot among those of the report.
PLOT = "result.ratio-by-result.seconds_a_million.svg"


def write(rows, folder):
    """Writes the store, of programs that gave a result on all meshes, and of a distance that leaves
    the others apart. False where the program that all are held against has no result."""
    results = tables.Results(rows)
    programs = [p for p in results.programs if results.ratio(p) <= LARGEST_RATIO]
    if not programs:
        return False
    shutil.rmtree(folder, ignore_errors=True)
    steps = []
    for mesh in results.meshes:
        for program in programs:
            params = {"input.mesh": mesh, "peer.program": program}
            step = hashlib.sha256(json.dumps(params).encode()).hexdigest()[:16]
            steps.append({"id": step, "repeat": 0, "params": params})
            row = dict(results.row(program, mesh))
            row["ratio"] = row["rms"] / results.row(tables.REFERENCE, mesh)["rms"]
            node = {"module": "Peer", "status": "done", "key": "0" * 64,
                    "scalars": {name: row[name] for name in MEASURES}}
            record = {"id": step, "repeat": 0, "params": params, "status": "done",
                      "seconds": row["cpu"], "version": "0", "nodes": {"result": node}}
            path = folder / "steps" / step
            (path / "outputs").mkdir(parents=True)
            (path / "record.json").write_text(json.dumps(record), encoding="utf-8")
    columns = {
        f"result.{name}": [{"title": title, "unit": unit, "better": "lower", "role": role}]
        for name, (title, unit, role) in MEASURES.items()
    }
    report = {"against": ["result.seconds_a_million"], "group": "input.mesh",
              "series": ["peer.program"],
              "measures": [{"column": f"result.{name}"} for name in ("ratio", "rms", "max")]}
    axes = [{"input.mesh": results.meshes}, {"peer.program": programs}]
    plan = {"program": "peers", "mve": "0", "inputs": {}, "modules": {}, "steps": steps,
            "varied": ["input.mesh", "peer.program"], "nodes": ["input", "peer", "result"],
            "spec": {"axes": axes, "report": report}, "columns": columns,
            "map": {"mve": 1, "title": "Programs that simplify meshes", "nodes": {}}}
    (folder / "plan.json").write_text(json.dumps(plan), encoding="utf-8")
    return True
