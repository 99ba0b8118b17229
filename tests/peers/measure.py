"""What a simplified mesh is worth: its distances from the original, and what became of it.

Distances are those of MeshLab's `get_hausdorff_distance`, area samples alone; the rest is counted
here. Nothing of mve enters.
"""

import numpy as np

# A fold: two faces whose normals are turned apart by more.
FOLD_DEG = 150.0
# A sliver: a face with a smaller angle.
SLIVER_DEG = 1.0
N_SAMPLES = 1_000_000


def distances(original, simplified, n_samples=N_SAMPLES):
    """Distances both ways over the diagonal of the original's box.

    `rms` is the square root of the mean of both directions' mean squares over area samples. `max`
    is the largest distance of all these samples and of the vertices of both.
    """
    import pymeshlab

    meshes = pymeshlab.MeshSet()
    for positions, faces in (original, simplified):
        meshes.add_mesh(pymeshlab.Mesh(positions, faces.astype(np.int32)))

    def way(source, other, is_of_vertices):
        return meshes.get_hausdorff_distance(
            sampledmesh=source,
            targetmesh=other,
            samplevert=is_of_vertices,
            sampleface=not is_of_vertices,
            samplenum=len(original[0]) + len(simplified[0]) if is_of_vertices else n_samples,
            maxdist=pymeshlab.PercentageValue(100),
        )

    ways = [way(0, 1, False), way(1, 0, False)]
    used = original[0][np.unique(original[1])]
    diagonal = np.linalg.norm(used.max(axis=0) - used.min(axis=0))
    there, back = (found["RMS"] / diagonal for found in ways)
    ways += [way(0, 1, True), way(1, 0, True)]
    return {
        "rms": float(np.sqrt((there**2 + back**2) / 2)),
        "rms_there": float(there),
        "rms_back": float(back),
        "max": float(max(found["max"] for found in ways) / diagonal),
    }


def corner_angles(positions, faces):
    """Angles of the corners in degrees, m x 3; 0 for two of three where a face has no area."""
    corners = positions[faces]
    angles = []
    for k in range(3):
        a = corners[:, (k + 1) % 3] - corners[:, k]
        b = corners[:, (k + 2) % 3] - corners[:, k]
        cross = np.linalg.norm(np.cross(a, b), axis=1)
        angles.append(np.degrees(np.arctan2(cross, np.einsum("ij,ij->i", a, b))))
    return np.stack(angles, axis=1)


def counts(positions, faces):
    """Faces, Euler characteristic, and edges and faces that nobody wants."""
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    owner = np.tile(np.arange(len(faces)), 3)
    is_up = sides[:, 0] < sides[:, 1]
    low, high = sides.min(axis=1), sides.max(axis=1)
    key = low * (len(positions) + 1) + high
    order = np.argsort(key, kind="stable")
    _, first, n_sides = np.unique(key[order], return_index=True, return_counts=True)
    n_vertices = len(np.unique(faces))

    normals = np.cross(
        positions[faces[:, 1]] - positions[faces[:, 0]],
        positions[faces[:, 2]] - positions[faces[:, 0]],
    )
    pair = first[n_sides == 2]
    one, two = order[pair], order[pair + 1]
    a, b = normals[owner[one]], normals[owner[two]]
    # Two faces that run along their edge in the same direction have different sides outside.
    b = np.where((is_up[one] == is_up[two])[:, None], -b, b)
    turn = np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.einsum("ij,ij->i", a, b))
    return {
        "faces": len(faces),
        "euler": n_vertices - len(first) + len(faces),
        "non_manifold": int((n_sides > 2).sum()),
        "folds": int((np.degrees(turn) > FOLD_DEG).sum()),
        "slivers": int((corner_angles(positions, faces).min(axis=1) < SLIVER_DEG).sum()),
    }


def check():
    """Measures what is known by hand, so that no run stands on a broken sampler."""
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    # Planes 0.1 apart, over the diagonal of a square of side 1.
    found = distances((square, faces), (square + [0, 0, 0.1], faces), 1000)
    for name in ("rms", "max"):
        assert abs(found[name] - 0.1 / np.sqrt(2)) < 1e-6, found
    sin, cos = np.sin(np.radians(160)), np.cos(np.radians(160))
    hinge = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -cos, sin], [-0.01, 1, 0]])
    found = counts(hinge, np.array([[0, 1, 2], [1, 0, 3], [0, 2, 4]]))
    expected = {"faces": 3, "euler": 1, "non_manifold": 0, "folds": 1, "slivers": 1}
    assert found == expected, found
