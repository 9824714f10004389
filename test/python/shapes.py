"""Clouds, and what a mesh is, without anything of the package that is tested."""

import tempfile
import unittest
from pathlib import Path

import numpy as np


class InFolder(unittest.TestCase):
    """Each test has an empty folder."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)


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


def check_closed(test, vertex_count, triangles):
    """Each directed edge once, and its reverse; every vertex used; genus 0."""
    test.assertEqual(triangles.shape, (2 * vertex_count - 4, 3))
    test.assertEqual(set(np.unique(triangles)), set(range(vertex_count)))
    edges = {(t[i], t[(i + 1) % 3]) for t in triangles.tolist() for i in range(3)}
    test.assertEqual(len(edges), triangles.size)
    test.assertEqual(edges, {(b, a) for a, b in edges})


def volume(vertices, triangles):
    return np.linalg.det(vertices[triangles]).sum() / 6.0


def faces_of(path):
    """The triangles of an .obj file."""
    lines = [line.split()[1:] for line in path.read_text().splitlines() if line.startswith("f ")]
    return np.array([[int(corner.split("/")[0]) - 1 for corner in line] for line in lines])


def colors_of(points):
    """A colour for each point, which depends on its place."""
    low, high = points.min(axis=0), points.max(axis=0)
    return np.rint(255 * (points - low) / (high - low)).astype(np.uint8)


def record(points, colors=None, normals=None):
    """The same as a structured array."""
    columns = dict(zip("xyz", points.T))
    if colors is not None:
        columns.update(zip(("red", "green", "blue"), colors.T))
    if normals is not None:
        columns.update(zip(("nx", "ny", "nz"), normals.T))
    return structured(**columns)


def structured(**columns):
    array = np.empty(len(columns["x"]), dtype=[(name, column.dtype) for name, column in columns.items()])
    for name, column in columns.items():
        array[name] = column
    return array


def depth_image(columns=80, rows=60):
    """What a camera at the origin sees along z: a box before a wall."""
    y, x = (np.mgrid[:rows, :columns].reshape(2, -1) + 0.5) / [[rows], [columns]] - 0.5
    z = np.where((abs(x) < 0.2) & (abs(y) < 0.15), 2.0, 3.0)
    return np.stack([x * z, y * z, z], axis=1)
