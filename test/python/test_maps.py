"""What sphere_map(), remesh(), morph() and texture_coordinates() make of arrays and options."""

import unittest

import numpy as np
import shapes
import spherical_param as sp


class Maps(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.points = shapes.bumpy(600)
        cls.mesh = sp.reconstruct(cls.points)
        cls.map = sp.sphere_map(cls.mesh)

    def test_maps_are_one_to_one_and_their_distortion_is_that_of_their_arrays(self):
        new = self.map
        self.assertEqual(new.distortion.flipped_triangles, 0)
        self.assertEqual(new.distortion, sp.measure_map_distortion(new))
        self.assertLess(new.distortion.area.mean, new.before.area.mean)
        for ratio in (new.distortion.area, new.distortion.angle):
            self.assertTrue(1.0 < ratio.mean < ratio.p95 < ratio.max)
        embedding = sp.measure_map_distortion(self.mesh)
        # Of vectors that were made units once more.
        self.assertAlmostEqual(new.before.area.mean, embedding.area.mean, delta=1e-9)

    def test_options_of_the_map_have_their_effect(self):
        angles = sp.sphere_map(self.mesh, area_weight=0.0)
        areas = sp.sphere_map(self.mesh, area_weight=1.0)
        self.assertLess(angles.distortion.angle.mean, areas.distortion.angle.mean)
        self.assertLess(areas.distortion.area.mean, angles.distortion.area.mean)
        levels = sp.sphere_map(self.mesh, sweeps=0).levels
        self.assertEqual({level.sweeps for level in levels}, {0})

    def test_arrays_and_smoothed_points_are_mapped_as_results_are(self):
        mesh = self.mesh
        again = sp.sphere_map(mesh.vertices, mesh.triangles.tolist(), mesh.sphere)
        self.assertEqual(again.directions.tobytes(), self.map.directions.tobytes())
        self.assertFalse(np.shares_memory(again.vertices, mesh.vertices))
        smooth = sp.reconstruct(self.points, smoothing=3)
        np.testing.assert_array_equal(sp.sphere_map(smooth, sweeps=0).vertices, smooth.smoothed)

    def test_surfaces_with_openings_stay_open(self):
        points = shapes.ellipsoid(1500)
        mesh = sp.reconstruct(points[points[:, 2] < 0.3], surface="open")
        mapped = sp.sphere_map(mesh)
        self.assertEqual((len(self.map.caps), len(mapped.caps) > 0), (0, True))
        for grid in ("icosahedral", "even"):
            new = sp.remesh(mapped, grid=grid, points=2000)
            self.assertLess(new.vertices[:, 2].max(), 0.31)
            self.assertLess(new.source_triangle.max(), len(mesh.triangles))
        layout = sp.texture_coordinates(mapped)
        self.assertEqual(set(layout.source_triangle), set(range(len(mesh.triangles))))

    def test_a_tangle_has_no_map(self):
        # A grid whose squares of nine points are at three heights, without walls.
        i, j = np.divmod(np.arange(324), 18)
        a, b = np.minimum((j + i % 2 / 2) // 3, 5), np.sqrt(0.75) * i // 3
        heights = 2.5 * ((a * a + 2 * b * b + a * b) % 3)
        mesh = sp.reconstruct(np.column_stack((j + i % 2 / 2, np.sqrt(0.75) * i, heights)))
        self.assertTrue(mesh.has_certain_triangles_only)
        with self.assertRaisesRegex(sp.InvalidInput, 'it is a tangle; .*topology="sphere"'):
            sp.sphere_map(mesh)

    def test_grids_have_their_vertices_and_are_closed(self):
        for grid, count, frequency in (
            ("icosahedral", 642, 8),  # 10 f^2 + 2
            ("octahedral", 578, 12),  # 4 f^2 + 2
        ):
            new = sp.remesh(self.map, grid=grid, points=count)
            self.assertEqual((len(new.vertices), new.frequency), (count, frequency))
            shapes.check_closed(self, count, new.triangles)
            self.assertEqual(new.self_intersections.shape, (0, 2))
            self.assertGreater((new.vertices * new.normals).sum(axis=1).min(), 0.0)
        self.assertEqual(sp.remesh(self.map, sweeps=1).frequency, 8)  # nearest to 600

    def test_fit_and_seed_have_their_effect(self):
        linear, smooth = (sp.remesh(self.map, points=642, fit=fit) for fit in ("linear", "smooth"))
        self.assertFalse(np.array_equal(linear.vertices, smooth.vertices))
        even, same, other = (sp.remesh(self.map, points=500, grid="even", seed=seed) for seed in (1, 1, 2))
        self.assertEqual((even.vertices.shape, even.triangles.shape), ((500, 3), (0, 3)))
        self.assertIsNone(even.frequency)
        self.assertEqual(even.vertices.tobytes(), same.vertices.tobytes())
        self.assertNotEqual(even.vertices.tobytes(), other.vertices.tobytes())

    def test_values_are_carried_over(self):
        new = sp.remesh(self.map, points=162, fit="linear")
        self.assertEqual((new.moved, new.flipped_edges), (0, 0))
        np.testing.assert_allclose(new.transfer(np.ones(600)), 1.0, atol=1e-12)
        np.testing.assert_allclose(new.transfer(self.points), new.vertices, atol=1e-12)
        for wrong in (np.ones(3), np.ones((600, 2, 2)), ["a"] * 600):
            with self.assertRaises(sp.InvalidInput):
                new.transfer(wrong)

    def test_texture_coordinates_lie_in_the_square_and_the_surface_stays(self):
        for chart in ("octahedral", "equirectangular", "cube"):
            with self.subTest(chart):
                atlas = sp.texture_coordinates(self.map, chart=chart)
                self.assertTrue(((atlas.coordinates >= 0) & (atlas.coordinates <= 1)).all())
                self.assertEqual(atlas.triangles.shape, atlas.coordinate_triangles.shape)
                np.testing.assert_array_equal(atlas.vertices[:600], self.map.vertices)
                volume = shapes.volume(atlas.vertices, atlas.triangles)
                self.assertAlmostEqual(volume, self.mesh.measures.volume, delta=1e-9)

    def test_a_mesh_with_handles_is_cut_for_the_image_alone(self):
        points = shapes.torus(24)
        mesh = sp.reconstruct(points)
        atlas = sp.texture_coordinates(mesh)
        shapes.check_closed(self, len(atlas.vertices), atlas.triangles, genus=1)
        np.testing.assert_array_equal(atlas.vertices[: len(points)], mesh.vertices)
        volume = shapes.volume(atlas.vertices, atlas.triangles)
        self.assertAlmostEqual(volume, mesh.measures.volume, delta=1e-9)
        # A mesh without handles has the atlas of its map.
        np.testing.assert_array_equal(
            sp.texture_coordinates(self.mesh).coordinates, sp.texture_coordinates(self.map).coordinates
        )

    def test_a_morph_is_both_shapes_at_its_ends(self):
        points = shapes.ellipsoid(400)
        other = sp.reconstruct(shapes.record(points, shapes.colors_of(points)))
        first = sp.reconstruct(shapes.record(self.points, shapes.colors_of(self.points)))
        pairs = [[np.argmax(mesh.vertices[:, 0]) for mesh in (first, other)]]
        morph = sp.morph(first, other, pairs=pairs)
        self.assertEqual((morph.impossible, len(morph.rotation)), ((), 3))
        shapes.check_closed(self, len(morph.first), morph.triangles)
        for end, mesh in ((0, first), (1, other)):
            frame = morph.at(end)
            places = np.abs(frame.vertices[:, None] - mesh.vertices).sum(axis=2)
            rows, vertices = np.nonzero(places < 1e-9)
            self.assertEqual(set(vertices), set(range(len(mesh.vertices))))
            np.testing.assert_array_equal(frame.colors[rows], mesh.colors[vertices])
        half = morph.at(0.5)
        np.testing.assert_allclose(half.vertices, (morph.first + morph.second) / 2, atol=1e-12)
        np.testing.assert_allclose(np.linalg.norm(half.normals, axis=1), 1.0, atol=1e-12)
        joint = np.flatnonzero((np.abs(morph.first - first.vertices[pairs[0][0]]) < 1e-9).all(axis=1))
        np.testing.assert_allclose(morph.second[joint], other.vertices[pairs[0][1]][None], atol=1e-9)
        large = sp.reconstruct(3 * points + 5)
        matched = sp.morph(first, large, match=True, connectivity="resampled", samples=642)
        self.assertEqual(len(matched.first), 642)
        self.assertIsNone(matched.at(0.5).colors)
        self.assertLess(np.abs(matched.second.mean(axis=0)).max(), 0.3)
        for option, value in (("align", "best"), ("connectivity", 1), ("fit", "spline"),
                              ("samples", 3), ("match", 1), ("pairs", [1, 2])):  # fmt: skip
            with self.assertRaisesRegex(sp.InvalidInput, f"{option} .*; "):
                sp.morph(first, other, **{option: value})
        with self.assertRaisesRegex(sp.InvalidInput, "; give the Results"):
            sp.morph(points, other)
        (lost,) = sp.morph(first, other, pairs=[[10**6, 0]]).impossible
        self.assertEqual(lost.pair, 0)

    def test_wrong_meshes_and_options_are_refused(self):
        mesh, map_, points, sphere = self.mesh, self.map, self.mesh.vertices, self.mesh.sphere
        triangles = mesh.triangles
        for arguments in (
            (points,), (mesh, triangles, sphere), (points, triangles[:20], sphere),
            (points, triangles - 1, sphere), (points, triangles.astype(float), sphere),
            (points, triangles + 2**40, sphere), (points, triangles, 2 * sphere),
            (points * np.nan, triangles, sphere),
        ):  # fmt: skip
            with self.assertRaisesRegex(sp.InvalidInput, "; "):
                sp.sphere_map(*arguments)
        for wrong in (sphere[:-1], sphere[:, :2]):
            with self.assertRaisesRegex(sp.InvalidInput, "; "):
                sp.measure_map_distortion(points, triangles, wrong)
        with self.assertRaisesRegex(sp.InvalidInput, "; give the mesh"):
            sp.texture_coordinates(points)
        for function, argument, name, values in (
            (sp.sphere_map, mesh, "area_weight", (2, "1")),
            (sp.sphere_map, mesh, "sweeps", (1001, 1.5)),
            (sp.remesh, map_, "grid", ("cubic", 1)),
            (sp.remesh, map_, "fit", ("spline",)),
            (sp.remesh, map_, "points", (3, 2**28 + 1, 1e3)),
            (sp.remesh, map_, "seed", (-1,)),
            (sp.remesh, map_, "threads", (-1,)),
            (sp.texture_coordinates, map_, "chart", ("cylinder",)),
        ):
            for value in values:
                with self.subTest(name, value=value):
                    with self.assertRaisesRegex(sp.InvalidInput, f"{name} = .*; "):
                        function(argument, **{name: value})
        with self.assertRaisesRegex(sp.InvalidInput, "margin"):
            sp.texture_coordinates(map_, chart="cube", margin=0.3)


if __name__ == "__main__":
    unittest.main()
