"""Tests of tools/draw.py, which is on PYTHONPATH. SPHERICAL_PARAM_TOOLS is the folder of the programs."""

import os
import pathlib
import subprocess
import tempfile
import unittest

import draw
import numpy as np

CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
TRIANGLES = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])


def ply(triangles, kind="ascii"):
    """The triangles as a file."""
    head = f"ply\nformat {kind} 1.0\nelement vertex 4\n" + "".join(f"property float {axis}\n" for axis in "xyz")
    head += f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    order = draw.ORDERS[kind]
    vertices, faces = np.array(CORNERS, f"{order or '<'}f4"), np.zeros(len(triangles), f"u1,3{order or '<'}i4")
    faces["f0"], faces["f1"] = 3, triangles
    if order:
        return head.encode() + vertices.tobytes() + faces.tobytes()
    rows = [*CORNERS, *((3, *corners) for corners in triangles)]
    return (head + "".join(" ".join(map(str, row)) + "\n" for row in rows)).encode()


class Draw(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def picture(self, *words):
        """The picture in numbers from 0 (black) to 1."""
        draw.main([str(self.folder / "out.png"), "--size=300x150", *map(str, words)])
        return np.asarray(draw.Image.open(self.folder / "out.png").convert("RGB")) / 255

    def drawn(self, data, *words):
        (self.folder / "file.ply").write_bytes(data)
        return self.picture(self.folder / "file.ply", *words)

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

    def test_each_order_of_bytes_gives_the_same_picture(self):
        first, *others = [self.drawn(ply(TRIANGLES, kind)) for kind in draw.ORDERS]
        self.assertLess(first[75, 150].max(), 0.99)  # the mesh, in the middle
        for other in others:
            self.assertTrue((other == first).all())

    def test_triangles_from_behind_have_another_colour_and_an_open_mesh_shows_its_front(self):
        def difference(*pictures):
            return np.abs(pictures[0] - pictures[1]).max()

        front = self.drawn(ply(TRIANGLES))
        self.assertLess(difference(self.drawn(ply(TRIANGLES), "--back"), front), 0.1)  # at the silhouette only
        self.assertGreater(difference(self.drawn(ply(TRIANGLES[:, ::-1]), "--back"), front), 0.2)
        for sheet in (TRIANGLES[3:], TRIANGLES[3:, ::-1]):
            self.assertEqual(difference(self.drawn(ply(sheet), "--back"), self.drawn(ply(sheet))), 0)


if __name__ == "__main__":
    unittest.main()
