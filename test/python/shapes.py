"""Clouds, and what a mesh is, without anything of the package that is tested."""

import numpy as np

SEED = 20040602


def directions(count, seed=SEED):
    """Random unit vectors."""
    vectors = np.random.default_rng(seed).normal(size=(count, 3))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def ellipsoid(count, seed=SEED):
    """Points exactly on x^2 + (y / 2)^2 + (z / 0.7)^2 = 1, but for rounding."""
    return directions(count, seed) * [1.0, 2.0, 0.7]


def bumpy(count, seed=SEED):
    """Points of a surface with bumps."""
    u = directions(count, seed)
    return u * (1.0 + 0.2 * np.sin(5.0 * u[:, :1]) * np.cos(4.0 * u[:, 1:2]))


def edge_counts(triangles):
    """How often each directed edge occurs."""
    ends = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return np.unique(ends, axis=0, return_counts=True)


def check_closed_genus0(test, vertex_count, triangles):
    """Closed, manifold, oriented, in one piece, V - E + F = 2, every vertex used."""
    test.assertEqual(triangles.shape, (2 * vertex_count - 4, 3))
    test.assertEqual(set(np.unique(triangles)), set(range(vertex_count)))
    edges, counts = edge_counts(triangles)
    test.assertTrue((counts == 1).all(), "an edge is traversed twice in one direction")
    pairs = set(map(tuple, edges.tolist()))
    test.assertTrue(all((b, a) in pairs for a, b in pairs), "an edge has one triangle")
    test.assertEqual(vertex_count - len(pairs) // 2 + len(triangles), 2)
    # Around each vertex one fan: following next edges from one comes back after all of them.
    after = {}
    for a, b, c in triangles.tolist():
        after.setdefault(a, {})[b] = c
        after.setdefault(b, {})[c] = a
        after.setdefault(c, {})[a] = b
    for fan in after.values():
        first = at = next(iter(fan))
        steps = 0
        while True:
            at = fan[at]
            steps += 1
            if at == first:
                break
        test.assertEqual(steps, len(fan), "the triangles of a vertex are not one fan")
    # One piece, by a walk over the edges.
    seen, open_ends = {0}, [0]
    while open_ends:
        for other in after[open_ends.pop()]:
            if other not in seen:
                seen.add(other)
                open_ends.append(other)
    test.assertEqual(len(seen), vertex_count)


def volume(vertices, triangles):
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0


def triangle_set(triangles):
    """Triangles without the order of rows, and of corners but for their sense."""
    first = triangles.argmin(axis=1)
    turned = np.stack([triangles[np.arange(len(triangles)), (first + i) % 3] for i in range(3)], 1)
    return set(map(tuple, turned.tolist()))


def read_ply(path):
    """Vertices and triangles of a binary PLY with properties of type double."""
    data = path.read_bytes()
    header, body = data.split(b"end_header\n", 1)
    lines = header.decode("ascii").splitlines()
    counts = [int(line.split()[2]) for line in lines if line.startswith("element ")]
    width = sum(line.startswith("property double") for line in lines)
    vertices = np.frombuffer(body, dtype="<f8", count=counts[0] * width).reshape(-1, width)
    faces = np.frombuffer(
        body, dtype=[("count", "u1"), ("vertices", "<i4", (3,))], offset=counts[0] * width * 8
    )
    assert len(faces) == counts[1] and (faces["count"] == 3).all()
    return vertices, faces["vertices"]
