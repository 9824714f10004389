"""Tests of the peers that were built: each makes a mesh that the referee can read, and says how."""

import argparse
import json
import pathlib
import sys
import tempfile
import unittest

from . import comparison
from .processes import run
from .product import Programs

programs = None


class Peers(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.found, _ = comparison.peers(programs)

    def test_pcl_is_always_there(self):
        labels = [label for label, _, _ in self.found]
        self.assertEqual(len(labels), len(set(labels)))
        self.assertGreaterEqual(sum("PCL" in label for label in labels), 2, labels)

    def test_each_makes_a_surface_near_the_truth(self):
        cloud = programs.make_scan("ellipsoid_1500", self.folder)
        for label, program, method in self.found:
            with self.subTest(method=label):
                mesh = self.folder / "mesh.ply"
                result = run([program, method, cloud.points, mesh], timeout=100)
                self.assertTrue(result.good, result.errors)
                report = json.loads(result.output)
                self.assertEqual(report["points"], 1500)
                self.assertTrue(report["parameters"])
                self.assertLess(sum(report["seconds"].values()), result.seconds)
                self.assertGreater(report["peak_memory_bytes"], 1 << 20)
                quality = programs.measure(mesh, cloud)
                self.assertEqual(report["triangles"], quality["triangles"])
                self.assertLess(quality["rms_percent"], 2.0)

    def test_bad_input_has_cause_and_remedy_and_leaves_no_file(self):
        mesh = self.folder / "mesh.ply"
        cloud = self.folder / "three.xyz"
        cloud.write_text("0 0 0\n1 0 0\n0 1 0\n")
        for _, program, method in self.found:
            for words, code in (
                ((method, self.folder / "missing.ply", mesh), 1),
                ((method, cloud, mesh), 1),
                (("no_such_method", cloud, mesh), 2),
            ):
                with self.subTest(words=words):
                    result = run([program, *words])
                    self.assertEqual(result.exit_code, code)
                    self.assertEqual(len(result.errors.strip().splitlines()), 2, result.errors)
                    self.assertFalse(mesh.exists())


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("programs", type=pathlib.Path)
    arguments, rest = parser.parse_known_args()
    programs = Programs(arguments.programs)
    unittest.main(argv=[sys.argv[0], *rest])
