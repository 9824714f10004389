"""pcl_spherical_param_reconstruction: what is written, reported and printed."""

import os
import pathlib
import pty
import subprocess
import unittest

import numpy as np
from tool_test import (Mesh, ToolTest, call, ellipsoid, lengths, program, read_json, read_ply, report_of, run,
                       volume, write, write_ply, write_xyz)  # fmt: skip

NORMALS, COLORS = "nx ny nz", "red green blue"
TYPES = {
    "version": "", "input": "", "output": "", "offset": [0.1, 0.1, 0.1], "points": 0, "vertices": 0, "edges": 0,
    "duplicates": 0, "triangles": 0, "components": 0, "genus": 0, "boundary_loops": 0, "self_intersections": 0,
    "intersecting_triangles": 0, "peak_memory_bytes": 0, "usable": True, "closed": True, "manifold": True,
    "oriented": True, "is_noisy": True, "is_out_of_time": True, "verdict": "", "findings": [], "openings": [],
    "self_intersecting_pairs": [], "outliers": [], "boundary": [], "consolidation": None,
    "smoothing": {"max_displacement": 0.1}, "view": None, "stages": [{"name": "", "seconds": 0.1}],
    "left_out": {"not_finite": [], "outliers": [], "other_parts": []},
    "embedding": {"iterations": 0, "start_level": 0, "residual": 0.1, "centroid_norm": 0.1, "converged": True,
                  "fallback_start": True, "stop_reason": "", "barrier": "", "residuals": [],
                  "levels": [{"newton_iterations": 0}]},
    "diagnosis": {"edges_outside_graph": 0.1, "cut_handles": 0, "bridges": [], "joined_parts": 0},
    "measures": {"volume": 0.1, "area": 0.1, "mean_edge_length": 0.1, "box_min": [0.1, 0.1, 0.1],
                 "box_max": [0.1, 0.1, 0.1], "centroid": [0.1, 0.1, 0.1], "inertia": [[0.1], [0.1], [0.1, 0.1, 0.1]]},
}  # fmt: skip


def tool(*words, **more):
    return call("reconstruction", *words, **more)


def reported(*words):
    return report_of("reconstruction", *words)


