"""What reconstruct() and find_outliers() give."""

import inspect
import json
import os
import pickle
import subprocess
import tempfile
import unittest
from pathlib import Path
from typing import get_args

import numpy as np
import shapes
import spherical_param as sp
from spherical_param import _core

#: Keywords that are no rows of the table.
OTHERS = ["details", "progress"]
TOOLS = Path(os.environ.get("SPHERICAL_PARAM_TOOLS", "/nonexistent"))


class Mesh(unittest.TestCase):
    def test_every_point_is_a_vertex_of_a_closed_genus0_mesh(self):
        points = shapes.bumpy(3000)
        mesh = sp.reconstruct(points)
        shapes.check_closed_genus0(self, 3000, mesh.triangles)
        np.testing.assert_array_equal(mesh.vertices, points)
        np.testing.assert_array_equal(mesh.input_of_vertex, np.arange(3000))
        self.assertEqual((mesh.triangles.dtype, mesh.sphere.dtype), (np.int32, np.float64))
        np.testing.assert_allclose(np.linalg.norm(mesh.sphere, axis=1), 1.0, atol=1e-12)
        self.assertEqual(len(mesh.self_intersections), 0)
        self.assertTrue(mesh.diagnosis.looks_closed_genus0)
        self.assertEqual(mesh.topology.euler_characteristic, 2)
        self.assertEqual(mesh.topology.genus, 0)

    def test_volume_and_area_are_those_of_the_triangles(self):
        mesh = sp.reconstruct(shapes.ellipsoid(2000))
        # Rounding of some thousand terms.
        self.assertAlmostEqual(
            mesh.measures.volume, shapes.volume(mesh.vertices, mesh.triangles), delta=1e-11
        )
        a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0
        self.assertAlmostEqual(mesh.measures.area, area, delta=1e-11)
        # An inscribed polyhedron of 2000 vertices misses less than 2 % of an ellipsoid.
        self.assertAlmostEqual(mesh.measures.volume, 4.0 / 3.0 * np.pi * 1.4, delta=0.02 * 5.9)

    def test_permuted_points_give_the_same_mesh(self):
        points = shapes.bumpy(1500)
        order = np.random.default_rng(7).permutation(1500)
        mesh = sp.reconstruct(points)
        permuted = sp.reconstruct(points[order])
        self.assertEqual(
            shapes.triangle_set(mesh.triangles), shapes.triangle_set(order[permuted.triangles])
        )

    def test_single_precision_is_meshed_as_the_same_numbers_in_double(self):
        single = shapes.bumpy(1500).astype(np.float32)
        one, other = sp.reconstruct(single), sp.reconstruct(single.astype(np.float64))
        self.assertEqual(one.triangles.tobytes(), other.triangles.tobytes())
        self.assertEqual(one.sphere.tobytes(), other.sphere.tobytes())
        self.assertEqual(one.vertices.dtype, np.float64)

    def test_points_far_from_the_origin_keep_their_digits(self):
        # Multiples of 2^-24, which a shift by 2^26 changes by nothing; in single precision all
        # points would be one.
        points = np.round(shapes.bumpy(2000) * 2.0**24) / 2.0**24
        far = points + 2.0**26
        np.testing.assert_array_equal(far - 2.0**26, points)
        near_mesh, far_mesh = sp.reconstruct(points), sp.reconstruct(far)
        self.assertEqual(len(far_mesh.self_intersections), 0)
        self.assertEqual(far_mesh.duplicates, 0)
        shared = shapes.triangle_set(near_mesh.triangles) & shapes.triangle_set(far_mesh.triangles)
        # Sums of other roundings may turn a few edges.
        self.assertGreater(len(shared), 0.99 * len(near_mesh.triangles))

    def test_any_memory_layout_gives_the_same_bytes(self):
        points = shapes.ellipsoid(500)
        expected = sp.reconstruct(points).triangles.tobytes()
        wide = np.zeros((500, 7))
        wide[:, 1:6:2] = points
        read_only = points.copy()
        read_only.flags.writeable = False
        for name, same in {
            "fortran": np.asfortranarray(points),
            "strided": wide[:, 1:6:2],
            "lists": points.tolist(),
            "big-endian": points.astype(">f8"),
            "read-only": read_only,
            "objects": points.astype(object),
        }.items():
            with self.subTest(name):
                self.assertEqual(sp.reconstruct(same).triangles.tobytes(), expected)

    def test_results_own_their_memory_and_the_input_is_left_alone(self):
        points = shapes.ellipsoid(500)
        before = points.copy()
        mesh = sp.reconstruct(points, smoothing=1)
        for array in (
            mesh.vertices,
            mesh.triangles,
            mesh.sphere,
            mesh.smoothed,
            mesh.vertex_of_input,
            mesh.input_of_vertex,
        ):
            self.assertTrue(array.flags.owndata and array.flags.writeable)
            self.assertFalse(np.shares_memory(array, points))
            array[:] = 0
        np.testing.assert_array_equal(points, before)
        np.testing.assert_array_equal(
            sp.reconstruct(points).triangles, sp.reconstruct(before).triangles
        )

    def test_points_that_are_not_finite_are_ignored_and_counted(self):
        points = shapes.ellipsoid(600)
        dirty = np.insert(points, [0, 100, 600], [[np.nan, 0, 0]], axis=0)
        dirty[0] = [0, np.inf, 0]
        mesh = sp.reconstruct(dirty)
        self.assertEqual(mesh.ignored, 3)
        np.testing.assert_array_equal(np.flatnonzero(mesh.vertex_of_input == -1), [0, 101, 602])
        np.testing.assert_array_equal(mesh.vertices, points)
        np.testing.assert_array_equal(dirty[mesh.input_of_vertex], points)
        np.testing.assert_array_equal(mesh.triangles, sp.reconstruct(points).triangles)

    def test_masked_points_are_ignored(self):
        points = shapes.ellipsoid(600)
        mask = np.zeros_like(points, dtype=bool)
        mask[5, 1] = True
        mesh = sp.reconstruct(np.ma.MaskedArray(points, mask))
        self.assertEqual(mesh.ignored, 1)
        self.assertEqual(mesh.vertex_of_input[5], -1)

    def test_repeated_points_are_one_vertex(self):
        points = shapes.ellipsoid(600)
        mesh = sp.reconstruct(np.concatenate([points, points[:50], points[10:11]]))
        self.assertEqual((mesh.duplicates, len(mesh.vertices)), (51, 600))
        np.testing.assert_array_equal(mesh.vertex_of_input[600:650], np.arange(50))
        self.assertEqual(mesh.vertex_of_input[650], 10)
        self.assertTrue(mesh.warnings)

    def test_smoothing_moves_points_of_their_own(self):
        noisy = shapes.bumpy(1500) + np.random.default_rng(3).normal(scale=0.01, size=(1500, 3))
        mesh = sp.reconstruct(noisy, smoothing=5)
        np.testing.assert_array_equal(mesh.vertices, noisy)
        moved = np.linalg.norm(mesh.smoothed - noisy, axis=1)
        self.assertAlmostEqual(moved.max(), mesh.smoothing.max_displacement, delta=1e-12)
        self.assertGreater(moved.max(), 0.0)

    def test_a_bowl_is_diagnosed_as_open(self):
        points = shapes.directions(4000)
        mesh = sp.reconstruct(points[points[:, 2] < 0.3])
        self.assertEqual(mesh.diagnosis.kind, "open")
        self.assertFalse(mesh.diagnosis.looks_closed_genus0)
        self.assertEqual(mesh.diagnosis.openings, 1)
        self.assertEqual(mesh.diagnosis.filled_holes[0].cause, "open")
        # The opening is a circle at z = 0.3 around the axis.
        np.testing.assert_allclose(mesh.diagnosis.filled_holes[0].center, [0, 0, 0.3], atol=0.1)

    def test_results_can_be_pickled_and_shown(self):
        mesh = sp.reconstruct(shapes.ellipsoid(300))
        again = pickle.loads(pickle.dumps(mesh))
        np.testing.assert_array_equal(again.triangles, mesh.triangles)
        self.assertEqual(again.topology, mesh.topology)
        self.assertIn("300 vertices, 596 triangles", repr(mesh))
        for error in (sp.InvalidInput, sp.ComputeError, sp.Cancelled):
            self.assertIs(type(pickle.loads(pickle.dumps(error("cause; remedy")))), error)


