"""Tests of the referee for meshes, the library of SPHERICAL_PARAM_REFEREE. tools is on PYTHONPATH."""

import os
import unittest

import numpy as np
from suite.quality import Mesh, Referee, compare

REFEREE = Referee(os.environ["SPHERICAL_PARAM_REFEREE"])


def mesh_of(points, triangles):
    return Mesh(np.array(points, float), np.array(triangles, np.int32).reshape(-1, 3))


def octahedron():
    """Triangles 0 to 3 are those at +z, vertex 4."""
    return mesh_of([(1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)],
                   [0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4, 1, 0, 5, 2, 1, 5, 3, 2, 5, 0, 3, 5])  # fmt: skip


def cube():
    """[0, 1]^3. Vertex x + 2 y + 4 z; the first two triangles are those of z = 0."""
    return mesh_of([(i % 2, i // 2 % 2, i // 4) for i in range(8)],
                   [0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                    2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5])  # fmt: skip


def changed(mesh, triangle, corners):
    triangles = mesh.triangles.copy()
    triangles[triangle] = corners
    return Mesh(mesh.points, triangles)


def distance(p, corners):
    """From a triangle: by the foot of the point in the plane, or to the nearest side."""
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    normal /= np.linalg.norm(normal)
    height = normal @ (p - corners[0])
    inside, sides = True, []
    for a, b in zip(corners, np.roll(corners, -1, axis=0)):
        along = np.clip((p - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        sides.append(np.linalg.norm(p - a - along * (b - a)))
        inside = inside and np.cross(b - a, p - a - height * normal) @ normal >= 0
    return abs(height) if inside else min(sides)


class Quality(unittest.TestCase):
    def test_polyhedra_alone_are_spheres_whichever_way_their_triangles_run(self):
        one, keys = octahedron(), ("sphere", "parts", "openings", "genus", "boundary", "crowded")
        for mesh, expected in (
            (one, (True, 1, 0, 0, 0, 0)),
            (changed(cube(), 5, [5, 0, 4]), (True, 1, 0, None, 0, 0)),
            (mesh_of(one.points, np.delete(one.triangles, [0, 6], axis=0)), (False, 1, 2, 0, 6, 0)),
            (mesh_of(one.points, [*one.triangles, (0, 1, 2)]), (False, 1, 1, None, 1, 2)),
        ):
            self.assertEqual(REFEREE.topology(mesh), dict(zip(keys, expected)))
        # The connectivity of a torus on seven vertices (Moebius 1861); two octahedra apart, and with two vertices
        # in common.
        torus = [[corner % 7 for corner in (i, i + 1, i + 3, i, i + 3, i + 2)] for i in range(7)]
        two = np.concatenate([one.triangles, one.triangles + 6])
        touching = np.where(two >= 10, two - 6, two)
        for triangles, parts, genus in (
            (torus, 1, 1),
            (two, 2, 0),
            (touching, 1, None),
            ([*one.triangles, (1, 1, 2)], 1, None),
        ):
            found = REFEREE.topology(mesh_of(np.zeros((12, 3)), triangles))
            self.assertEqual((found["sphere"], found["parts"], found["genus"]), (False, parts, genus), triangles)

    def test_points_are_used_if_a_vertex_is_exactly_there(self):
        mesh = octahedron()
        mesh.points[4] = 0, 0, 0.1
        cloud = np.concatenate([mesh.points, [(0, 0, 0)]])
        cloud[4, 2] = np.float32(0.1)  # what a file in single precision makes of it
        self.assertAlmostEqual(compare(mesh, cloud)["used"], 100 * 6 / 7)
        cloud[4, 2] = 0.1001
        self.assertAlmostEqual(compare(mesh, cloud)["used"], 100 * 5 / 7)
        # A vertex without triangles does not use its point.
        half = mesh_of(mesh.points, mesh.triangles[4:])
        self.assertAlmostEqual(compare(half, mesh.points)["used"], 100 * 5 / 6)

    def test_a_flipped_edge_is_not_reproduced(self):
        truth = cube()
        mesh = changed(changed(truth, 0, [0, 2, 1]), 1, [2, 3, 1])
        # Positions are compared, not indices.
        mesh = Mesh(mesh.points[::-1].copy(), 7 - mesh.triangles)
        self.assertAlmostEqual(compare(mesh, truth.points, truth)["edges"], 100 * 17 / 18)
        mesh.points[:, 0] += 0.1
        self.assertEqual(compare(mesh, truth.points, truth)["edges"], 0)
        self.assertNotIn("edges", compare(mesh, mesh.points, truth))

    def test_distances_of_shifted_and_tilted_squares(self):
        square = mesh_of([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [0, 1, 2, 0, 2, 3])
        found = REFEREE.distances(Mesh(square.points + [0, 0, 0.25], square.triangles), square, 1000)
        self.assertAlmostEqual(found["hausdorff"], 25 / 8**0.5)
        self.assertAlmostEqual(found["rms"], 25 / 8**0.5)
        self.assertEqual(found["normals"], 0)
        angle = np.radians(40)
        turn = np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]])
        for triangles in (square.triangles, square.triangles[:, ::-1]):
            found = REFEREE.distances(mesh_of(square.points @ turn.T, triangles), square, 1000)
            self.assertAlmostEqual(found["hausdorff"], 100 * np.sin(angle) / 8**0.5)
            self.assertAlmostEqual(found["normals"], 40)
        line = mesh_of([(0, 0, 0), (1, 1, 1), (2, 2, 2)], [0, 1, 2])  # has no area, hence no distances
        self.assertIsNone(REFEREE.distances(line, square, 10)["rms"])

    def test_nearest_triangles_are_those_of_brute_force(self):
        random = np.random.default_rng(7)
        corners = random.uniform(-1, 1, (200, 1, 3)) + random.uniform(-0.5, 0.5, (200, 3, 3))
        corners[::3, 2] = corners[::3, :2].mean(axis=1) + 1e-6 * corners[::3, 2]  # thin
        mesh = mesh_of(corners.reshape(-1, 3), np.arange(600))
        self.assertEqual(len(mesh.without_needles().triangles), 200)
        queries = random.uniform(-1.5, 1.5, (60, 3))
        found, nearest = REFEREE.nearest(mesh, queries)
        for query, one, triangle in zip(queries, found, nearest):
            # The thin triangles are ill-conditioned by 1e-6.
            self.assertAlmostEqual(one, min(distance(query, other) for other in corners), delta=1e-9)
            self.assertAlmostEqual(one, distance(query, corners[triangle]), delta=1e-9)

    def test_distortion_of_a_stretched_octahedron(self):
        mesh, sphere = octahedron(), octahedron()
        mesh.points[4, 2] = 2
        # The triangles at +z are stretched by sqrt(3) across their side of length sqrt(2), the others are as they were.
        large, small = 0.5 * 2**0.5 * 4.5**0.5, 0.5 * 2**0.5 * 1.5**0.5
        found = REFEREE.distortion(mesh, sphere)
        self.assertAlmostEqual(found["angle"], (large * 3**0.5 + small) / (large + small))
        squares = [np.log2((large + small) / 2 / area) ** 2 for area in (large, small)]
        self.assertAlmostEqual(found["area"], np.sqrt(np.average(squares, weights=(large, small))))
        self.assertEqual(found["inverted"], 0)
        sphere.points[4] = 0.7, 0.7, -0.1
        self.assertEqual(REFEREE.distortion(mesh, sphere)["inverted"], 50)
        with self.assertRaises(ValueError):
            REFEREE.distortion(cube(), sphere)