class ReconstructionTool(ToolTest):
    """200 points of an ellipsoid in in.ply, with normals and colours."""

    def setUp(self):
        super().setUp()
        self.points, self.normals = ellipsoid(200), ellipsoid(200, (1, 1, 1))
        self.colors = np.round(127 * self.normals + 128)
        write_ply("in.ply", self.points, self.normals, self.colors)

    def test_mesh_and_sphere_have_the_same_triangles_and_keep_what_the_points_have(self):
        run("reconstruction", "in.ply", "out.PLY", "-sphere", "sphere.ply")
        out, sphere = Mesh("out.PLY"), Mesh("sphere.ply")
        self.same(out.points, self.points)
        self.assertEqual(out.vertices.dtype["x"], "f4")
        self.same(out[NORMALS], self.normals)
        self.same(out[COLORS], self.colors)
        self.check_sphere(out)
        self.assertGreater(volume(out.points, out.triangles), 0)
        self.same(sphere.triangles, out.triangles)
        self.same(sphere[COLORS], self.colors)
        self.assertNotIn("nx", sphere)
        # The rounding of three floats.
        self.assertLess(np.abs(lengths(sphere.points) - 1).max(), 2e-7)

    def test_what_further_columns_hold_is_said_and_comes_along(self):
        others = [(i % 7 + 0.5, 10, 20, 30) for i in range(200)]
        write_xyz("in.pts", np.hstack([self.points, others]), head="200")
        said = "200 points; text, 7 columns: x y z intensity red green blue, separated by blanks\n"
        self.assertIn(said, run("reconstruction", "in.pts", "out.ply", "-verbose"))
        out = Mesh("out.ply")
        self.same(out.points, self.points)
        self.same(out["intensity red green blue"], others)
        options = reported("in.pts", "out.ply", "-columns", "x,y,z,-,nx,ny,nz")["options"]
        self.assertEqual(options["columns"], ["x", "y", "z", "-", "nx", "ny", "nz"])
        self.assertNotIn("red", Mesh("out.ply"))
        self.assertEqual(Mesh("out.ply")["nz"][0], 30)
        self.assertIn("out.stl (without colours)\n", run("reconstruction", "in.pts", "out.stl"))

    def test_normals_that_are_null_are_replaced_by_those_of_the_mesh(self):
        write_ply("in.ply", self.points, np.where(np.arange(200)[:, None] % 2, self.points * 0, np.nan))
        run("reconstruction", "in.ply", "out.ply")
        written = Mesh("out.ply")[NORMALS]
        self.assertLess(np.abs(lengths(written) - 1).max(), 1e-6)
        self.assertGreater((written * self.points).sum(axis=1).min(), 0)

    def test_an_offset_is_taken_off_where_single_precision_is_too_coarse(self):
        utm = self.points + (512345.678, 5412345.25, 301.5)
        write_ply("utm.ply", utm)
        self.assertEqual(reported("utm.ply", "out.ply")["offset"], [0, 0, 0])
        self.check_all_in(utm, Mesh("out.ply").points)
        self.assertEqual(Mesh("out.ply").vertices.dtype["x"], "f8")
        self.assertEqual(reported("in.ply", "out.stl")["offset"], [0, 0, 0])
        for name in ("out.stl", "out.glb"):
            self.assertEqual(reported("utm.ply", name)["offset"], [512346, 5412345, 302])
            self.assertIn(f"{name} (less 512346, 5412345, 302)\n", run("reconstruction", "utm.ply", name))
        offset = [512345, 5412345.25, 300]
        report = reported("utm.ply", "out.ply", "-offset", "512345,5412345.25,300")
        self.assertEqual(report["options"]["offset"], offset)
        self.assertLess(np.abs(Mesh("out.ply").points + offset - utm).max(), 1e-6)
        self.check_refused(2, {"reconstruction utm.ply out.stl -offset 1,2": "three numbers"})

    def test_a_ply_file_marks_the_vertices_that_were_added_to_each_surface(self):
        whole = np.concatenate([ellipsoid(600, (1, 1, 1), (x, 0, 0)) for x in (0, 5)])
        given = whole[np.abs(whole[:, 2]) < 0.8]  # unit spheres without caps
        write_ply("two.ply", given, given, np.full_like(given, 99))

        def filled(*options):
            return tool("two.ply", *options, "-surface", "closed", "-fill", "smooth").stderr

        def marks(name):
            out = Mesh(name)
            is_given = [(given == point).all(axis=1).any() for point in out.points]
            self.same(out["added"][:, 0], np.where(is_given, 0, 1))
            self.assertIn("red", out)
            return out["added"].sum()

        filled("out.ply", "-json", "r.json")
        marked = marks("out.ply")
        self.assertGreater(marked, 0)
        self.assertEqual(len(read_json("r.json")["parts"]), 2)
        filled("text.ply", "-ascii")
        self.assertEqual(pathlib.Path("text.ply").read_text().count(" 99 99 99 1\n"), marked)
        filled("out_%03d.ply")
        self.assertEqual(marks("out_000.ply") + marks("out_001.ply"), marked)
        self.assertIn("give -fill flat", filled("out.ply", "-sphere", "s.ply"))
        run("reconstruction", "two.ply", "out.ply", "-surface", "closed")
        self.assertNotIn("added", Mesh("out.ply"))

    def check_types(self, report, example, path=""):
        """The members of an example are there, with values of the same types; of lists the first."""
        self.assertIs(type(report), type(example), path)
        if isinstance(example, (dict, list)):
            for key, value in example.items() if isinstance(example, dict) else enumerate(example):
                self.check_types(report[key], value, f"{path}/{key}")

    def test_report_has_all_keys_with_their_types(self):
        report = reported("in.ply", "out.ply", "-sphere", "sphere.ply", "-smoothing", 3)
        self.check_types(report, TYPES)
        # Smoothing steps do not end at a solution.
        self.check_entries(report, {"points": 200, "triangles": 396, "closed": True, "manifold": True,
                                    "oriented": True, "genus": 0, "diagnosis": {"cut_handles": 0},
                                    "embedding": {"stop_reason": "unfinished"}, "is_out_of_time": False,
                                    "options": {"time_limit": None}})  # fmt: skip
        out = Mesh("out.ply")
        # Smoothing moves the points alone.
        self.assertAlmostEqual(report["measures"]["volume"], volume(self.points, out.triangles), delta=1e-9)
        moved = lengths(out.points - self.points).max()
        self.assertGreater(moved, 0.001)
        self.assertAlmostEqual(report["smoothing"]["max_displacement"], moved, delta=1e-6)  # of single precision

    def test_options_reach_the_library_and_those_without_effect_are_null(self):
        paper = reported("in.ply", "out.ply", "--method=paper", "-max-iterations=3", "-weights", "inverse")
        iteration = paper["embedding"]
        self.check_entries(iteration, {"iterations": 3, "stop_reason": "iteration_limit", "levels": []})
        # A residual before each step and at the end.
        self.assertEqual([len(iteration["residuals"]), iteration["residuals"][-1]], [4, iteration["residual"]])
        self.check_entries(paper["options"], {"max_iterations": 3, "weights": "inverse", "k": 25,
                                              "tolerance": None, "surface": None})  # fmt: skip
        standard = reported("in.ply", "out.ply", "-seed", 5, "-sphere", "sphere.ply")
        self.check_entries(standard["options"], {"seed": 5, "max_iterations": None, "k": None})
        self.assertLess(standard["embedding"]["levels"][0]["edges"], 200 * 4)

    def test_options_are_taken_in_every_notation_and_order(self):
        os.rename("in.ply", "-in.ply")
        for line in ("-seed +7 -offset -1,2,3 -quiet -- -in.ply out.ply",
                     "--quiet --seed 7 --offset -1,2,3 -- -in.ply out.ply",
                     "-offset=-1,2,3 ./-in.ply -seed=7 -quiet out.ply",
                     "./-in.ply --seed=7 out.ply --quiet --offset=-1,+2.,3"):  # fmt: skip
            self.assertEqual(run("reconstruction", "-json", "r.json", *line.split()), "")
            self.check_entries(read_json("r.json")["options"], {"seed": 7, "offset": [-1, 2, 3]})
        report = reported("./-in.ply", "out.ply", "-offset", "+.25,-1e-3,-1e-999")
        self.assertEqual(report["options"]["offset"], [0.25, -1e-3, 0])

    def test_findings_name_points_of_the_input_behind_those_left_out(self):
        # Outliers and points that are not finite before all others shift the vertices.
        run("scan", "bowl", "plain.xyz", "-points", 1000)
        write("shifted.xyz", "nan 0 0\n5 5 5\n5 5 5\n" + pathlib.Path("plain.xyz").read_text())
        closed = "out.ply", "-topology", "sphere"
        plain, shifted = (reported(name, *closed, "-outliers", 6) for name in ("plain.xyz", "shifted.xyz"))
        self.check_entries(shifted, {"left_out": {"outliers": [1, 2], "not_finite": [0]}, "outliers": [],
                                     "vertices": 1000})  # fmt: skip
        self.assertEqual(shifted["openings"][0]["loop"], [vertex + 3 for vertex in plain["openings"][0]["loop"]])
        self.assertEqual(reported("shifted.xyz", *closed)["outliers"], [1])

    def test_a_mesh_that_is_not_usable_ends_with_3_and_has_a_sample_of_its_intersections(self):
        run("scan", "hand", "mess.ply", "-points", 1000)
        done, report = tool("mess.ply", "out.ply", "-method", "paper", "-json", "r.json"), read_json("r.json")
        self.assertEqual([done.returncode, report["usable"]], [3, False])
        self.assertGreater(report["self_intersections"], 1000)
        self.assertEqual(len(report["self_intersecting_pairs"]), 1000)
        # What it encloses means nothing.
        self.check_entries(report["measures"], {"volume": None, "centroid": None, "inertia": None})
        self.assertNotIn("centroid", done.stdout)

    def test_a_depth_image_is_seen_from_its_sensor(self):
        run("scan", "desk", "depth.ply", "-points", 4800, "-noise", 0)
        write_xyz("depth.xyz", read_ply("depth.ply")[0] + [10, 0, 0])
        report = reported("depth.xyz", "mesh.ply", "-view", "10,0,0", "-sphere", "sphere.ply")
        self.assertEqual(report["view"], {"place": [10.0, 0.0, 0.0], "source": "given"})
        self.assertRegex(report["verdict"], r"^Seen from one place: \d surfaces with openings")
        mesh, sphere = Mesh("mesh.ply"), Mesh("sphere.ply")
        np.testing.assert_array_equal(mesh.triangles, sphere.triangles)
        self.assertIsNone(reported("depth.xyz", "mesh.ply", "-view", "none")["view"])

    @unittest.skipIf(os.environ.get("SPHERICAL_PARAM_SANITIZE"), "sanitizers take memory of their own")
    def test_takes_less_than_one_kilobyte_a_point(self):
        large = bytearray(b"x" * (100 << 20))  # what the process that starts the tool has in use is no part of it
        peaks = []
        for count in (200, 30000):
            write_xyz("many.xyz", ellipsoid(count))
            peaks.append(reported("many.xyz", "out.ply")["peak_memory_bytes"])
        self.assertLess(peaks[0], 60 << 20)
        self.assertLess(peaks[1] - peaks[0], 1024 * 30000)
        self.assertEqual(large[-1:], b"x")

    def test_prints_six_lines_with_what_is_left_out_and_warnings_apart(self):
        write_xyz("noisy.xyz", [(np.nan, 0, 0), (9, 9, 9)], self.points, self.points[::10], [(1, np.inf, 0)])
        clean = tool("noisy.xyz", "out.ply", "-json", "r.json")
        self.check_entries(read_json("r.json"), {"points": 223, "duplicates": 20, "vertices": 200, "findings": [],
                                                 "left_out": {"not_finite": [0, 222], "outliers": [1]}})  # fmt: skip
        self.same(Mesh("out.ply").points, self.points)
        self.assertEqual([clean.stderr, clean.stdout.count("\n")], ["", 6])
        self.assertTrue(clean.stdout.startswith("read      noisy.xyz, 223 points\n"
                                                "verdict   A sound mesh; 1 stray point left out.\n"
                                                "made      200 vertices, 396 triangles\n"
                                                "time      "), clean.stdout)  # fmt: skip
        self.assertIn("\nleft out  20 duplicates, 2 points that are not finite, 1 stray point\n"
                      "written   out.ply, r.json\n", clean.stdout)  # fmt: skip
        for words in ((), ("-json", "-")):
            self.assertEqual(tool("noisy.xyz", "out.ply", "-topology", "sphere", *words).stderr,
                             "warning: 1 stray point in the mesh: try -topology scan\n")  # fmt: skip
        self.assertEqual(tool("noisy.xyz", "out.ply", "-quiet").stderr, "")

    def test_verbose_prints_options_stages_and_tables(self):
        said = tool("in.ply", "out.ply", "-smoothing", 3, "-sphere", "s.ply", "-verbose", text=False).stdout.decode()
        self.assertNotRegex(said, "[\r\033]")
        for line in ("\n  method              default\n", "\n  embedding  ", "\n  write  ", "\n  nodes  edges  sweeps ",
                     "\n  volume  ", "\n  centroid  ", "\nverdict   A sound mesh.\n"):  # fmt: skip
            self.assertIn(line, said)

    def test_a_finding_is_a_command_that_helps(self):
        run("scan", "bowl", "bowl.ply", "-points", 2000)
        said = tool("bowl.ply", "out.ply", "-topology", "sphere").stderr
        self.assertIn(": try -", said)
        option, value = said.split(": try ")[1].split()[:2]
        better = tool("bowl.ply", "out.ply", option, value, "-strict")
        self.assertEqual([better.returncode, better.stderr], [0, ""])

    def test_a_terminal_shows_a_bar_of_what_takes_long(self):
        noise = np.random.default_rng(5).normal(0, 0.02, (15000, 3))
        write_xyz("in.xyz", *(ellipsoid(15000, center=(x, 0, 0)) + noise for x in (0, 9)))
        terminal, end = pty.openpty()
        words = ["in.xyz", "out.ply"]  # more than the half second without a bar on any machine
        said = b""
        with subprocess.Popen([program("reconstruction"), *words], stdout=end, stderr=subprocess.DEVNULL):
            os.close(end)
            try:
                while part := os.read(terminal, 4096):
                    said += part
            except OSError:  # its other end is closed
                os.close(terminal)
        self.assertRegex(said, rb"\r  part [12] of 2, \w+ +\[[#.]{24}\] +\d+ %  \d+ s, about \d+ s left")
        self.assertIn(b"cloud     noisy; points move", said)
        self.assertEqual(said.count(b"cloud "), 1)
        self.assertIn(b"\r\033[Kread", said)  # it does not stay


