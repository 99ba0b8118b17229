"""mve's own settings, and one of its runs with the seconds of the node that simplifies."""

import json
import math
import subprocess
import time
from pathlib import Path

import meshes

COMMAND = meshes.ROOT / "target" / "release" / "mve"

LINDSTROM_TURK = {"cost": "LindstromTurk", "placement": "LindstromTurk"}
HEAD_START = {**LINDSTROM_TURK, "head_start": 3}
ALL_MEMORY = {"cost": {"Quadric": {"memory": 1}}}

# Settings of `Simplificator`, by their names in the table: a line each.
SETTINGS = {
    "mve": {},
    "mve, refit 1": {"refit": 1},
    "mve, refit 2": {"refit": 2},
    "mve, refit 6": {"refit": 6},
    "mve, head start 2.5": {"head_start": 2.5},
    "mve, one queue": {"order": "Greedy"},
    "mve Quadric, all memory": ALL_MEMORY,
    "mve Quadric, all memory, refit 1": {**ALL_MEMORY, "refit": 1},
    "mve LindstromTurk": LINDSTROM_TURK,
    "mve LindstromTurk, refit 6": {**LINDSTROM_TURK, "refit": 6},
    "mve LindstromTurk, head start 3": HEAD_START,
    "mve LindstromTurk, head start 3, refit 1": {**HEAD_START, "refit": 1},
    "mve LindstromTurk, head start 3, refit 6": {**HEAD_START, "refit": 6},
}

# What `run clusters` compares, with the module where that is another one.
THESIS = {"importance": "EdgeSwitching", "edge": "Shortest", "order": "Passes"}
CLUSTERS = {
    "mve, uniform cells": {"module": "ClusterVertices"},
    "mve, uniform cells, manifold": {"module": "ClusterVertices", "manifold": True},
    "mve, floating cells": {"module": "ClusterVertices", "cells": "Floating"},
    "mve, floating cells, manifold":
        {"module": "ClusterVertices", "cells": "Floating", "manifold": True},
    "mve, vertex decimation": {"module": "DecimateVertices"},
    "mve, vertex decimation of the thesis": {"module": "DecimateVertices", **THESIS},
    "mve": {},
}

ALL = {**SETTINGS, **CLUSTERS}

# A parameter of each module and its default: a billionth more of it tells equal nodes apart and
# changes nothing.
TWEAKS = {
    "Simplificator": ("sliver_angle", 3),
    "ClusterVertices": ("length_weight", 1),
    "DecimateVertices": ("feature_angle", 60),
}

# The seconds that pass on two threads and on one, in place of those of the processor.
WALL = {"mve, 1 thread": 1, "mve, 2 threads": 2}


def process_seconds(pid):
    """Seconds that all processors have worked for a process so far (Linux)."""
    # The number of a process's clock, as clock_getcpuclockid(3) makes it.
    return time.clock_gettime((~pid << 3) | 2)


def status(pid, key):
    """Bytes of a line of a process's status; not a number once the process has ended."""
    with open(f"/proc/{pid}/status", encoding="ascii") as lines:
        found = [line.split()[1] for line in lines if line.startswith(key + ":")]
    return 1024 * int(found[0]) if found else math.nan


def map_of(setting, target, n_calls, source):
    """A map that loads, simplifies so many times, and saves."""
    nodes = {"load": {"module": "ObjLoader", "params": {"path": str(source)}}}
    links = ["cut0.mesh -> save.mesh"]
    for call in range(n_calls):
        # Equal nodes are computed once. The first, which is saved, is as asked for.
        params = {"target_faces": target, **setting}
        module = params.pop("module", "Simplificator")
        tweak, value = TWEAKS[module]
        params.update({tweak: value + call * 1e-9} if call else {})
        nodes[f"cut{call}"] = {"module": module, "params": params}
        links.append(f"load.mesh -> cut{call}.mesh")
    nodes["save"] = {"module": "ObjSaver", "params": {"path": "simplified.obj"}}
    return {"mve": 1, "nodes": nodes, "links": links}


def run(setting, target, n_calls, source, folder, pinned, threads=1):
    """One run. `wall` is the mean of the seconds in the records of the nodes that simplify; `cpu`
    is the time of the processor between the events at the start of the first and at the end of the
    last of them, for each, but no more than `wall`, which one thread cannot exceed."""
    path = Path(folder) / "map.json"
    path.write_text(json.dumps(map_of(setting, target, n_calls, source)), encoding="utf-8")
    words = [*pinned, str(COMMAND), "run", str(path), "--json", "--out", str(folder)]
    words += ["--threads", str(threads)]
    found, start, walls, pipe = {}, None, [], subprocess.PIPE
    with subprocess.Popen(words, stdout=pipe, stderr=pipe, text=True) as process:
        for line in process.stdout:
            event = json.loads(line)
            what, node = event["event"], event.get("node") or ""
            if (what, node) == ("started", "load"):
                found["before"] = status(process.pid, "VmRSS")
            elif what == "started" and node.startswith("cut") and start is None:
                Path(f"/proc/{process.pid}/clear_refs").write_text("5", encoding="ascii")
                start = process_seconds(process.pid)
            elif what == "ended" and node.startswith("cut"):
                found["cpu"] = (process_seconds(process.pid) - start) / n_calls
                found.setdefault("peak", status(process.pid, "VmHWM"))
                walls.append(event["record"].get("seconds", 0.0))
        told = process.stderr.read().strip()
    if process.returncode != 0 or len(walls) != n_calls:
        raise RuntimeError(told[-160:] or f"mve ended with {process.returncode}")
    found["wall"] = sum(walls) / n_calls
    found["cpu"] = found["wall"] if threads > 1 else min(found["cpu"], found["wall"])
    return found


def version():
    """What the command says of itself."""
    words = [str(COMMAND), "--version"]
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout.split()[1]
