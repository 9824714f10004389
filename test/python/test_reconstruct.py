"""What reconstruct(), find_outliers() and find_parts() make of arrays and options."""

import inspect
import pickle
import unittest
from fractions import Fraction

import numpy as np
import shapes
import spherical_param as sp
from spherical_param import _core

#: Keywords that are no rows of the table, and wrong values of them.
OTHERS = {"columns": ("x,y,z",), "details": (1, "yes", None), "progress": (1, "print")}


class Mesh(shapes.InFolder):
    def test_the_mesh_and_its_numbers_are_those_of_the_arrays(self):
        points = shapes.ellipsoid(600)
        mesh = sp.reconstruct(points, details=True)
        shapes.check_closed(self, 600, mesh.triangles)
        np.testing.assert_array_equal(mesh.vertices, points)
        np.testing.assert_array_equal(mesh.input_of_vertex, np.arange(600))
        self.assertEqual((mesh.triangles.dtype, mesh.sphere.dtype), (np.int32, np.float64))
        np.testing.assert_allclose(np.linalg.norm(mesh.sphere, axis=1), 1.0, atol=1e-12)
        self.assertEqual((mesh.findings, mesh.diagnosis.cut_handles), ((), 0))
        self.assertEqual((mesh.topology.euler_characteristic, mesh.topology.genus), (2, 0))
        self.assertEqual((mesh.self_intersections.shape, mesh.boundary), ((0, 2), ()))
        # Outward, and rounding of some thousand terms.
        volume = shapes.volume(points, mesh.triangles)
        self.assertAlmostEqual(mesh.measures.volume, volume, delta=1e-11)
        np.testing.assert_array_equal(mesh.measures.box_min, points.min(axis=0))
        smooth = sp.reconstruct(points, smoothing=5)
        self.assertGreater(smooth.smoothing.max_displacement, 0.0)
        self.assertIn("300 vertices, 596 triangles", repr(sp.reconstruct(points[:300])))
        again = pickle.loads(pickle.dumps(mesh))
        np.testing.assert_array_equal(again.triangles, mesh.triangles)
        self.assertEqual(again.topology, mesh.topology)
        for array in (mesh.vertices, mesh.triangles, mesh.sphere,
                      mesh.vertex_of_input, mesh.input_of_vertex):  # fmt: skip
            self.assertTrue(array.flags.owndata and array.flags.writeable)
            array[:] = 0
        np.testing.assert_array_equal(points, shapes.ellipsoid(600))

    def test_any_layout_and_real_type_gives_the_same_bytes(self):
        points = shapes.ellipsoid(300).astype(np.float32).astype(float)
        expected = sp.reconstruct(points, details=True)
        wide = np.zeros((300, 7))
        wide[:, 1:6:2] = points
        read_only = points.copy()
        read_only.flags.writeable = False
        fractions = [[Fraction(x) for x in row] for row in points.tolist()]
        for same in (points.astype(np.float32), np.asfortranarray(points), wide[:, 1:6:2], points.tolist(),
                     fractions, points.astype(">f8"), read_only):  # fmt: skip
            with self.subTest(type(same), dtype=getattr(same, "dtype", None)):
                mesh = sp.reconstruct(same, details=True)
                self.assertEqual(mesh.triangles.tobytes(), expected.triangles.tobytes())
                self.assertEqual(mesh.sphere.tobytes(), expected.sphere.tobytes())
                self.assertEqual(mesh.vertices.tobytes(), points.tobytes())

    def test_added_vertices_come_last_and_are_marked_in_files(self):
        points = shapes.directions(2000)
        points = points[np.abs(points[:, 2]) < 0.8]
        mesh = sp.reconstruct(points, surface="closed", fill="smooth")
        self.assertEqual(len(mesh.vertices), len(points) + mesh.added_vertices)
        np.testing.assert_array_equal(mesh.vertices[: len(points)], points)
        marks = np.arange(len(mesh.vertices)) >= len(points)
        self.assertTrue(marks.any())
        ball = shapes.directions(300) + [4, 0, 0]
        both = sp.reconstruct(np.concatenate([ball, points]), surface="closed", fill="smooth", parts="each")
        for each, expected in ((mesh, marks), (both, np.concatenate([marks, np.zeros(300)]))):
            each.write(self.folder / "mesh.ply")
            header, _, body = (self.folder / "mesh.ply").read_bytes().partition(b"end_header\n")
            self.assertIn(b"\nproperty uchar added\n", header)
            record = np.dtype([("floats", "<f4", 6), ("added", "u1")])  # with normals
            np.testing.assert_array_equal(np.frombuffer(body, record, len(expected))["added"], expected)

    def test_ignored_and_repeated_points_are_counted_and_indexed(self):
        points = shapes.ellipsoid(300)
        dirty = np.ma.masked_array(np.insert(points, [0, 100, 300], np.nan, axis=0))
        dirty[302] = [0, np.inf, 0]
        dirty[101] = [0, 5, 0]
        dirty[101, 1] = np.ma.masked
        dirty = np.ma.concatenate([dirty, dirty[1:51]])
        mesh = sp.reconstruct(dirty)
        np.testing.assert_array_equal(mesh.left_out.not_finite, [0, 101, 302])
        self.assertEqual(mesh.duplicates, 50)
        np.testing.assert_array_equal(np.flatnonzero(mesh.vertex_of_input == -1), [0, 101, 302])
        np.testing.assert_array_equal(mesh.vertices, points)
        np.testing.assert_array_equal(dirty[mesh.input_of_vertex], points)
        np.testing.assert_array_equal(mesh.vertex_of_input[303:], np.arange(50))
        np.testing.assert_array_equal(mesh.triangles, sp.reconstruct(points).triangles)

    def test_figures_that_are_lists_or_absent_are_tuples_and_none(self):
        points = shapes.directions(1000)
        points = points[points[:, 2] < 0.3]
        mesh = sp.reconstruct(points)
        (loop,) = mesh.boundary
        self.assertLess(np.abs(mesh.vertices[loop, 2] - 0.3).max(), 0.2)
        self.assertIsNone(mesh.measures.volume)
        mesh = sp.reconstruct(points, topology="sphere", details=True)
        self.assertEqual(mesh.boundary, ())
        (opening,) = mesh.openings
        self.assertTrue(opening.is_filled and opening.is_certain)
        np.testing.assert_allclose(opening.center, [0, 0, 0.3], atol=0.1)
        marks = mesh.diagnosis.triangle_marks
        self.assertEqual((marks.shape, marks.dtype), ((len(mesh.triangles),), np.dtype(np.uint8)))
        filled = np.flatnonzero(marks & sp.TriangleMark.FILLED_HOLE)
        np.testing.assert_array_equal(filled, np.sort(opening.triangles))
        torus = sp.reconstruct(shapes.torus(24), details=True)
        self.assertEqual((torus.topology.genus, torus.sphere, torus.vertex_residuals), (1, None, None))