class Tool(unittest.TestCase):
    @unittest.skipUnless((TOOLS / "pcl_spherical_param_reconstruction").exists(), "no tools")
    def test_the_tool_makes_the_same_mesh_of_single_precision(self):
        points = shapes.bumpy(2000).astype(np.float32)
        with tempfile.TemporaryDirectory() as folder:
            np.savetxt(Path(folder, "cloud.xyz"), points, fmt="%.9g")
            subprocess.run(
                [TOOLS / "pcl_spherical_param_reconstruction", "cloud.xyz", "mesh.off", "-ascii"]
                + ["-quiet", "-json", "report.json"],
                cwd=folder,
                check=True,
            )
            report = json.loads(Path(folder, "report.json").read_text())
            rows = Path(folder, "mesh.off").read_text().splitlines()
        mesh = sp.reconstruct(points)
        triangles = np.array([line.split()[1:4] for line in rows if line.startswith("3 ")], int)
        shared = shapes.triangle_set(triangles) & shapes.triangle_set(mesh.triangles)
        # Distances in single and double precision may order a few neighbours differently.
        self.assertGreater(len(shared), 0.99 * len(triangles))
        self.assertEqual(len(mesh.self_intersections), report["self_intersections"])
        self.assertAlmostEqual(mesh.measures.volume, report["measures"]["volume"], delta=1e-4)
        self.assertAlmostEqual(mesh.measures.area, report["measures"]["area"], delta=1e-3)


