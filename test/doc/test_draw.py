"""Tests of tools/draw.py, which is on PYTHONPATH. SPHERICAL_PARAM_TOOLS is the folder of the programs."""

import os
import pathlib
import subprocess
import tempfile
import unittest

import draw
import meshio
import numpy as np

CORNERS = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], float)
TRIANGLES = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])


class Draw(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def picture(self, *words):
        """The picture in numbers from 0 (black) to 1."""
        draw.main([str(self.folder / "out.png"), "--size=300x150", *map(str, words)])
        return np.asarray(draw.Image.open(self.folder / "out.png").convert("RGB")) / 255

    def test_a_mesh_of_the_tool_fills_its_view_without_seams(self):
        scan, mesh = self.folder / "scan.ply", self.folder / "mesh.ply"
        for tool, *words in (["scan", "sphere", scan, "-points", "2000"], ["reconstruction", scan, mesh]):
            program = f"{os.environ['SPHERICAL_PARAM_TOOLS']}/pcl_spherical_param_{tool}"
            subprocess.run([program, *words], check=True, stdout=subprocess.DEVNULL)
        pixels = self.picture(scan, mesh, "--colors", scan)
        self.assertEqual(pixels.shape, (150, 300, 3))
        y, x = np.mgrid[:150, :300]
        far = np.hypot(x - 224.5, y - 74.5)
        self.assertLess(pixels[far < 68].min(axis=1).max(), 0.95)  # not white anywhere
        self.assertGreater(pixels[(far > 74) & (x >= 150)].min(), 0.8)  # white, but for the dithering
        points = pixels[50:100, 50:100].min(axis=2) < 0.95
        self.assertTrue(0.1 < points.mean() < 0.95)

    def test_triangles_from_behind_have_another_colour(self):
        pictures = []
        for triangles in (TRIANGLES, TRIANGLES[:, ::-1]):
            meshio.Mesh(CORNERS, [("triangle", triangles)]).write(self.folder / "file.ply")
            pictures.append(self.picture(self.folder / "file.ply", "--back"))
        self.assertGreater(np.abs(pictures[0] - pictures[1]).max(), 0.2)


if __name__ == "__main__":
    unittest.main()
