#!/usr/bin/python3
"""Tests of tools/draw.py: test_draw.py FOLDER_OF_THE_TOOLS"""

import contextlib
import io
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

import numpy as np

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
import draw  # noqa: E402

TOOLS = pathlib.Path(sys.argv.pop()).resolve()
CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
# What pcl_pcd2ply adds to the points.
CAMERA = ["view_px", "view_py", "view_pz", "x_axisx", "x_axisy", "x_axisz", "y_axisx", "y_axisy", "y_axisz",
          "z_axisx", "z_axisy", "z_axisz", "focal", "scalex", "scaley", "centerx", "centery"]  # fmt: skip
CAMERA_HEADER = ("element camera 1\n" + "".join(f"property float {name}\n" for name in CAMERA)
                 + "property int viewportx\nproperty int viewporty\nproperty float k1\nproperty float k2\n")  # fmt: skip


def cloud(kind, extra="", count=4):
    return (f"ply\nformat {kind} 1.0\ncomment any\nelement vertex {count}\nproperty float x\nproperty float y\n"
            f"property float z\n{extra}end_header\n").encode()  # fmt: skip


class Draw(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def draw(self, *words):
        """The exit code, and what was said: sys.exit() with a text prints it and ends with 1."""
        said = io.StringIO()
        try:
            with contextlib.redirect_stderr(said):
                draw.main([str(self.folder / "out.png"), "--size=300x150", *words])
        except SystemExit as end:
            return (1, end.code) if isinstance(end.code, str) else (end.code, said.getvalue())
        return 0, said.getvalue()

    def write(self, name, data):
        (self.folder / name).write_bytes(data)
        return str(self.folder / name)

    def picture(self, *words):
        """The picture in numbers from 0 (black) to 1."""
        self.assertEqual(self.draw(*words), (0, ""))
        return draw.image.imread(self.folder / "out.png")[:, :, :3]

    def fails(self, *words):
        code, said = self.draw(*words)
        self.assertEqual((code, len(said.splitlines())), (1, 2), said)
        self.assertEqual([path.name for path in self.folder.glob("out.png*")], [])

    def test_a_mesh_of_the_tool_fills_its_view_without_seams(self):
        scan, mesh = str(self.folder / "scan.ply"), str(self.folder / "mesh.ply")
        for command in (["scan", "sphere", scan, "-points", "2000"], ["reconstruction", scan, mesh]):
            subprocess.run([f"{TOOLS}/pcl_spherical_param_{command[0]}", *command[1:]], check=True,
                           stdout=subprocess.DEVNULL)  # fmt: skip
        pixels = self.picture(scan, mesh, "--colors", scan)
        self.assertEqual(pixels.shape, (150, 300, 3))
        y, x = np.mgrid[:150, :300]
        far = np.hypot(x - 224.5, y - 74.5)
        self.assertLess(pixels[far < 68].min(axis=1).max(), 0.95)  # not white anywhere
        self.assertTrue((pixels[(far > 74) & (x >= 150)] == 1).all())
        points = pixels[50:100, 50:100].min(axis=2) < 0.95
        self.assertTrue(0.1 < points.mean() < 0.95)

    def test_text_and_both_orders_of_bytes_give_the_same_picture(self):
        faces = "element face 4\nproperty list uchar int vertex_indices\n"
        triangles = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
        pictures = []
        for kind, order in (("binary_little_endian", "<"), ("binary_big_endian", ">")):
            data = b"".join(struct.pack(order + "3f", *corner) for corner in CORNERS)
            data += b"".join(struct.pack(order + "B3i", 3, *corners) for corners in triangles)
            pictures.append(self.picture(self.write("mesh.ply", cloud(kind, faces) + data)))
        text = "".join("%g %g %g\n" % corner for corner in CORNERS) + "".join("3 %d %d %d\n" % t for t in triangles)
        pictures.append(self.picture(self.write("mesh.ply", cloud("ascii", faces) + text.encode())))
        self.assertTrue((pictures[0] == pictures[1]).all() and (pictures[0] == pictures[2]).all())
        self.assertLess(pictures[0][75, 150].max(), 0.99)

    def test_other_elements_are_skipped(self):
        points = "".join("%g %g %g\n" % corner for corner in CORNERS)
        plain = self.picture(self.write("cloud.ply", cloud("ascii") + points.encode()))
        camera = " ".join(["0"] * 17 + ["4 1 0 0"]) + "\n"
        data = cloud("ascii", CAMERA_HEADER) + (points + camera).encode()
        self.assertTrue((self.picture(self.write("cloud.ply", data)) == plain).all())
        # PCL's grid of an organized cloud: an empty list for a point that is missing.
        grid = "element range_grid 3\nproperty list uchar int vertex_indices\n"
        data = cloud("binary_little_endian", grid) + b"".join(struct.pack("<3f", *corner) for corner in CORNERS)
        data += struct.pack("<BiBBi", 1, 0, 0, 1, 2)
        self.assertTrue((self.picture(self.write("cloud.ply", data)) == plain).all())

    def test_the_picture_has_the_size_that_was_asked_for(self):
        for width, height in ((340, 113), (57, 51)):
            good = self.write("good.ply", cloud("ascii") + b"0 0 0 1 0 0 0 1 0 0 0 1")
            self.assertEqual(self.picture(good, f"--size={width}x{height}").shape, (height, width, 3))

    def test_points_that_are_not_finite_are_left_out(self):
        points = "".join("%g %g %g\n" % corner for corner in CORNERS)
        plain = self.picture(self.write("cloud.ply", cloud("ascii") + points.encode()))
        data = cloud("ascii", count=5) + (points + "nan 5 inf\n").encode()
        self.assertTrue((self.picture(self.write("cloud.ply", data)) == plain).all())

    def test_broken_files_give_cause_and_remedy_and_no_picture(self):
        whole = cloud("binary_little_endian") + b"".join(struct.pack("<3f", *corner) for corner in CORNERS)
        face = cloud("ascii", "element face 1\nproperty list uchar int vertex_indices\n")
        for data in (b"", b"ply\n", b"solid\n", whole[:-1], whole[:40], cloud("ascii") + b"1 2 x",
                     cloud("ascii", count=10**18) + b"1 2 3", whole.replace(b"float z", b"quad z"),
                     whole.replace(b"float z", b"float w"), whole.replace(b"vertex 4", b"vertex -4"),
                     whole.replace(b"vertex 4", b"vertex 0"), whole.replace(b"1.0\n", b"\xff\n"),
                     face + b"0 0 0 1 0 0 0 1 0 0 0 1 3 0 1 4"):  # fmt: skip
            with self.subTest(data[:200]):
                self.fails(self.write("broken.ply", data))
        self.fails(str(self.folder / "missing.ply"))
        self.fails(self.write("good.ply", whole), self.write("broken.ply", whole[:-1]))

    def test_wrong_options_are_a_wrong_command_line(self):
        good = self.write("good.ply", cloud("ascii") + b"0 0 0 1 0 0 0 1 0 0 0 1")
        for words in (["--size=9"], ["--size=9x9"], ["--size=infx100"], ["--view=1"], ["--view=nan,1"],
                      ["--focus=1,2"], ["--zoom=0"], ["--zoom=nan"], []):  # fmt: skip
            with self.subTest(words), contextlib.redirect_stderr(io.StringIO()):
                with self.assertRaises(SystemExit) as end:
                    draw.main([str(self.folder / "out.png"), *([good] if words else []), *words])
                self.assertEqual(end.exception.code, 2)


if __name__ == "__main__":
    unittest.main()