class Options(unittest.TestCase):
    def setUp(self):
        self.points = shapes.bumpy(400)

    def test_every_row_of_the_table_is_a_keyword_with_its_default(self):
        parameters = inspect.signature(sp.reconstruct).parameters
        rows = _core.option_table()
        self.assertEqual([*parameters], ["points", *(row["name"] for row in rows)] + OTHERS)
        for row in rows:
            parameter = parameters[row["name"]]
            self.assertEqual(parameter.kind, parameter.KEYWORD_ONLY)
            self.assertEqual(parameter.default, row["default"])
            if row["choices"]:
                self.assertEqual(list(get_args(parameter.annotation)), row["choices"])
                self.assertIn(row["default"], row["choices"])

    def test_every_option_changes_what_it_is_for(self):
        run = sp.reconstruct
        points = self.points
        usual = run(points)
        self.assertNotEqual(run(points, graph="knn").graph.edges, usual.graph.edges)
        self.assertNotEqual(run(points, graph="knn", k=5).graph.edges, usual.graph.edges)
        self.assertTrue(usual.embedding.levels)
        self.assertFalse(run(points, embedding="iterative").embedding.levels)
        for changed in (
            {"weights": "uniform"},
            {"weights": "inverse"},
            {"exponent": 4.0},
            {"damping": 0.9},
        ):
            self.assertFalse(np.array_equal(run(points, **changed).sphere, usual.sphere), changed)
        self.assertEqual(usual.embedding.stop_reason, "unfinished")
        self.assertFalse(usual.embedding.converged)
        solved = run(points, tolerance=1e-9)
        self.assertTrue(solved.embedding.converged)
        self.assertLessEqual(solved.embedding.residuals[-1], 1e-9)
        short = run(points, embedding="iterative", max_iterations=3)
        self.assertEqual((short.embedding.iterations, len(short.embedding.residuals)), (3, 4))
        self.assertEqual(run(points, starts=3).embedding.starts, 3)
        self.assertEqual(run(points, optimization="none").optimization.phases, ())
        names = {phase.name for phase in run(points, optimization="flips").optimization.phases}
        self.assertEqual(names, {"flips"})
        self.assertEqual(run(points, smoothing=2).smoothed.shape, (400, 3))
        self.assertIsNone(usual.smoothed)
        self.assertIsNone(usual.history)
        self.assertIsNone(usual.vertex_residuals)
        self.assertIsNone(usual.diagnosis.triangle_marks)

    def test_history_ends_at_the_sphere_and_details_have_an_entry_each(self):
        mesh = sp.reconstruct(self.points, history_vertices=50, history_frames=10, details=True)
        history = mesh.history
        self.assertTrue(0 < len(history.vertices) <= 50)
        self.assertEqual((history.frames[0].step, history.frames[-1].step), ("start", "end"))
        self.assertTrue(2 < len(history.frames) <= 10)
        for frame in history.frames:
            self.assertEqual(frame.sphere.shape, (len(history.vertices), 3))
            np.testing.assert_allclose(np.linalg.norm(frame.sphere, axis=1), 1.0, atol=1e-12)
        np.testing.assert_array_equal(history.frames[-1].sphere, mesh.sphere[history.vertices])
        self.assertEqual(mesh.vertex_residuals.shape, (400,))
        self.assertAlmostEqual(mesh.vertex_residuals.mean(), mesh.embedding.residual, delta=1e-12)
        marks = mesh.diagnosis.triangle_marks
        self.assertEqual((marks.shape, marks.dtype), ((len(mesh.triangles),), np.dtype(np.uint8)))
        points = shapes.directions(4000)
        bowl = sp.reconstruct(points[points[:, 2] < 0.3], details=True)
        filled_holes = sum(hole.triangles for hole in bowl.diagnosis.filled_holes)
        self.assertGreater(filled_holes, 0)
        self.assertEqual(np.count_nonzero(bowl.diagnosis.triangle_marks & 2), filled_holes)

    def test_threads_do_not_change_a_byte(self):
        points = shapes.bumpy(20000)
        one, two = (sp.reconstruct(points, threads=threads) for threads in (1, 2))
        self.assertEqual(one.triangles.tobytes(), two.triangles.tobytes())
        self.assertEqual(one.sphere.tobytes(), two.sphere.tobytes())

    def test_values_out_of_range_are_refused_with_cause_and_remedy(self):
        wrong = {
            "graph": ("voronoi", 1, None),
            "embedding": ("newton",),
            "weights": ("cotangent",),
            "triangulation": ("cgal",),
            "optimization": ("best",),
            "k": (2, -1, 2.5, "12", 10**20),
            "exponent": (2, 17, float("nan"), "3", 1j),
            "damping": (0, 1.5, None),
            "tolerance": (-1, 1.5, "small"),
            "max_iterations": (-1, 1.0),
            "stagnation_window": (-5,),
            "starts": (0, 101),
            "seed": (-1, 2**32),
            "retries": (-1, 100),
            "smoothing": (-1, 10001),
            "history_vertices": (-1, 2**24 + 1, 1.5),
            "history_frames": (1, 10001),
            "details": (1, "yes", None),
            "threads": (-1, 1025),
            "progress": (1, "print"),
        }
        known = set(inspect.signature(sp.reconstruct).parameters) - {"points"}
        self.assertEqual(set(wrong), known)
        for name, values in wrong.items():
            for value in values:
                with self.subTest(name=name, value=value):
                    with self.assertRaises(sp.InvalidInput) as raised:
                        sp.reconstruct(self.points, **{name: value})
                    self.assertIn(name, str(raised.exception))
                    self.assertIn("; ", str(raised.exception))
        with self.assertRaisesRegex(TypeError, "no option 'radius'; use one of graph, k, "):
            sp.reconstruct(self.points, radius=1)

    def test_numpy_numbers_are_numbers(self):
        mesh = sp.reconstruct(
            self.points, k=np.int64(10), damping=np.float32(0.5), seed=np.uint8(1)
        )
        self.assertEqual(len(mesh.vertices), 400)

    def test_arrays_are_no_numbers(self):
        for name in ("k", "damping"):
            with self.assertRaisesRegex(sp.InvalidInput, name + " = .* cannot be used; use "):
                sp.reconstruct(self.points, **{name: np.array([8, 9])})

    def test_an_absurd_k_is_refused_before_it_takes_all_memory(self):
        with self.assertRaisesRegex(sp.InvalidInput, "do not fit into memory; use a smaller k"):
            sp.reconstruct(shapes.directions(60000), k=2**31 - 1)


