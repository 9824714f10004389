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


def check_closed(test, vertex_count, triangles):
    """Each directed edge once, and its reverse; every vertex used; V - E + F = 2."""
    test.assertEqual(triangles.shape, (2 * vertex_count - 4, 3))
    test.assertEqual(set(np.unique(triangles)), set(range(vertex_count)))
    edges = {(t[i], t[(i + 1) % 3]) for t in triangles.tolist() for i in range(3)}
    test.assertEqual(len(edges), triangles.size)
    test.assertEqual(edges, {(b, a) for a, b in edges})


def volume(vertices, triangles):
    return np.linalg.det(vertices[triangles]).sum() / 6.0


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