class Options(unittest.TestCase):
    def setUp(self):
        self.points = shapes.bumpy(200)

    def test_every_row_of_the_table_is_a_keyword_with_its_default(self):
        parameters = inspect.signature(sp.reconstruct).parameters
        rows = _core.option_table()
        self.assertEqual([*parameters], ["points", *(row["name"] for row in rows), *OTHERS])
        for row in rows:
            parameter = parameters[row["name"]]
            self.assertEqual(parameter.kind, parameter.KEYWORD_ONLY)
            self.assertEqual(parameter.default, row["default"])

    def test_options_of_each_type_have_their_effect(self):
        usual = sp.reconstruct(self.points)
        self.assertEqual((usual.embedding.stop_reason, usual.embedding.converged), ("unfinished", False))
        for absent in (usual.smoothing, usual.consolidation, usual.vertex_residuals,
                       usual.diagnosis.triangle_marks):  # fmt: skip
            self.assertIsNone(absent)
        short = sp.reconstruct(self.points, method="paper", max_iterations=np.int64(3), damping=np.float32(0.5))
        self.assertEqual((short.embedding.iterations, len(short.embedding.residuals)), (3, 4))
        self.assertTrue(sp.reconstruct(self.points, time_limit=0).is_out_of_time)
        mesh = sp.reconstruct(self.points, details=True)
        self.assertEqual(mesh.vertex_residuals.shape, (200,))

    def test_a_cloud_is_seen_from_the_sensor_or_a_given_place(self):
        points = shapes.depth_image()
        surfaces = sp.reconstruct(points)
        self.assertEqual(len(surfaces), 2)
        self.assertEqual((surfaces.view.source, surfaces[1].view.source), ("origin", "origin"))
        self.assertTrue(surfaces.verdict.startswith("Seen from one place: 2 surfaces with openings"))
        for place in ((5, 6.5, 7), np.array([5, 6.5, 7]), "5,6.5,7"):
            moved = sp.reconstruct(points + [5, 6.5, 7], view=place)
            np.testing.assert_array_equal(moved.view.place, [5, 6.5, 7])
            self.assertEqual([len(each.vertices) for each in moved], [len(each.vertices) for each in surfaces])
        self.assertIsNone(sp.reconstruct(points, view="none").view)
        for wrong in ((1, 2), "1,2", 3, (1, 2, np.nan)):
            with self.assertRaisesRegex(sp.InvalidInput, "view = .*; use auto, none, up or x,y,z"):
                sp.reconstruct(points, view=wrong)

    def test_wrong_values_are_refused_with_cause_and_remedy(self):
        for row in _core.option_table():
            wrong = [1j, b"1", np.array([8, 9])]
            wrong += ["voronoi"] if row["choices"] else []
            if row["is_number"]:
                wrong += [-2, 10**20, "12"] + ([2.5] if row["is_integer"] else [float("nan")])
            else:
                wrong += [1]
            wrong += [] if row["optional"] else [None]
            self.check_refused(row["name"], wrong)
        for name, wrong in OTHERS.items():
            self.check_refused(name, wrong)
        for function, name, wrong in (
            (sp.find_outliers, "sigma", (-1, "4")), (sp.find_outliers, "threads", (-1,)),
            (sp.find_parts, "min_points", (3,)), (sp.find_parts, "threads", (-1,)),
        ):  # fmt: skip
            self.check_refused(name, wrong, function)
        with self.assertRaisesRegex(sp.InvalidInput, "do not fit into memory; use a smaller k"):
            sp.reconstruct(shapes.directions(60000), method="paper", k=2**31 - 1)
        with self.assertRaisesRegex(TypeError, "no option 'radius'; use one of topology, view, outliers, "):
            sp.reconstruct(self.points, radius=1)

    def check_refused(self, name, values, function=sp.reconstruct):
        for value in values:
            with self.subTest(name=name, value=value):
                with self.assertRaisesRegex(sp.InvalidInput, name + "(.|\n)*; "):
                    function(self.points, **{name: value})