class Input(unittest.TestCase):
    def test_points_that_cannot_be_meshed_are_refused_with_cause_and_remedy(self):
        points = shapes.ellipsoid(50)
        record = np.zeros(50, dtype=[("x", "f4"), ("y", "f4"), ("z", "f4")])
        for name, (wrong, message) in {
            "transposed": (points.T, r"shape \(3, 50\).*; it looks transposed, give its \.T"),
            "flat": (points.ravel(), r"shape \(150,\).*; give an array of shape"),
            "pairs": (points[:, :2], r"shape \(50, 2\).*; give"),
            "wide": (np.hstack([points, points]), r"; give its first three columns"),
            "deep": (points[None], r"shape \(1, 50, 3\).*; give"),
            "complex": (points.astype(complex), r"complex128; give"),
            "text": (points.astype(str), r"<U\d+; give"),
            "bytes": (b"0 0 0", r"; give"),
            "bool": (points > 0, r"bool; give"),
            "dates": (points.astype("M8[s]"), r"datetime64.*; give"),
            "fields": (record, r"fields x, y, z; give"),
            "ragged": ([[1.0, 2.0, 3.0], [1.0]], r"cannot be made an array.*; give"),
            "none": (None, r"; give"),
            "empty": (np.zeros((0, 3)), r"4 distinct finite points are needed, but there are 0"),
            "three": (points[:3], r"but there are 3"),
            "same": (np.ones((10, 3)), r"but there are 1"),
            "flat cloud": (points * [1, 1, 0], r"in one plane; a closed surface needs"),
            "nan": (points * np.nan, r"there are 0 \(of the points, 50 are not finite\)"),
            "far": (points * 1e120, r"beyond 1e100; scale"),
        }.items():
            with self.subTest(name):
                with self.assertRaisesRegex(sp.InvalidInput, message):
                    sp.reconstruct(wrong)
                with self.assertRaises(ValueError):
                    sp.reconstruct(wrong)


class Outliers(unittest.TestCase):
    def test_points_off_the_surface_are_found_with_their_copies(self):
        points = shapes.ellipsoid(3000)
        off = np.array([[0.0, 0.0, 2.0], [0.0, -4.0, 0.0], [3.0, 0.0, 0.0]])
        cloud = np.concatenate([points, off, off[:1], [[np.nan] * 3]])
        outliers = sp.find_outliers(cloud)
        np.testing.assert_array_equal(outliers.indices, [3000, 3001, 3002, 3003])
        self.assertEqual(outliers.inliers.sum(), 3001)
        self.assertTrue(np.isnan(outliers.scores[3004]))
        self.assertTrue((outliers.scores[:3000] <= outliers.threshold).all())
        mesh = sp.reconstruct(cloud[outliers.inliers])
        np.testing.assert_array_equal(mesh.vertices, points)
        for wrong in ({"sigma": -1}, {"k": 2}, {"threads": -1}):
            with self.assertRaises(sp.InvalidInput):
                sp.find_outliers(cloud, **wrong)


if __name__ == "__main__":
    unittest.main()
