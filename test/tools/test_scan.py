"""Generated scans, and what they are taken from."""

import pathlib
import re
import unittest

import numpy as np
from tool_test import ToolTest, check_surface, nearest, read_ply, run

# V - E + F of those that are no sphere: 2 for each piece, 2 less for each handle, 1 less for each opening.
EULER = {"pair": 4, "torus": 0, "bowl": 1, "chair": -6, "holed": -2}

SCENES = ["desk", "yard", "town", "jaw"]


def scan(shape, points, *options):
    """Points and normals."""
    run("scan", shape, "out.xyz", "-points", points, "-normals", *options)
    return np.hsplit(np.loadtxt("out.xyz"), 2)


def neighbors(points, count):
    """Of each point the distances of its nearest neighbours."""
    return np.array([np.sort(np.linalg.norm(points - point, axis=1))[1 : count + 1] for point in points])


class Scan(ToolTest):
    def test_all_points_differ_and_are_the_same_for_the_same_seed(self):
        for shape in ("sphere", "hand", "pair"):
            for count in (4, 27, 333):
                first, again, other = (scan(shape, count, "-noise", 0.1, "-seed", seed)[0] for seed in (7, 7, 8))
                self.assertTrue(np.array_equal(first, again))
                self.assertEqual(len(np.unique(np.concatenate([first, other]), axis=0)), 2 * count)

    def test_noise_is_uniform_along_the_normal_relative_to_the_25_nearest_neighbours(self):
        (clean, normals), (noisy, _) = scan("bird", 1000), scan("bird", 1000, "-noise", 0.3)
        along = ((noisy - clean) * normals).sum(axis=1)
        self.assertLess(np.abs(noisy - clean - along[:, None] * normals).max(), 1e-6)
        relative = along / (0.3 * neighbors(clean, 25).mean(axis=1))
        self.assertLess(np.abs(relative).max(), 1.001)
        # Of a uniform variable in [-1, 1]: mean 0, mean square 1/3 with a variance of 4/45; five standard deviations.
        self.assertAlmostEqual(relative.mean(), 0, delta=5 * (1 / 3 / 1000) ** 0.5)
        self.assertAlmostEqual((relative**2).mean(), 1 / 3, delta=5 * (4 / 45 / 1000) ** 0.5)

    def test_every_shape_is_covered_evenly_and_has_a_true_mesh_of_its_topology(self):
        shapes, scenes = (re.findall(r"^  (\w+) ", text, re.MULTILINE) for text in run("scan", "-list").split("Scenes:"))
        self.assertEqual([len(shapes), set(EULER) - set(shapes), scenes], [10, set(), SCENES])
        for name in shapes:
            with self.subTest(name):
                points, normals = scan(name, 600, "-truth", "truth.ply")
                vertices, _, triangles = read_ply("truth.ply")
                spacing = neighbors(points, 1)
                self.assertGreater(spacing.min(), 0.7 * spacing.mean())
                some = vertices[::97]
                self.assertLess(np.linalg.norm(some - points[nearest(some, points)], axis=1).max(), 1.4 * spacing.mean())
                self.check_truth(vertices, triangles, EULER.get(name, 2), name not in ("bowl", "holed"))
                self.check_normals(points[::4], normals[::4], vertices, triangles)

    def check_truth(self, vertices, triangles, euler, is_closed):
        self.assertAlmostEqual(np.ptp(vertices, axis=0).max(), 1, delta=0.2)
        self.assertLess(np.linalg.norm(vertices.max(axis=0) + vertices.min(axis=0)) / 2, 0.2)
        self.assertGreater(len(triangles), 20000)
        self.assertGreater(np.linalg.det(vertices[triangles]).sum(), 0)  # six times the volume
        sides = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
        self.assertEqual(len(np.unique(sides @ [len(vertices), 1])), len(sides))  # oriented
        edges, counts = np.unique(np.sort(sides, axis=1) @ [len(vertices), 1], return_counts=True)
        self.assertEqual([counts.max(), counts.min()], [2, 2 if is_closed else 1])
        self.assertEqual(len(np.unique(triangles)), len(vertices))
        self.assertEqual(len(vertices) - len(edges) + len(triangles), euler)

    def check_normals(self, points, normals, vertices, triangles):
        """Points are on the surface, and their normals those of the mesh."""
        a, b, c = vertices[triangles].transpose(1, 0, 2)
        sums = [np.bincount(triangles.ravel(), np.repeat(column, 3)) for column in np.cross(b - a, c - a).T]
        true = np.stack(sums, axis=1) / np.linalg.norm(sums, axis=0)[:, None]
        at = nearest(points, vertices)
        self.assertLess(np.linalg.norm(points - vertices[at], axis=1).max(), 0.01)
        self.assertLess(np.abs(np.linalg.norm(normals, axis=1) - 1).max(), 1e-6)
        self.assertGreater(np.median((normals * true[at]).sum(axis=1)), 0.99)
        self.assertGreater(((normals * true[at]).sum(axis=1) > 0).mean(), 0.98)

    def test_a_depth_image_has_a_point_on_each_ray_of_an_even_grid(self):
        width, height = 160, 120
        points, normals = scan("desk", width * height, "-noise", 0)
        rays = (points[:, :2] / points[:, 2:]).reshape(height, width, 2)
        step = np.ptp(rays[0, :, 0]) / (width - 1)
        self.assertLess(np.abs(np.diff(rays[:, :, 0], axis=1) - step).max(), 1e-5)  # single precision
        self.assertLess(np.abs(np.diff(rays[:, :, 1], axis=0) - step).max(), 1e-5)
        self.assertLess(np.abs(rays.mean(axis=(0, 1))).max(), 1e-5)  # the camera looks along z
        self.assertTrue(((0.2 < points[:, 2]) & (points[:, 2] < 2)).all())
        self.assertGreater(((points * normals).sum(axis=1) < 0).mean(), 0.999)  # they face the camera

    def test_a_scene_is_an_image_and_its_truth_what_is_seen_without_noise(self):
        for scene in SCENES:
            with self.subTest(scene):
                points, normals = scan(scene, 3000, "-noise", 0, "-truth", "truth.ply")
                vertices, _, triangles = read_ply("truth.ply")
                self.assertAlmostEqual(np.median(np.linalg.norm(normals, axis=1)), 1)
                a, b, c = vertices[triangles].transpose(1, 0, 2)
                normal = np.cross(b - a, c - a)
                toward = [0, 0, 1] if scene == "town" else -a
                sine = (normal * toward).sum(axis=1) / np.linalg.norm(normal, axis=1) / np.linalg.norm(toward, axis=-1)
                self.assertGreater(sine.min(), 0.069)  # faces the sensor, and is not seen edge-on
                if scene == "town":  # map coordinates in centimetres, between the vertices
                    self.assertTrue(np.allclose(points, np.round(points, 2), atol=1e-9))
                    self.assertGreater(points[:, 1].min(), 5420000)
                    continue
                run("scan", scene, "image.pcd", "-points", 3000, "-noise", 0)
                header = pathlib.Path("image.pcd").read_bytes().split(b"DATA binary\n")[0].decode()
                width, height, count = (int(re.search(f"^{name} (\\d+)", header, re.MULTILINE)[1])
                                        for name in ("WIDTH", "HEIGHT", "POINTS"))  # fmt: skip
                self.assertEqual(width * height, count)
                self.assertTrue(height > 20 and len(points) <= count)
                self.assertLess(np.linalg.norm(vertices[::9] - points[nearest(vertices[::9], points)], axis=1).max(), 1e-4)

    def test_the_noise_of_a_sensor_grows_with_its_factor(self):
        for scene in SCENES:
            clean, *noisy = (scan(scene, 3000, "-noise", factor)[0] for factor in (0, 0.5, 1))
            errors = [np.median(np.linalg.norm(one - clean[nearest(one, clean)], axis=1)) for one in noisy]
            self.assertTrue(0 < errors[0] < errors[1], scene)
            self.assertTrue(scene in ("yard", "town") or 0.98 < len(noisy[1]) / len(clean) < 0.998, scene)  # missing

    def test_options_without_effect_are_refused(self):
        for words in ("desk -views 2", "jaw -slices 5", "hand -slices 5 -noise 1", "hand -slices 5 -views 2",
                      "bowl -views 2"):  # fmt: skip
            run("scan", *words.split(), "out.ply", code=2)

    def test_views_of_a_shape_are_merged_with_noise_along_their_rays(self):
        errors = []
        for noise in (0, 0.5, 1):
            points = scan("sphere", 6000, "-views", 8, "-noise", noise)[0]
            self.assertAlmostEqual(len(points), 6000, delta=300)
            errors.append((np.linalg.norm(points, axis=1) - 0.5).std())
        self.assertLess(errors[0], 1e-6)
        self.assertAlmostEqual(errors[2] / errors[1], 2, delta=0.1)

    def test_slices_are_contours_in_planes(self):
        run("scan", "torus", "out.xyz", "-slices", 7)
        points = np.loadtxt("out.xyz")
        self.assertEqual(len(np.unique(np.round(points[:, 2], 6))), 7)
        self.assertLess(np.abs(np.hypot(np.hypot(points[:, 0], points[:, 1]) - 0.36, points[:, 2]) - 0.14).max(), 1e-4)
        self.assertLess(neighbors(points[points[:, 2] > 0.1], 1).max(), 0.01)

    def test_every_format_holds_points_and_normals(self):
        for extension in ("pcd", "ply", "obj", "xyz", "txt"):
            run("scan", f"out.{extension}", "SPHERE", "-points=100", "-noise", "0.25", "--seed", "7", "-normals")
            run("reconstruction", f"out.{extension}", f"{extension}.off")
            mesh = pathlib.Path(f"{extension}.off").read_text()
            self.assertTrue(mesh.startswith("NOFF\n100 196 0\n"))
            triangles = np.loadtxt(f"{extension}.off", int, skiprows=102)
            self.assertEqual(check_surface(triangles[:, 1:], 100), (2, 0))
            # Nothing is lost on the way, hence all meshes are the same.
            self.assertEqual(mesh, pathlib.Path("pcd.off").read_text(), extension)
        for option in ("-h", "-version"):
            self.assertIn("pcl_spherical_param_scan", run("scan", option))