class Unknown:
    points = [[0.0, 0.0, 0.0]]


class Input(unittest.TestCase):
    def test_points_that_cannot_be_meshed_are_refused_with_cause_and_remedy(self):
        self.assertTrue(issubclass(sp.InvalidInput, ValueError))
        points = shapes.ellipsoid(50)
        record = np.zeros(50, dtype=[("x", "f4"), ("y", "f4"), ("w", "f4")])
        for wrong, message in (
            (points.T, r"shape \(3, 50\).*; it looks transposed, give its \.T"),
            (points.ravel(), r"shape \(150,\).*; give an array of shape"),
            (points[:, :2], r"shape \(50, 2\).*; give"),
            (np.hstack([points, points]), r"; give its first three columns"),
            (points[None], r"shape \(1, 50, 3\).*; give"),
            (points.astype(complex), r"complex128; give"),
            (points.astype(str), r"<U\d+; give"),
            (points > 0, r"bool; give"),
            (record, r"fields x, y, w; give one with x, y and z"),
            (Unknown(), r"has the unknown type Unknown; pass np.asarray\(pcd.points\)"),
            ([[1.0, 2.0, 3.0], [1.0]], r"cannot be made an array.*; give"),
            (None, r"; give"),
            (points[:0], r"4 distinct finite points are needed, but there are 0"),
            (points * np.nan, r"there are 0 \(left out: 50 points that are not finite\)"),
        ):
            with self.subTest(message), self.assertRaisesRegex(sp.InvalidInput, message):
                sp.reconstruct(wrong)


