"""Tests of tools/draw.py, which is on PYTHONPATH. SPHERICAL_PARAM_TOOLS is the folder of the programs."""

import contextlib
import io
import os
import pathlib
import struct
import subprocess
import tempfile
import unittest

import draw
import numpy as np

CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
TRIANGLES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
BINARY = b"".join(struct.pack("<3f", *corner) for corner in CORNERS)
TEXT = "".join("%g %g %g\n" % corner for corner in CORNERS).encode()
FACES = "element face 4\nproperty list uchar int vertex_indices\n"


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
            program = f"{os.environ['SPHERICAL_PARAM_TOOLS']}/pcl_spherical_param_{command[0]}"
            subprocess.run([program, *command[1:]], check=True, stdout=subprocess.DEVNULL)
        pixels = self.picture(scan, mesh, "--colors", scan)
        self.assertEqual(pixels.shape, (150, 300, 3))
        y, x = np.mgrid[:150, :300]
        far = np.hypot(x - 224.5, y - 74.5)
        self.assertLess(pixels[far < 68].min(axis=1).max(), 0.95)  # not white anywhere
        self.assertTrue((pixels[(far > 74) & (x >= 150)] == 1).all())
        points = pixels[50:100, 50:100].min(axis=2) < 0.95
        self.assertTrue(0.1 < points.mean() < 0.95)

    def test_each_order_of_bytes_gives_the_same_picture_and_what_is_no_point_none(self):
        # What pcl_pcd2ply adds to the points.
        camera = "element camera 1\n" + "".join(f"property float c{i}\n" for i in range(17))
        camera += "".join(f"property {kind}\n" for kind in ("int width", "int height", "float k1", "float k2"))
        # PCL's grid of an organized cloud: an empty list for a point that is missing.
        grid = "element range_grid 3\nproperty list uchar int vertex_indices\n"
        points = [
            cloud("ascii") + TEXT,
            cloud("ascii", camera) + TEXT + b"0 " * 17 + b"4 1 0 0\n",
            cloud("binary_little_endian", grid) + BINARY + struct.pack("<BiBBi", 1, 0, 0, 1, 2),
            cloud("ascii", count=5) + TEXT + b"nan 5 inf\n"]  # fmt: skip
        meshes = [cloud("ascii", FACES) + TEXT + "".join("3 %d %d %d\n" % t for t in TRIANGLES).encode()]
        for kind, order in (("binary_little_endian", "<"), ("binary_big_endian", ">")):
            data = b"".join(struct.pack(order + "3f", *corner) for corner in CORNERS)
            data += b"".join(struct.pack(order + "B3i", 3, *corners) for corners in TRIANGLES)
            meshes.append(cloud(kind, FACES) + data)
        for files in (points, meshes):
            first, *others = [self.picture(self.write("file.ply", data)) for data in files]
            self.assertLess(first.min(), 0.99)
            for other in others:
                self.assertTrue((other == first).all())
        self.assertLess(first[75, 150].max(), 0.99)  # the mesh, in the middle

    def test_triangles_from_behind_have_another_colour_and_an_open_mesh_shows_its_front(self):
        def drawn(triangles, *words):
            faces = b"".join(struct.pack("<B3i", 3, *corners) for corners in triangles)
            head = cloud("binary_little_endian", FACES.replace("4", str(len(triangles))))
            return self.picture(self.write("file.ply", head + BINARY + faces), *words)

        def difference(*pictures):
            return np.abs(pictures[0] - pictures[1]).max()

        inside_out, front = [t[::-1] for t in TRIANGLES], drawn(TRIANGLES)
        self.assertLess(difference(drawn(TRIANGLES, "--back"), front), 0.1)  # at the silhouette only
        self.assertGreater(difference(drawn(inside_out, "--back"), front), 0.2)
        for triangle in (TRIANGLES[3], TRIANGLES[3][::-1]):
            self.assertEqual(difference(drawn([triangle], "--back"), drawn([triangle])), 0)

    def test_the_picture_has_the_size_that_was_asked_for(self):
        good = self.write("good.ply", cloud("ascii") + TEXT)
        for width, height in ((340, 113), (57, 51)):
            self.assertEqual(self.picture(good, f"--size={width}x{height}").shape, (height, width, 3))

    def test_broken_files_give_cause_and_remedy_and_no_picture(self):
        whole = cloud("binary_little_endian") + BINARY
        for data in (b"", b"ply\n", b"solid\n", whole[:-1], whole[:40], cloud("ascii") + b"1 2 x",
                     cloud("ascii", count=10**18) + b"1 2 3", whole.replace(b"float z", b"quad z"),
                     whole.replace(b"float z", b"float w"), whole.replace(b"vertex 4", b"vertex -4"),
                     whole.replace(b"vertex 4", b"vertex 0"), whole.replace(b"1.0\n", b"\xff\n"),
                     cloud("ascii", FACES.replace("4", "1")) + TEXT + b"3 0 1 4"):  # fmt: skip
            with self.subTest(data[:200]):
                self.fails(self.write("broken.ply", data))
        self.fails(str(self.folder / "missing.ply"))
        self.fails(self.write("good.ply", whole), self.write("broken.ply", whole[:-1]))

    def test_wrong_options_are_a_wrong_command_line(self):
        good = self.write("good.ply", cloud("ascii") + TEXT)
        for words in (["--size=9"], ["--size=9x9"], ["--size=infx100"], ["--view=1"], ["--view=nan,1"], []):
            with self.subTest(words):
                self.assertEqual(self.draw(*([good] if words else []), *words)[0], 2)