class PartsOption(ToolTest):
    """-parts and -min-points. 200 points of one ellipsoid, 300 of another and 60 of a plane are far from each other."""

    def setUp(self):
        super().setUp()
        self.small, self.large = ellipsoid(200), ellipsoid(300, center=(9, 0, 0))
        i, j = np.divmod(np.arange(60), 10)
        write_xyz("two.xyz", self.small, self.large)
        write_xyz("three.xyz", self.small, self.large, np.stack([0.3 * j, 0.3 * i, np.full(60, 20)], axis=1))

    def test_each_meshes_each_part_to_a_file_of_its_own(self):
        run("reconstruction", "two.xyz", "out_%03d.ply", "-parts", "each", "-sphere", "sphere_%03d.ply",
            "-json", "report.json")  # fmt: skip
        large, small = Mesh("out_000.ply"), Mesh("out_001.ply")
        self.same(large.points, self.large)
        self.same(small.points, self.small)
        self.check_sphere(large)
        self.same(Mesh("sphere_001.ply").triangles, small.triangles)
        report = read_json("report.json")
        self.check_entries(report, {"points": 500, "left_out": {"other_parts": []}})
        self.assertEqual(len(report["parts"]), 2)
        self.check_entries(report["parts"][0], {"points": 300, "output": "out_000.ply", "triangles": 596})
        self.assertGreater(report["parts"][0]["measures"]["box_min"][0], 7)

    def test_each_meshes_all_parts_to_one_file_and_names_those_that_it_cannot_mesh(self):
        words = "three.xyz", "out.ply", "-surface", "closed"
        done = call("reconstruction", *words, "-json", "report.json")
        self.assertEqual(done.returncode, 0)
        out, report = Mesh("out.ply"), read_json("report.json")
        self.assertEqual(len(out.triangles), 596 + 396)
        self.same(out.points, np.concatenate([self.large, self.small]))
        self.assertEqual(out.triangles[-396:].min(), 300)
        self.assertEqual([len(report["parts"]), len(report["left_out"]["other_parts"])], [2, 60])
        failure = "1 part (60 points) cannot be meshed"
        self.assertIn(failure, str(report["failures"]))
        self.assertIn(f"warning: {failure}", done.stderr)
        run("reconstruction", *words, "-strict", code=1)
        run("reconstruction", "three.xyz", "open.ply")
        self.assertEqual(len(Mesh("open.ply").points), 560)

    def test_one_sphere_is_that_of_the_largest(self):
        for output in ("out.ply", "out_%03d.ply"):
            said = run("reconstruction", "two.xyz", output, "-sphere", "s.ply", "-json", "r.json")
            self.assertIn("s.ply (the largest)", said)
            self.assertEqual(len(Mesh("s.ply").points), 300)
            self.assertEqual(len(read_json("r.json")["parts"]), 2)
        run("scan", "torus", "torus.xyz", "-points", 250)
        write_xyz("with_torus.xyz", np.loadtxt("torus.xyz"), self.large)
        run("reconstruction", "with_torus.xyz", "out_%03d.ply", "-sphere", "s.ply")  # the torus has none
        self.assertEqual(len(Mesh("s.ply").points), 300)

    def test_others_than_the_largest_are_left_out_in_every_tool(self):
        for words in (["largest"], ["each", "-min-points", 201]):
            run("reconstruction", "two.xyz", "out.ply", "-json", "r.json", "-parts", *words)
            self.same(Mesh("out.ply").points, self.large)
            self.assertEqual(len(read_json("r.json")["left_out"]["other_parts"]), 200)
        # Tools that make one surface take the largest, or all.
        for tool in ("remesh", "texture"):
            for topology, points in (("scan", 300), ("sphere", 500)):
                call(tool, "two.xyz", "out.ply", "-topology", topology, "-json", "r.json")
                self.assertEqual(read_json("r.json")["vertices"], points, tool)
        run("remesh", "two.xyz", "even.ply", "-parts", "each", code=2)
