"""pcl_spherical_param_morph: frames, pairs and report."""

import os
import unittest

import numpy as np
from tool_test import Mesh, ToolTest, areas, ellipsoid, lengths, report_of, run, write, write_ply


class MorphTool(ToolTest):
    """Two clouds, each of one colour, in a.ply and b.ply."""

    def setUp(self):
        super().setUp()
        self.first, self.second = ellipsoid(300, (1.5, 1.1, 0.8)), ellipsoid(220, (0.7, 2, 0.9))
        write_ply("a.ply", self.first, colors=np.tile((200, 10, 0), (300, 1)))
        write_ply("b.ply", self.second, colors=np.tile((0, 10, 100), (220, 1)))

    def test_frames_lead_from_one_object_to_the_other(self):
        report = report_of("morph", "a.ply", "b.ply", "m.ply", "-frames", 5, "-check")
        frames = [Mesh(f"m_00{i}.ply") for i in range(5)]
        for frame in frames:
            self.check_sphere(frame)
            self.assertTrue(np.array_equal(frame.triangles, frames[0].triangles))
        self.assertEqual(len(os.listdir()), 7)  # with both clouds, nothing else
        self.check_all_in(self.first, frames[0].points)
        self.check_all_in(self.second, frames[4].points)
        off = frames[1].points - 0.75 * frames[0].points - 0.25 * frames[4].points
        self.assertLess(np.abs(off).max(), 1e-6)
        # Colours go along, rounded.
        self.assertTrue((frames[2]["red green blue"] == (100, 10, 50)).all())
        self.check_entries(report, {
            "frames": 5, "closed": True, "manifold": True, "genus": 0, "self_intersections": [0, 0, 0, 0, 0],
            "pairs": {"given": 0}, "vertices": len(frames[0].points), "triangles": len(frames[0].triangles),
        })  # fmt: skip
        self.assertEqual(report["files"][3], "m_003.ply")
        self.assertGreater(report["alignment_error"], 0)
        self.assertEqual(len(report["rotation"]), 3)

    def test_pairs_are_honoured_or_said_to_be_impossible(self):
        # The last points are the first one again, and one that is left out.
        write_ply("a.ply", np.concatenate([self.first, self.first[:1], [(9, 9, 9)]]))
        corner = lengths(self.first - (9, 8, 9)).argmin()
        other = round(corner * 220 / 300)
        near_first, near_second, exact = (" ".join(map(str, place)) for place in (
            self.first[150] + (0.01, 0, -0.01), self.second[112] + (0.01, 0, -0.01), self.second[other]))  # fmt: skip
        write("pairs.txt", f"# the top, then the bottom\n10 12\n\n  300, 1 # a repeated one\n299 219\n"
              f"{near_first} ; {near_second}\r\n9 8 9 {exact}\n10 40\n301 5\n0 7")  # fmt: skip
        report = report_of("morph", "a.ply", "b.ply", "m.ply", "-frames", 2, "-pairs", "pairs.txt", "-outliers", 6)
        report = report["pairs"]
        self.check_entries(report, {"given": 8, "honoured": 5})
        self.assertEqual([(pair["line"], pair["points"]) for pair in report["impossible"]],
                         [(8, [10, 40]), (9, [301, 5]), (10, [0, 7])])  # fmt: skip
        self.assertLess(report["worst_pair"], 1e-9)
        for one, two in ((10, 12), (0, 1), (299, 219), (150, 112), (corner, other)):
            at = lengths(Mesh("m_000.ply").points - self.first[one]).argmin()
            self.assertTrue((Mesh("m_001.ply").points[at] == self.second[two]).all())

    def test_resampled_frames_match_in_area_and_have_the_names_of_the_pattern(self):
        said = run("morph", "a.ply", "b.ply", "m%02d.ply", "-frames", 3, "-connectivity", "resampled", "-samples", 642,
                   "-match", "-align", "none", "-verbose")  # fmt: skip
        self.assertIn("align               none\n", said)
        frames = [Mesh(f"m0{i}.ply") for i in range(3)]
        for frame in frames:
            self.assertEqual(len(frame.points), 642)
            self.check_sphere(frame)
        first, _, last = (areas(frame.points, frame.triangles).sum() for frame in frames)
        self.assertAlmostEqual(last / first, 1, delta=0.05)
