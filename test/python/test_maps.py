"""What sphere_map(), remesh() and the rest that needs a map give."""

import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
import shapes
import spherical_param as sp

TOOLS = Path(os.environ.get("SPHERICAL_PARAM_TOOLS", "/nonexistent"))


def orientations(directions, triangles):
    a, b, c = (directions[triangles[:, i]] for i in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c))


class Maps(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.points = shapes.bumpy(1500)
        cls.mesh = sp.reconstruct(cls.points)
        cls.map = sp.sphere_map(cls.mesh)

    def test_no_triangle_of_a_map_is_flipped(self):
        self.assertEqual(self.map.distortion.flipped_triangles, 0)
        self.assertGreater(orientations(self.map.directions, self.map.triangles).min(), 0.0)
        np.testing.assert_allclose(np.linalg.norm(self.map.directions, axis=1), 1.0, atol=1e-12)
        # Once around: the solid angles sum to that of the sphere.
        a, b, c = (self.map.directions[self.map.triangles[:, i]] for i in range(3))
        dots = [np.einsum("ij,ij->i", *pair) for pair in ((a, b), (b, c), (c, a))]
        signs = orientations(self.map.directions, self.map.triangles)
        angles = 2 * np.arctan2(signs, 1 + sum(dots))
        self.assertAlmostEqual(angles.sum(), 4 * np.pi, delta=1e-9)
        # The areas that the map is measured by.
        points = self.points
        p, q, r = (points[self.map.triangles[:, i]] for i in range(3))
        areas = np.linalg.norm(np.cross(q - p, r - p), axis=1)
        ratio = angles / angles.sum() / (areas / areas.sum())
        mean = np.average(np.maximum(ratio, 1 / ratio), weights=areas)
        self.assertAlmostEqual(self.map.distortion.area.mean, mean, delta=1e-6 * mean)

    def test_a_map_distorts_areas_less_than_the_embedding(self):
        self.assertLess(self.map.distortion.area.mean, self.map.before.area.mean)
        embedding = sp.measure_map_distortion(self.mesh)
        # Of vectors that were made units once more.
        self.assertAlmostEqual(self.map.before.area.mean, embedding.area.mean, delta=1e-9)
        self.assertEqual(self.map.before.flipped_triangles, embedding.flipped_triangles)
        self.assertEqual(self.map.distortion, sp.measure_map_distortion(self.map))

    def test_options_of_the_map_have_their_effect(self):
        angles = sp.sphere_map(self.mesh, area_weight=0.0)
        areas = sp.sphere_map(self.mesh, area_weight=1.0)
        self.assertLess(angles.distortion.angle.mean, areas.distortion.angle.mean)
        self.assertLess(areas.distortion.area.mean, angles.distortion.area.mean)
        levels = sp.sphere_map(self.mesh, sweeps=0).levels
        self.assertEqual({level.sweeps for level in levels}, {0})

    def test_arrays_are_mapped_as_the_result_that_they_are_from(self):
        mesh = self.mesh
        again = sp.sphere_map(mesh.vertices, mesh.triangles.tolist(), mesh.sphere)
        self.assertEqual(again.directions.tobytes(), self.map.directions.tobytes())
        self.assertFalse(np.shares_memory(again.vertices, mesh.vertices))

    def test_grids_have_their_vertices_and_are_closed(self):
        for grid, count, frequency in (
            ("icosahedral", 642, 8),  # 10 f^2 + 2
            ("octahedral", 578, 12),  # 4 f^2 + 2
        ):
            new = sp.remesh(self.map, grid=grid, points=count)
            self.assertEqual((len(new.vertices), new.frequency), (count, frequency))
            shapes.check_closed_genus0(self, count, new.triangles)
            self.assertEqual(len(new.self_intersections), 0)
            self.assertGreater(orientations(new.directions, new.triangles).min(), 0.0)
            self.assertGreater(shapes.volume(new.vertices, new.triangles), 0.0)
            np.testing.assert_allclose(np.linalg.norm(new.normals, axis=1), 1.0, atol=1e-12)

    def test_new_vertices_lie_on_the_surface(self):
        def distance(points):
            return np.abs(np.linalg.norm(points / [1.0, 2.0, 0.7], axis=1) - 1.0)

        mesh = sp.reconstruct(shapes.ellipsoid(3000))
        linear = sp.remesh(mesh, points=2562, fit="linear")
        smooth = sp.remesh(mesh, points=2562)
        even = sp.remesh(mesh, points=1000, grid="even")
        self.assertEqual((even.triangles.shape, even.frequency), ((0, 3), None))
        self.assertEqual(even.vertices.shape, (1000, 3))
        # Chords of the sampling's size cut by some of its square; quadrics follow the surface.
        self.assertLess(distance(linear.vertices).max(), 0.05)
        self.assertLess(distance(smooth.vertices).mean(), 0.2 * distance(linear.vertices).mean())
        self.assertLess(distance(even.vertices).mean(), 1e-3)
        exact = smooth.vertices / np.square([1.0, 2.0, 0.7])
        exact /= np.linalg.norm(exact, axis=1, keepdims=True)
        self.assertGreater(np.einsum("ij,ij->i", exact, smooth.normals).min(), 0.9)

    def test_values_are_carried_over(self):
        new = sp.remesh(self.map, points=642, fit="linear")
        np.testing.assert_array_equal(new.source_weights >= 0, True)
        np.testing.assert_allclose(new.transfer(np.ones(1500)), 1.0, atol=1e-12)
        if new.moved == 0 and new.flipped_edges == 0:
            np.testing.assert_allclose(new.transfer(self.points), new.vertices, atol=1e-12)
        for wrong in (np.ones(3), np.ones((1500, 2, 2)), ["a"] * 1500):
            with self.assertRaises(sp.InvalidInput):
                new.transfer(wrong)

    def test_an_even_cloud_is_one_of_its_seed(self):
        one, same, other = (
            sp.remesh(self.map, points=300, grid="even", seed=seed).vertices for seed in (1, 1, 2)
        )
        self.assertEqual(one.tobytes(), same.tobytes())
        self.assertNotEqual(one.tobytes(), other.tobytes())

    def test_smoothed_points_are_what_is_mapped(self):
        mesh = sp.reconstruct(self.points, smoothing=3)
        np.testing.assert_array_equal(sp.sphere_map(mesh, sweeps=0).vertices, mesh.smoothed)

    def test_texture_coordinates_lie_in_the_square_and_the_surface_stays(self):
        for chart in ("octahedral", "equirectangular", "cube"):
            with self.subTest(chart):
                atlas = sp.texture_coordinates(self.map, chart=chart)
                self.assertTrue(((atlas.coordinates >= 0) & (atlas.coordinates <= 1)).all())
                self.assertEqual(atlas.triangles.shape, atlas.coordinate_triangles.shape)
                np.testing.assert_array_equal(atlas.vertices[:1500], self.map.vertices)
                self.assertAlmostEqual(
                    shapes.volume(atlas.vertices, atlas.triangles),
                    self.mesh.measures.volume,
                    delta=1e-9,
                )
                # None turned over: the area in the square is that of charts one to one.
                u = atlas.coordinates[atlas.coordinate_triangles]
                d, e = u[:, 1] - u[:, 0], u[:, 2] - u[:, 0]
                signs = d[:, 0] * e[:, 1] - d[:, 1] * e[:, 0]
                self.assertLess(abs(abs(np.sign(signs[signs != 0]).mean()) - 1.0), 0.01)

    def test_wrong_meshes_and_options_are_refused(self):
        mesh, points = self.mesh, self.mesh.vertices
        for call in (
            lambda: sp.sphere_map(points),
            lambda: sp.sphere_map(mesh, mesh.triangles, mesh.sphere),
            lambda: sp.sphere_map(points, mesh.triangles[:-1], mesh.sphere),
            lambda: sp.sphere_map(points, mesh.triangles + 1, mesh.sphere),
            lambda: sp.sphere_map(points, mesh.triangles - 1, mesh.sphere),
            lambda: sp.sphere_map(points, mesh.triangles.astype(float), mesh.sphere),
            lambda: sp.sphere_map(points, mesh.triangles + 2**40, mesh.sphere),
            lambda: sp.sphere_map(points, mesh.triangles, mesh.sphere[:-1]),
            lambda: sp.sphere_map(points, mesh.triangles, 2 * mesh.sphere),
            lambda: sp.sphere_map(points * np.nan, mesh.triangles, mesh.sphere),
            lambda: sp.sphere_map(mesh, area_weight=2),
            lambda: sp.sphere_map(mesh, sweeps=1001),
            lambda: sp.measure_map_distortion(points, mesh.triangles, mesh.sphere[:-1]),
            lambda: sp.measure_map_distortion(points, mesh.triangles + 1500, mesh.sphere),
            lambda: sp.remesh(mesh, grid="cubic"),
            lambda: sp.remesh(mesh, fit="spline"),
            lambda: sp.remesh(mesh, points=0),
            lambda: sp.remesh(mesh, points=2**30),
            lambda: sp.remesh(mesh, points=2**25, grid="even"),
            lambda: sp.remesh(mesh, points=1e3),
            lambda: sp.remesh(mesh, seed=-1),
            lambda: sp.remesh(mesh, threads=-1),
            lambda: sp.texture_coordinates(mesh),
            lambda: sp.texture_coordinates(self.map, chart="cylinder"),
            lambda: sp.texture_coordinates(self.map, chart="cube", margin=0.3),
        ):
            with self.assertRaises(sp.InvalidInput) as raised:
                call()
            self.assertIn("; ", str(raised.exception))

    def test_progress_goes_through_all_stages_and_can_end_them(self):
        told = []
        sp.remesh(self.mesh, points=200, progress=lambda *state: told.append(state))
        stages = list(dict.fromkeys(stage for stage, _ in told))
        self.assertEqual(stages, ["map", "surface", "resample", "untangle", "intersections"])
        for stage in stages:
            fractions = [fraction for name, fraction in told if name == stage]
            self.assertEqual(fractions[-1], 1.0)
            self.assertTrue(all(0.0 <= fraction <= 1.0 for fraction in fractions))
            with self.assertRaises(sp.Cancelled):
                sp.remesh(self.mesh, points=200, progress=lambda name, _: name != stage)


class Tool(unittest.TestCase):
    @unittest.skipUnless((TOOLS / "pcl_spherical_param_remesh").exists(), "no tools")
    def test_the_tool_makes_the_same_surface_of_single_precision(self):
        points = shapes.bumpy(1500).astype(np.float32)
        with tempfile.TemporaryDirectory() as folder:
            np.savetxt(Path(folder, "cloud.xyz"), points, fmt="%.9g")
            subprocess.run(
                [TOOLS / "pcl_spherical_param_remesh", "cloud.xyz", "mesh.off", "-ascii"]
                + ["-points", "642", "-quiet", "-json", "report.json"],
                cwd=folder,
                check=True,
            )
            report = json.loads(Path(folder, "report.json").read_text())
        new = sp.remesh(sp.reconstruct(points), points=642)
        self.assertEqual((len(new.vertices), len(new.triangles)), (642, report["triangles"]))
        self.assertEqual(len(new.self_intersections), report["self_intersections"])
        # A few edges of the cloud's mesh may differ by the rounding of distances.
        volume = shapes.volume(new.vertices, new.triangles)
        self.assertAlmostEqual(volume, report["volume"], delta=1e-3 * volume)
        self.assertEqual(new.map.distortion.flipped_triangles, report["flipped_triangles"])
        self.assertAlmostEqual(
            new.map.distortion.angle.mean, report["angle_distortion"]["mean"], delta=0.01
        )


if __name__ == "__main__":
    unittest.main()
