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
    "rms": ("RMS distance", "of the diagonal", "chief"),
    "max": ("largest distance", "of the diagonal", "chief"),
    "seconds_a_million": ("time", "s a million faces", "detail"),
    "folds": ("folded edges", "", "detail"),
    "slivers": ("slivers", "", "detail"),
}


def write(rows, folder):
    """Writes the store, of programs that gave a result on all meshes."""
    results = tables.Results(rows)
    programs = [program for program in results.programs if results.all_of(program)]
    shutil.rmtree(folder, ignore_errors=True)
    steps = []
    for mesh in results.meshes:
        for program in programs:
            params = {"input.mesh": mesh, "peer.program": program}
            step = hashlib.sha256(json.dumps(params).encode()).hexdigest()[:16]
            steps.append({"id": step, "repeat": 0, "params": params})
            row = results.row(program, mesh)
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
              "measures": [{"column": f"result.{name}"} for name in ("rms", "max")]}
    axes = [{"input.mesh": results.meshes}, {"peer.program": programs}]
    plan = {"program": "peers", "mve": "0", "inputs": {}, "modules": {}, "steps": steps,
            "varied": ["input.mesh", "peer.program"], "nodes": ["input", "peer", "result"],
            "spec": {"axes": axes, "report": report}, "columns": columns,
            "map": {"mve": 1, "title": "Programs that simplify meshes", "nodes": {}}}
    (folder / "plan.json").write_text(json.dumps(plan), encoding="utf-8")
