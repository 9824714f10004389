"""Clouds, and what a mesh is, without anything of the package that is tested."""

import numpy as np


def directions(count, seed=20040602):
    """Random unit vectors."""
    vectors = np.random.default_rng(seed).normal(size=(count, 3))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def ellipsoid(count):
    """Points exactly on x^2 + (y / 2)^2 + (z / 0.7)^2 = 1, but for rounding."""
    return directions(count) * [1.0, 2.0, 0.7]


def bumpy(count, seed=20040602):
    """Points of a surface with bumps."""
    u = directions(count, seed)
    return u * (1.0 + 0.2 * np.sin(5.0 * u[:, :1]) * np.cos(4.0 * u[:, 1:2]))


def torus(around):
    """Points of a torus around z, in twice as many rings as points in each."""
    ring, k = np.mgrid[: 2 * around, :around].reshape(2, -1)
    u, v = np.pi / around * ring, 2 * np.pi / around * (k + ring % 2 / 2)
    radius = 1.0 + 0.4 * np.cos(v)
    return np.column_stack([radius * np.cos(u), radius * np.sin(u), 0.4 * np.sin(v)])


def check_closed(test, vertex_count, triangles, genus=0):
    """Each directed edge once, and its reverse; every vertex used; V - E + F = 2 - 2 genus."""
    test.assertEqual(triangles.shape, (2 * vertex_count - 4 + 4 * genus, 3))
    test.assertEqual(set(np.unique(triangles)), set(range(vertex_count)))
    edges = {(t[i], t[(i + 1) % 3]) for t in triangles.tolist() for i in range(3)}
    test.assertEqual(len(edges), triangles.size)
    test.assertEqual(edges, {(b, a) for a, b in edges})


def volume(vertices, triangles):
    return np.linalg.det(vertices[triangles]).sum() / 6.0


def read_ply(path):
    """Vertices, a structured array, and triangles of a binary PLY."""
    types = {"float": "<f4", "double": "<f8", "uchar": "u1"}
    header, body = path.read_bytes().split(b"end_header\n", 1)
    lines = [line.split() for line in header.decode("ascii").splitlines()]
    counts = [int(line[2]) for line in lines if line[0] == "element"] + [0]
    record = [(line[2], types[line[1]]) for line in lines if line[:1] == ["property"] and len(line) == 3]
    vertices = np.frombuffer(body, dtype=record, count=counts[0])
    faces = np.frombuffer(
        body, dtype=[("count", "u1"), ("vertices", "<i4", (3,))], offset=vertices.nbytes
    )
    assert len(faces) == counts[1] and (faces["count"] == 3).all()
    return vertices, faces["vertices"]


def columns(record, *names):
    """Fields of a structured array, one a column."""
    return np.column_stack([record[name] for name in names])


def colors_of(points):
    """A colour for each point, which depends on its place."""
    low, high = points.min(axis=0), points.max(axis=0)
    return np.rint(255 * (points - low) / (high - low)).astype(np.uint8)


def record(points, colors=None, normals=None):
    """The same as a structured array."""
    fields = list(zip("xyz", points.T))
    if colors is not None:
        fields += zip(("red", "green", "blue"), colors.T)
    if normals is not None:
        fields += zip(("nx", "ny", "nz"), normals.T)
    array = np.empty(len(points), dtype=[(name, column.dtype) for name, column in fields])
    for name, column in fields:
        array[name] = column
    return array