class Outliers(unittest.TestCase):
    def test_points_off_the_surface_are_found_with_their_copies(self):
        points = shapes.ellipsoid(2000)
        off = np.array([[0.0, 0.0, 2.0], [0.0, -4.0, 0.0], [3.0, 0.0, 0.0]])
        cloud = np.concatenate([[[np.nan] * 3], points, off, off[:1]])
        for sigma in (4.0, "auto"):
            outliers = sp.find_outliers(cloud, sigma=sigma)
            np.testing.assert_array_equal(outliers.indices, [2001, 2002, 2003, 2004])
            np.testing.assert_array_equal(np.flatnonzero(~outliers.inliers), outliers.indices)
        self.assertEqual(len(sp.find_outliers(cloud, sigma=1000).indices), 0)


class Parts(shapes.InFolder):
    """Rows 1 to 200 are small, 201 to 600 large, 601 is stray, 0 is not finite."""

    large, small = shapes.ellipsoid(400), shapes.ellipsoid(200) + [9.0, 0.0, 0.0]
    cloud = np.concatenate([[[np.nan] * 3], small, large, [[50.0, 0.0, 0.0]]])

    def check(self, mesh, first, points):
        alone = sp.reconstruct(points)
        self.assertEqual(mesh.triangles.tobytes(), alone.triangles.tobytes())
        np.testing.assert_array_equal(mesh.input_of_vertex, np.arange(first, first + len(points)))
        expected = np.full(len(self.cloud), -1)
        expected[mesh.input_of_vertex] = np.arange(len(points))
        np.testing.assert_array_equal(mesh.vertex_of_input, expected)
        np.testing.assert_array_equal(mesh.left_out.not_finite, [0])

    def test_parts_are_meshed_each_or_the_largest_and_refer_to_the_whole_input(self):
        both = sp.reconstruct(self.cloud)
        self.assertIsInstance(both, tuple)
        verdict = "2 surfaces, all sound; 1 stray point left out."
        self.assertEqual((both.verdict, both.findings), (verdict, ()))
        np.testing.assert_array_equal(both.left_out.outliers, [601])
        np.testing.assert_array_equal(self.cloud[both.input_of_vertex], both.vertices)
        joined = np.concatenate([both[0].triangles, both[1].triangles + 400])
        np.testing.assert_array_equal(both.triangles, joined)
        self.assertEqual((both.normals.shape, both.colors), ((600, 3), None))
        both.write(self.folder / "both.obj")
        np.testing.assert_array_equal(shapes.faces_of(self.folder / "both.obj"), joined)
        self.check(both[0], 201, self.large)
        self.check(both[1], 1, self.small)
        self.check(sp.reconstruct(self.cloud, parts="largest"), 201, self.large)
        (one,) = sp.reconstruct(self.cloud, parts="each", min_points=201)
        self.check(one, 201, self.large)
        np.testing.assert_array_equal(np.concatenate(sp.find_parts(self.cloud)), np.r_[201:601, 1:201])
        self.assertEqual(len(sp.find_parts(self.cloud, min_points=201)), 1)
        with self.assertRaisesRegex(sp.InvalidInput, "no part has min_points = 500 points.*; give a lower"):
            sp.reconstruct(self.cloud, parts="each", min_points=500)

    def test_a_part_that_cannot_be_meshed_is_a_warning(self):
        side = np.arange(10.0)
        flat = np.stack(np.meshgrid(side, side, [50.0]), axis=-1).reshape(-1, 3) / 10
        cloud = np.concatenate([self.large, flat])
        with self.assertWarnsRegex(UserWarning, r"1 part \(100 points\) cannot be meshed"):
            mesh = sp.reconstruct(cloud, surface="closed")
        self.assertEqual(len(mesh.vertices), 400)

    def test_findings_can_be_pasted(self):
        mesh = sp.reconstruct(np.concatenate([self.small[:100], self.large]), topology="sphere")
        finding = next(finding for finding in mesh.findings if finding.option == "topology")
        self.assertEqual(str(finding), '2 separate parts (100 and 400 points): try topology="scan"')
        for value, text in (("1e-8", "1e-8"), ("5", "5"), ("auto", '"auto"')):
            finding = sp.Finding("a text", "option", value, False, False, "kind", 0.0, ())
            self.assertEqual(str(finding), f"a text: try option={text}")
        self.assertEqual(str(sp.Finding("a text", "", "", False, False, "kind", 0.0, ())), "a text")
