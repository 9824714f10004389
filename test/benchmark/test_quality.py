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


def changed(mesh, triangle, corners):
    triangles = mesh.triangles.copy()
    triangles[triangle] = corners
    return Mesh(mesh.points, triangles)


class Quality(unittest.TestCase):
    def test_closed_open_crowded_and_other_surfaces_are_told_apart(self):
        one, keys = octahedron(), ("sphere", "parts", "openings", "genus", "boundary", "crowded")
        # The connectivity of a torus on seven vertices (Moebius 1861).
        torus = [[corner % 7 for corner in (i, i + 1, i + 3, i, i + 3, i + 2)] for i in range(7)]
        for mesh, expected in (
            (one, (True, 1, 0, 0, 0, 0)),
            (changed(one, 0, [1, 0, 4]), (True, 1, 0, None, 0, 0)),
            (mesh_of(one.points, np.delete(one.triangles, [0, 6], axis=0)), (False, 1, 2, 0, 6, 0)),
            (mesh_of(one.points, [*one.triangles, (0, 1, 2)]), (False, 1, 1, None, 1, 2)),
            (mesh_of(np.zeros((7, 3)), torus), (False, 1, 0, 1, 0, 0)),
            (mesh_of(np.zeros((12, 3)), [*one.triangles, *(one.triangles + 6)]), (False, 2, 0, 0, 0, 0)),
        ):
            self.assertEqual(REFEREE.topology(mesh), dict(zip(keys, expected)))

    def test_points_are_used_if_a_vertex_is_exactly_there(self):
        mesh = octahedron()
        mesh.points[4] = 0, 0, 0.1
        cloud = np.concatenate([mesh.points, [(0, 0, 0)]])
        cloud[4, 2] = np.float32(0.1)  # what a file in single precision makes of it
        self.assertAlmostEqual(compare(mesh, cloud)["used"], 100 * 6 / 7)
        # A vertex without triangles does not use its point.
        half = mesh_of(mesh.points, mesh.triangles[4:])
        self.assertAlmostEqual(compare(half, mesh.points)["used"], 100 * 5 / 6)

    def test_a_flipped_edge_is_not_reproduced(self):
        truth = octahedron()
        mesh = changed(changed(truth, 0, [0, 1, 2]), 1, [0, 2, 4])
        # Positions are compared, not indices.
        mesh = Mesh(mesh.points[::-1].copy(), 5 - mesh.triangles)
        self.assertAlmostEqual(compare(mesh, truth.points, truth)["edges"], 100 * 11 / 12)
        self.assertNotIn("edges", compare(mesh, mesh.points + 0.1, truth))

    def test_distances_of_shifted_and_tilted_squares(self):
        square = mesh_of([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [0, 1, 2, 0, 2, 3])
        found = REFEREE.distances(Mesh(square.points + [0, 0, 0.25], square.triangles), square, 1000)
        self.assertAlmostEqual(found["hausdorff"], 25 / 8**0.5)
        self.assertAlmostEqual(found["rms"], 25 / 8**0.5)
        self.assertEqual(found["normals"], 0)
        angle = np.radians(40)
        turn = np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]])
        found = REFEREE.distances(mesh_of(square.points @ turn.T, square.triangles[:, ::-1]), square, 1000)
        self.assertAlmostEqual(found["hausdorff"], 100 * np.sin(angle) / 8**0.5)
        self.assertAlmostEqual(found["normals"], 40)
        line = mesh_of([(0, 0, 0), (1, 1, 1), (2, 2, 2)], [0, 1, 2])  # has no area, hence no distances
        self.assertIsNone(REFEREE.distances(line, square, 10)["rms"])

    def test_bridges_are_what_is_farther_than_three_spacings_from_the_truth(self):
        # The truth: cells of 1 x 1, then of 1 x 4, whose spacing is 2; 16 of area.
        for width, spacing in ((1, 1), (4, 2)):
            x, y = np.meshgrid(np.arange(0, 5, width), np.arange(5))
            rows, columns = x.shape
            corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1, 1)
            cells = np.concatenate([corner + [0, 1, columns], corner + [1, columns + 1, columns]])
            truth = mesh_of(np.stack([x, y, 0 * x], axis=2).reshape(-1, 3), cells)
            self.assertEqual(truth.areas().sum(), 16)
            # A wall 4 wide and 8 high, which is cut at the height of three spacings, and the truth itself.
            cut = 3 * spacing
            wall = [(0, 2, 0), (4, 2, 0), (0, 2, cut), (4, 2, cut), (0, 2, 8), (4, 2, 8)]
            n = len(truth.points)
            mesh = mesh_of([*truth.points, *wall], [*truth.triangles, *np.add(n, [(0, 1, 2), (1, 3, 2),
                                                                                  (2, 3, 4), (3, 5, 4)])])  # fmt: skip
            # As many samples as units of area: one in each.
            self.assertAlmostEqual(REFEREE.distances(mesh, truth, 48)["bridges"], 100 * 4 * (8 - cut) / 16)
            self.assertEqual(REFEREE.distances(truth, truth, 48)["bridges"], 0)

    def test_distances_are_from_the_inside_a_side_or_a_corner_of_the_nearest_triangle(self):
        triangle = mesh_of([(0, 0, 0), (4, 0, 0), (0, 4, 0)], [0, 1, 2])
        places = np.array([(1, 1, 2), (1, 1, -2), (1, -3, 0), (4, 4, 1), (-3, -4, 12), (7, -4, 0)], float)
        np.testing.assert_allclose(REFEREE.nearest(triangle, places)[0], [2, 2, 3, 3, 13, 5])
        random = np.random.default_rng(7)
        corners = random.uniform(-1, 1, (200, 1, 3)) + random.uniform(-0.5, 0.5, (200, 3, 3))
        corners[::3, 2] = corners[::3, :2].mean(axis=1) + 1e-6 * corners[::3, 2]  # thin
        mesh = mesh_of(corners.reshape(-1, 3), np.arange(600))
        self.assertEqual(len(mesh.without_needles().triangles), 200)
        queries = random.uniform(-1.5, 1.5, (60, 3))
        of_each = np.array([REFEREE.nearest(mesh_of(one, [0, 1, 2]), queries)[0] for one in corners])
        found, nearest = REFEREE.nearest(mesh, queries)
        np.testing.assert_array_equal(found, of_each.min(axis=0))
        np.testing.assert_array_equal(nearest, of_each.argmin(axis=0))

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
