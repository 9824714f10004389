#!/usr/bin/python3
"""-parts and -min-points: test_parts_option.py FOLDER_OF_THE_TOOLS"""

import pathlib
import unittest

import numpy as np
from tool_test import Mesh, ToolTest, call, ellipsoid, read_json, run, torus, write_xyz


class PartsOption(ToolTest):
    """200 points of one ellipsoid, 300 of another and 60 of a plane, far from each other."""

    def setUp(self):
        super().setUp()
        self.small, self.large = ellipsoid(200), ellipsoid(300, center=(9, 0, 0))
        i, j = np.divmod(np.arange(60), 10)
        write_xyz("two.xyz", self.small, self.large)
        write_xyz("three.xyz", self.small, self.large, np.stack([0.3 * j, 0.3 * i, np.full(60, 20)], axis=1))

    def same(self, values, others):
        self.assertTrue(np.array_equal(values, others))

    def test_each_meshes_each_part_to_a_file_of_its_own_as_if_it_were_alone(self):
        run("reconstruction", "two.xyz", "out_%03d.ply", "-parts", "each", "-sphere", "sphere_%03d.ply",
            "-json", "report.json")  # fmt: skip
        large, small = Mesh("out_000.ply"), Mesh("out_001.ply")
        self.same(large.points, self.large)
        self.same(small.points, self.small)
        self.check_sphere(large)
        self.same(Mesh("sphere_001.ply").triangles, small.triangles)
        write_xyz("alone.xyz", self.large)
        run("reconstruction", "alone.xyz", "alone.ply")
        self.assertTrue(pathlib.Path("out_000.ply").read_bytes() == pathlib.Path("alone.ply").read_bytes())
        report = read_json("report.json")
        self.check_entries(report, {"points": 500, "left_out": {"other_parts": []}})
        self.assertEqual(len(report["parts"]), 2)
        self.check_entries(report["parts"][0], {"points": 300, "output": "out_000.ply", "triangles": 596,
                                                "diagnosis": {"kind": "closed_genus0"}})  # fmt: skip
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

    def test_one_sphere_and_one_page_are_those_of_the_largest(self):
        for output in ("out.ply", "out_%03d.ply"):
            said = run("reconstruction", "two.xyz", output, "-sphere", "s.ply", "-json", "r.json")
            self.assertIn("s.ply (the largest)", said)
            self.assertEqual(len(Mesh("s.ply").points), 300)
            self.assertEqual(len(read_json("r.json")["parts"]), 2)
        write_xyz("with_torus.xyz", torus(24, 10, 0.8, 0.3), self.large)
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

    def test_eight_parts_share_one_time_limit(self):
        write_xyz("eight.xyz", *(ellipsoid(100, (1, 0.8, 0.6), (4 * part, 0, 0)) for part in range(8)))
        done = call("reconstruction", "eight.xyz", "out.ply", "-parts", "each", "-time-limit", 0, "-json", "r.json")
        self.assertEqual(done.returncode, 0)
        parts = ", ".join(f"part {part}" for part in range(1, 9))
        self.assertIn(f"{parts}: the time limit ended the work early", done.stderr)
        self.assertEqual(len(Mesh("out.ply").triangles), 8 * 196)
        self.assertEqual([part["is_out_of_time"] for part in read_json("r.json")["parts"]], 8 * [True])


if __name__ == "__main__":
    unittest.main()
