"""What `results.csv` says: tables of times, distances and faults, and what was to be reached."""

import csv
import math
import textwrap

import mve

GROWTH = ("noisy 100k", "noisy 4M")
REFERENCE = "CGAL Lindstrom-Turk"
CAREFUL = "VTK QuadricDecimation"
LARGE = "noisy 1M"
DEFAULT = "mve"
PLAIN = "mve Quadric, all memory"
# What the largest distance of one mesh differs by from one sampling to the next.
NOISE = 1.05
BEGIN, END = "<!-- tests/peers begins -->", "<!-- tests/peers ends -->"


def number(text):
    """A cell of the file as a number, where it is one."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


def read(path):
    """The rows of `results.csv`."""
    with open(path, encoding="utf-8", newline="") as file:
        return [{key: number(value) for key, value in row.items()} for row in csv.DictReader(file)]


def line(row):
    """A row for who waits for it."""
    head = f"{row['mesh']:10} {row['program']:32}"
    if row["error"]:
        return f"{head} {row['error']}"
    return (
        f"{head} {row['seconds_a_million']:7.3f} s/M {row['bytes_a_face']:5.0f} B/face  "
        f"rms {row['rms'] * 1e4:8.4f}e-4  max {row['max'] * 1e4:7.2f}e-4  faces {row['faces']}  "
        f"euler {row['euler_before']} {row['euler']}  non-manifold {row['non_manifold']}  "
        f"folds {row['folds']}  slivers {row['slivers']}"
    )


def brief(value, n_digits=3):
    """A number with so many digits that count."""
    if value == 0 or not math.isfinite(value):
        return f"{value:g}"
    n_behind = max(0, n_digits - 1 - math.floor(math.log10(abs(value))))
    return f"{value:.{n_behind}f}"


def geometric_mean(values):
    values = list(values)
    return math.exp(sum(math.log(value) for value in values) / len(values)) if values else math.nan


def table(header, rows):
    """Lines of a Markdown table."""
    lines = [header, ["---"] * len(header), *rows]
    return ["| " + " | ".join(str(cell) for cell in cells) + " |" for cells in lines]


class Results:
    """The rows by program and mesh."""

    def __init__(self, rows):
        self.errors = [row for row in rows if row["error"]]
        self.rows = {(row["program"], row["mesh"]): row for row in rows if not row["error"]}
        self.all_meshes = list(dict.fromkeys(row["mesh"] for row in rows))
        self.meshes = [mesh for mesh in self.all_meshes if mesh not in GROWTH]
        programs = dict.fromkeys(row["program"] for row in rows)
        self.programs = [name for name in programs if name not in mve.WALL]

    def row(self, program, mesh):
        return self.rows.get((program, mesh))

    def all_of(self, program):
        """Its rows on all meshes; empty where one lacks."""
        rows = [self.row(program, mesh) for mesh in self.meshes]
        return rows if all(rows) else []

    def seconds(self, program):
        """Geometric mean over all meshes of the seconds a million faces."""
        return geometric_mean(row["seconds_a_million"] for row in self.all_of(program))

    def ratio(self, program, key="rms", other=REFERENCE):
        """Geometric mean over all meshes of what it has over what another program has."""
        rows, others = self.all_of(program), self.all_of(other)
        if not rows or not others:
            return math.nan
        return geometric_mean(row[key] / peer[key] for row, peer in zip(rows, others))

    def by_ratio(self):
        """Programs, the least distance first; those that failed on a mesh last."""
        def key(program):
            ratio = self.ratio(program)
            return (math.isnan(ratio), ratio, self.seconds(program))

        return sorted(self.programs, key=key)

    def front(self):
        """Programs that none beats in both means."""
        points = {p: (self.seconds(p), self.ratio(p)) for p in self.programs if self.all_of(p)}
        return {
            program
            for program, (x, y) in points.items()
            if not any(a < x and b < y for a, b in points.values())
        }


def name_of(program):
    return f"**{program}**" if program.startswith("mve") else program


def times_and_distances(results):
    header = ["seconds a million faces / RMS", *results.meshes, "seconds", "RMS to Lindstrom-Turk"]
    header.append("front")
    front, rows = results.front(), []
    for program in results.by_ratio():
        cells = [name_of(program)]
        for mesh in results.meshes:
            row = results.row(program, mesh)
            pair = row and (brief(row["seconds_a_million"]), brief(row["rms"] * 1e4))
            cells.append(" / ".join(pair) if pair else "")
        is_whole = bool(results.all_of(program))
        means = [brief(results.seconds(program)), brief(results.ratio(program))]
        rows.append(cells + (means if is_whole else ["", ""]) + ["●" if program in front else ""])
    return table(header, rows)


def faults(results):
    header = ["largest distance; what went wrong", *results.meshes, "new non-manifold edges"]
    header += ["another Euler characteristic", "folds", f"folds, {LARGE}", "slivers"]
    header.append(f"bytes a face, {LARGE}")
    rows = []
    for program in results.by_ratio():
        found = [results.row(program, mesh) for mesh in results.meshes]
        cells = [name_of(program), *(brief(row["max"] * 1e4) if row else "" for row in found)]
        there = [row for row in found if row]
        new = (max(0, row["non_manifold"] - row["non_manifold_before"]) for row in there)
        cells += [sum(new), sum(row["euler"] != row["euler_before"] for row in there)]
        large = results.row(program, LARGE)
        cells += [sum(row["folds"] for row in there), large["folds"] if large else ""]
        cells.append(sum(row["slivers"] for row in there))
        rows.append([*cells, brief(large["bytes_a_face"]) if large else ""])
    return table(header, rows)


def targets(results):
    """What is to be reached, what was found, and whether that is enough."""
    rows = []
    own = [program for program in mve.SETTINGS if results.all_of(program)]
    if not own or not results.all_of(REFERENCE):
        return []

    def add(what, found, is_met):
        rows.append([what, found, "yes" if is_met else "**no**"])

    def fastest_within(limit):
        """The fastest setting of at most this RMS; the best one where there is none."""
        within = [program for program in own if results.ratio(program) <= limit]
        return min(within, key=results.seconds) if within else min(own, key=results.ratio)

    for name, ratio, seconds in (("fast", 1.00, 1.5), ("best", 0.86, 8.0)):
        program = fastest_within(ratio)
        found = results.seconds(program), results.ratio(program)
        add(f"{name}: at most {seconds} s a million, {ratio:.2f} of the RMS of {REFERENCE}",
            f"{program}: {brief(found[0])} s, {brief(found[1])}",
            found[0] <= seconds and found[1] <= ratio)
    plain = results.seconds(PLAIN)
    if math.isfinite(plain):
        add("Quadric alone: at most 2.0 s a million", f"{brief(plain)} s", plain <= 2.0)

    def worst(key):
        return max(own, key=key), max(key(program) for program in own)

    def new_edges(program):
        found = results.all_of(program)
        return sum(max(0, row["non_manifold"] - row["non_manifold_before"]) for row in found)

    def new_topology(program):
        return sum(row["euler"] != row["euler_before"] for row in results.all_of(program))

    program, count = worst(new_edges)
    add("no new non-manifold edge", f"{count} ({program})" if count else "none", count == 0)
    program, count = worst(new_topology)
    add("Euler characteristic kept", f"{count} meshes ({program})" if count else "on all",
        count == 0)
    if LARGE in results.meshes:
        program, count = worst(lambda program: results.row(program, LARGE)["folds"])
        add(f"fewer than 20 folds, {LARGE}", f"at most {count} ({program})", count < 20)
        program, count = worst(lambda program: results.row(program, LARGE)["bytes_a_face"])
        add("at most 250 bytes a face", f"at most {brief(count)} ({program})", count <= 250)
    for program in own if results.all_of(CAREFUL) else []:
        pairs = zip(results.all_of(program), results.all_of(CAREFUL))
        larger = [row["mesh"] for row, peer in pairs if row["max"] > NOISE * peer["max"]]
        add(f"largest distance no worse than {CAREFUL}: {program}",
            "larger on " + ", ".join(larger) if larger else "on all", not larger)
    small, large = (results.row(DEFAULT, mesh) for mesh in GROWTH)
    if small and large:
        growth = large["seconds_a_million"] / small["seconds_a_million"]
        add("4 M faces: at most 1.3 times the time a face of 100 k", brief(growth), growth <= 1.3)
    one, two = (results.row(program, LARGE) for program in mve.WALL)
    if one and two:
        gain = one["cpu"] / two["cpu"]
        add("two threads: at least 1.6 times as fast", brief(gain), gain >= 1.6)
    return table(["to be reached", "found", "met"], rows)


def markdown(rows, machine):
    """The section of docs/BENCHMARKS.md."""
    results = Results(rows)
    versions = {}
    for row in rows:
        if row.get("version"):
            versions.setdefault(row["program"].split(",")[0].split(" ")[0], row["version"])
    dates = sorted({row["date"] for row in rows})
    sizes = {row["mesh"]: (row["input_faces"], row["target"]) for row in rows}
    meshes = "; ".join(f"{mesh} {n:,} to {m:,}" for mesh, (n, m) in sizes.items())
    failed = {f"{row['program']} on {row['mesh']}: {row['error']}" for row in results.errors}
    named = ", ".join(f"{name} {version}" for name, version in versions.items())
    about = (
        f"{' to '.join(dict.fromkeys([dates[0], dates[-1]]))}; {machine}. Faces: {meshes}. "
        f"Versions: {named}. RMS and largest distances are 1e-4 of the diagonal."
    )
    lines = [
        *textwrap.wrap(about, 100),
        "",
        *times_and_distances(results),
        "",
        *faults(results),
        "",
        *targets(results),
    ]
    if failed:
        lines += ["", *textwrap.wrap("Not run: " + "; ".join(sorted(failed)) + ".", 100)]
    return "\n".join(lines)


def put(text, path, begin=BEGIN, end=END):
    """Replaces what stands between the markers of a document."""
    whole = path.read_text(encoding="utf-8")
    before, rest = whole.split(begin)
    after = rest.split(end)[1]
    path.write_text(f"{before}{begin}\n\n{text}\n\n{end}{after}", encoding="utf-8")
