"""What sphere_map(), remesh(), morph() and texture_coordinates() make of arrays and options."""

import unittest

import numpy as np
import shapes
import spherical_param as sp


class Maps(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.points = shapes.bumpy(600)
        cls.mesh = sp.reconstruct(cls.points, details=True)
        cls.map = sp.sphere_map(cls.mesh)

    def test_maps_are_one_to_one_and_their_distortion_is_that_of_their_arrays(self):
        new, embedding = self.map, sp.measure_map_distortion(self.mesh)
        self.assertEqual((new.distortion.flipped_triangles, new.caps.shape), (0, (0, 3)))
        self.assertEqual(new.distortion, sp.measure_map_distortion(new))
        # Of vectors that were made units once more.
        self.assertAlmostEqual(new.before.area.mean, embedding.area.mean, delta=1e-9)

    def test_every_option_has_its_effect(self):
        for function, mesh, base, options in (
            (sp.sphere_map, self.mesh, {}, {"area_weight": 0.1, "sweeps": 0}),
            (sp.remesh, self.mesh, {}, {"area_weight": 0.1, "sweeps": 0}),
            (sp.remesh, self.map, {}, {"grid": "octahedral", "fit": "linear", "points": 162}),
            (sp.texture_coordinates, self.map, {}, {"chart": "equirectangular"}),
            (sp.texture_coordinates, self.map, {"chart": "cube"}, {"margin": 0.1}),
        ):
            usual, again = function(mesh, **base), function(mesh, **base)
            field = "directions" if function is sp.sphere_map else "coordinates"
            field = "vertices" if function is sp.remesh else field
            self.assertEqual(getattr(usual, field).tobytes(), getattr(again, field).tobytes())
            for name, value in options.items():
                with self.subTest(function.__name__, **{name: value}):
                    other = getattr(function(mesh, **{**base, name: value}), field)
                    self.assertFalse(np.array_equal(other, getattr(usual, field)))
        self.assertEqual({level.sweeps for level in sp.sphere_map(self.mesh, sweeps=0).levels}, {0})

    def test_arrays_and_smoothed_points_are_mapped_as_results_are(self):
        mesh = self.mesh
        again = sp.sphere_map(mesh.vertices, mesh.triangles.tolist(), mesh.sphere)
        self.assertEqual(again.directions.tobytes(), self.map.directions.tobytes())
        self.assertFalse(np.shares_memory(again.vertices, mesh.vertices))
        smooth = sp.reconstruct(self.points, smoothing=3)
        np.testing.assert_array_equal(sp.sphere_map(smooth, sweeps=0).vertices, smooth.vertices)

    def test_a_map_needs_no_embedding(self):
        free = sp.sphere_map(self.mesh.vertices, self.mesh.triangles)
        self.assertEqual((free.before, free.distortion.flipped_triangles), (None, 0))
        plain = sp.reconstruct(self.points)  # made from the faces of the graph
        self.assertEqual((plain.sphere, sp.sphere_map(plain).before), (None, None))
        with self.assertRaisesRegex(sp.InvalidInput, "no sphere to measure; .*details=True"):
            sp.measure_map_distortion(plain)

    def test_surfaces_with_openings_stay_open(self):
        points = shapes.ellipsoid(1500)
        mesh = sp.reconstruct(points[points[:, 2] < 0.3], surface="open")
        mapped = sp.sphere_map(mesh)
        self.assertGreater(len(mapped.caps), 0)
        self.assertLess(sp.remesh(mapped).vertices[:, 2].max(), 0.31)

    def test_a_remeshed_surface_has_its_arrays_and_carries_values_over(self):
        new = sp.remesh(self.map, points=162, fit="linear")
        self.assertEqual((new.moved, new.flipped_edges, new.frequency), (0, 0, 4))
        self.assertEqual((new.triangles.shape, new.self_intersections.shape), ((320, 3), (0, 2)))
        self.assertGreater((new.vertices * new.normals).sum(axis=1).min(), 0.0)
        np.testing.assert_allclose(np.linalg.norm(new.directions, axis=1), 1.0, atol=1e-12)
        np.testing.assert_allclose(new.transfer(np.ones(600)), 1.0, atol=1e-12)
        np.testing.assert_allclose(new.transfer(self.points), new.vertices, atol=1e-12)
        for wrong in (np.ones(3), np.ones((600, 2, 2)), ["a"] * 600):
            with self.assertRaises(sp.InvalidInput):
                new.transfer(wrong)

    def test_texture_coordinates_lie_in_the_square_and_the_surface_stays(self):
        atlas = sp.texture_coordinates(self.mesh)
        self.assertTrue(((atlas.coordinates >= 0) & (atlas.coordinates <= 1)).all())
        self.assertEqual(atlas.triangles.shape, atlas.coordinate_triangles.shape)
        self.assertLess(atlas.coordinate_triangles.max(), len(atlas.coordinates))
        self.assertEqual(set(atlas.source_triangle), set(range(len(self.mesh.triangles))))
        np.testing.assert_array_equal(atlas.vertices[: len(self.points)], self.mesh.vertices)

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
        np.testing.assert_allclose(morph.at(0.5).vertices, (morph.first + morph.second) / 2, atol=1e-12)
        joint = (np.abs(morph.first - first.vertices[pairs[0][0]]) < 1e-9).all(axis=1)
        np.testing.assert_allclose(morph.second[joint], other.vertices[pairs[0][1]][None], atol=1e-9)
        (lost,) = sp.morph(first, other, pairs=[[10**6, 0]]).impossible
        self.assertEqual(lost.pair, 0)
        large = sp.sphere_map(sp.reconstruct(3 * points + 5))
        matched = sp.morph(first, large, match=True, connectivity="resampled", samples=642)
        self.assertEqual(len(matched.first), 642)
        place = large.interpolate(large.directions, matched.second_triangle, matched.second_weights)
        turned = place / np.linalg.norm(place, axis=1, keepdims=True) @ matched.rotation
        np.testing.assert_allclose(turned, matched.directions, atol=1e-9)
        self.assertIsNone(matched.at(0.5).colors)

    def test_meshes_without_a_map_to_one_sphere_are_refused(self):
        handle = sp.reconstruct(shapes.torus(24))
        remedy = 'no map to one sphere: it has 1 handle; .*handles="none"'
        morph = lambda mesh: sp.morph(self.map, mesh)  # noqa: E731
        for function in (sp.sphere_map, sp.measure_map_distortion, sp.remesh, sp.texture_coordinates, morph):
            with self.assertRaisesRegex(sp.InvalidInput, remedy):
                function(handle)
        with self.assertRaisesRegex(sp.InvalidInput, "its genus is 1; cut its handles"):
            sp.sphere_map(handle.vertices, handle.triangles, handle.vertices)

    def test_wrong_meshes_and_options_are_refused(self):
        mesh, map_, points, sphere = self.mesh, self.map, self.mesh.vertices, self.mesh.sphere
        triangles = mesh.triangles
        for arguments in (
            (points,), (mesh, triangles, sphere), (points, triangles[:20], sphere),
            (points, triangles.astype(float), sphere), (points, triangles + 2**40, sphere),
            (points * np.nan, triangles, sphere), (points, triangles, sphere[:, :2]),
        ):  # fmt: skip
            with self.assertRaisesRegex(sp.InvalidInput, "; "):
                sp.sphere_map(*arguments)
        morph = lambda mesh, **options: sp.morph(mesh, mesh, **options)  # noqa: E731
        for function, argument, wrong in (
            (sp.sphere_map, mesh, {"area_weight": (2, "1"), "sweeps": (1001, 1.5)}),
            (sp.measure_map_distortion, mesh, {"threads": (-1,)}),
            (sp.remesh, map_, {"grid": ("cubic", 1), "fit": ("spline",), "points": (3, 2**28 + 1, 1e3),
                               "threads": (-1,)}),
            (sp.texture_coordinates, map_, {"chart": ("cylinder", 1), "margin": (0.3, "a")}),
            (morph, map_, {"align": ("best",), "connectivity": (1,), "fit": ("spline",), "samples": (3,),
                           "match": (1,), "pairs": ([1, 2], [[0.5, 1]])}),
        ):  # fmt: skip
            for name, value in ((name, value) for name, values in wrong.items() for value in values):
                with self.subTest(name, value=value):
                    with self.assertRaisesRegex(sp.InvalidInput, f"{name}.*; "):
                        function(argument, **{name: value})
        for function in (sp.texture_coordinates, lambda points: sp.morph(points, mesh)):
            with self.assertRaisesRegex(sp.InvalidInput, "; give the (mesh|Results)"):
                function(points)
