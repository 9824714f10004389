"""What reconstruct() takes besides an array, with colours and normals."""

import tempfile
import types
import unittest
from importlib import util
from pathlib import Path

import numpy as np
import shapes
import spherical_param as sp


class Clouds(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.points = shapes.ellipsoid(300).astype(np.float32).astype(float)
        cls.colors = shapes.colors_of(cls.points)
        cls.normals = (cls.points / [1.0, 4.0, 0.49]).astype(np.float32).astype(float)
        cls.normals /= np.linalg.norm(cls.normals, axis=1, keepdims=True)
        cls.expected = sp.reconstruct(cls.points)

    def check(self, cloud, colors=True, normals=True, atol=0.0):
        mesh = sp.reconstruct(cloud)
        self.assertEqual(mesh.triangles.tobytes(), self.expected.triangles.tobytes())
        np.testing.assert_allclose(mesh.vertices, self.points, rtol=0, atol=atol / 100)
        if colors:
            np.testing.assert_array_equal(mesh.colors, self.colors)
            self.assertEqual(mesh.colors.dtype, np.uint8)
        else:
            self.assertIsNone(mesh.colors)
        own = self.normals if normals else self.expected.normals
        np.testing.assert_allclose(mesh.normals, own, rtol=0, atol=atol)

    def test_files_of_every_format_are_read(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            source = shapes.record(self.points, self.colors, self.normals)
            sp.reconstruct(source).write(folder / "a.ply")
            sp.reconstruct(source).write(folder / "a.obj")
            np.savetxt(folder / "a.xyz", self.points, fmt="%.17g")
            header = (
                "VERSION 0.7\nFIELDS x y z rgb normal_x normal_y normal_z\nSIZE 4 4 4 4 4 4 4\n"
                "TYPE F F F U F F F\nCOUNT 1 1 1 1 1 1 1\nWIDTH 300\nHEIGHT 1\n"
                "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 300\nDATA ascii"
            )
            packed = self.colors.astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], np.uint32)
            rows = np.column_stack([self.points, packed, self.normals])
            form = ["%.9g"] * 3 + ["%d"] + ["%.9g"] * 3
            np.savetxt(folder / "a.pcd", rows, fmt=form, header=header, comments="")
            for file in ("a.ply", "a.obj", "a.pcd"):
                with self.subTest(file):
                    self.check(folder / file, atol=1e-6)
            self.check(str(folder / "a.xyz"), colors=False, normals=False)
            (folder / "broken.ply").write_text("ply\nnothing\n")
            for file, cause in (("missing.pcd", "No such file"), ("broken.ply", "broken.ply.*; ")):
                with self.assertRaisesRegex(OSError, cause):
                    sp.reconstruct(folder / file)
            with self.assertRaisesRegex(sp.InvalidInput, "; use one of .pcd .ply"):
                sp.find_parts(folder / "scan.docx")

    def test_columns_of_text_have_names_and_scalars_come_along(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            intensity = np.arange(300) + 0.5
            np.savetxt(
                folder / "a.csv",
                np.column_stack([self.points, intensity, self.colors]),
                delimiter=";",
            )
            self.check(folder / "a.csv", normals=False)
            sp.reconstruct(folder / "a.csv").write(folder / "a.ply")
            again = sp.reconstruct(folder / "a.ply")
            np.testing.assert_array_equal(again._export_scalars()["intensity"], intensity)
            plain = sp.reconstruct(folder / "a.csv", columns="x,y,z,time")
            self.assertIsNone(plain.colors)
            self.assertEqual([*plain._export_scalars()], ["time"])
            with self.assertRaisesRegex(sp.InvalidInput, "no x, y and z"):
                sp.reconstruct(folder / "a.csv", columns="x,y")
            with self.assertRaisesRegex(sp.InvalidInput, "columns are of a file"):
                sp.reconstruct(self.points, columns="x,y,z")

    def test_coordinates_too_large_for_a_format_are_written_less_an_offset(self):
        far = sp.reconstruct(self.points + [500000, 5400000, 0])
        with tempfile.TemporaryDirectory() as name:
            self.assertEqual(far.write(Path(name, "a.ply")), (0, 0, 0))
            self.assertEqual(far.write(Path(name, "a.glb")), (500000, 5400000, 0))
            self.assertEqual(far.write(Path(name, "b.ply"), offset=(1, 2, 3)), (1, 2, 3))

    def test_surfaces_face_as_normals_do_or_the_sensor(self):
        self.assertEqual(self.expected.faced_by, "outward")
        inward = sp.reconstruct(shapes.record(self.points, self.colors, -self.normals))
        self.assertEqual(inward.faced_by, "normals")
        self.assertLess(inward.measures.volume, 0)
        with tempfile.TemporaryDirectory() as name:
            file = Path(name, "a.pcd")
            bowl = shapes.ellipsoid(1200)
            bowl = bowl[bowl[:, 2] > 0]
            header = (
                f"FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH {len(bowl)}\nHEIGHT 1\n"
                f"VIEWPOINT 0 0 9 1 0 0 0\nPOINTS {len(bowl)}\nDATA ascii"
            )
            np.savetxt(file, bowl, header=header, comments="")
            self.assertEqual(sp.reconstruct(file).faced_by, "viewpoint")

    def test_rows_in_no_face_of_a_file_are_left_out(self):
        with tempfile.TemporaryDirectory() as name:
            file = Path(name, "a.ply")
            self.expected.write(file)
            content = file.read_bytes().replace(b"element vertex 300", b"element vertex 301", 1)
            end = content.index(b"end_header\n") + len(b"end_header\n")
            row = content[end : end + 24]  # with its normal
            file.write_bytes(content[:end] + row + content[end:])
            left_out = sp.reconstruct(file).left_out
            self.assertEqual((len(left_out.unused), len(left_out.not_finite)), (1, 0))

    def test_structured_arrays_have_their_fields_by_many_names(self):
        source = shapes.record(self.points, self.colors, self.normals)
        self.check(source)
        self.check(source.reshape(10, 30))
        self.check(source[["x", "z", "y"]], colors=False, normals=False)
        renamed = source.copy()
        renamed.dtype.names = ("x", "y", "z", "r", "g", "b", "normal_x", "normal_y", "normal_z")
        self.check(renamed)
        packed = self.colors.astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], np.uint32)
        for colors in (packed, packed.view(np.float32)):
            cloud = np.zeros(300, dtype=[(n, "f8") for n in "xyz"] + [("rgb", colors.dtype)])
            for name, column in zip(("x", "y", "z", "rgb"), (*self.points.T, colors)):
                cloud[name] = column
            self.check(cloud, normals=False)
        self.check(shapes.record(self.points, self.colors / 255.0), normals=False)
        for wrong in (self.colors.astype(int) - 1, self.colors / 100.0):
            with self.assertRaisesRegex(sp.InvalidInput, "colours of .* out of range; give int"):
                sp.reconstruct(shapes.record(self.points, wrong))

    @unittest.skipUnless(util.find_spec("open3d"), "Open3D is not installed")
    def test_clouds_and_meshes_of_open3d_are_taken(self):
        import open3d

        vectors = open3d.utility.Vector3dVector
        cloud = open3d.geometry.PointCloud(vectors(self.points))
        self.check(cloud, colors=False, normals=False)
        cloud.colors, cloud.normals = vectors(self.colors / 255), vectors(self.normals)
        self.check(cloud, atol=1e-12)
        self.check(open3d.t.geometry.PointCloud.from_legacy(cloud), atol=1e-6)
        self.check(self.expected.to_open3d(), colors=False, atol=1e-12, normals=False)
        with self.assertRaisesRegex(sp.InvalidInput, "; give a point cloud"):
            sp.reconstruct(open3d.geometry.Image())

    @unittest.skipUnless(util.find_spec("trimesh"), "trimesh is not installed")
    def test_clouds_and_meshes_of_trimesh_are_taken(self):
        import trimesh

        self.check(trimesh.PointCloud(self.points), colors=False, normals=False)
        self.check(trimesh.PointCloud(self.points, colors=self.colors), normals=False)
        self.check(self.expected.to_trimesh(), colors=False, normals=False)
        self.check(sp.reconstruct(shapes.record(self.points, self.colors)).to_trimesh(),
                   normals=False)  # fmt: skip

    def test_clouds_of_trimesh_are_taken_by_their_attributes(self):
        # What they have in trimesh 4, which Debian 12 does not have.
        visual = types.SimpleNamespace(
            kind="vertex", vertex_colors=np.insert(self.colors, 3, 255, axis=1)
        )
        for attributes in ({}, {"visual": visual}):
            cloud = type("PointCloud", (), {"__module__": "trimesh.points"})()
            vars(cloud).update(vertices=self.points, **attributes)
            self.check(cloud, colors=bool(attributes), normals=False)

    def test_normals_of_the_mesh_point_outward_and_colors_follow_the_vertices(self):
        truth = self.normals
        self.assertGreater((self.expected.normals * truth).sum(axis=1).min(), 0.9)
        np.testing.assert_allclose(np.linalg.norm(self.expected.normals, axis=1), 1, atol=1e-12)
        twice = shapes.record(self.points, self.colors)[np.repeat(np.arange(300), 2)]
        np.testing.assert_array_equal(sp.reconstruct(twice).colors, self.colors)
        new = sp.remesh(sp.reconstruct(twice), points=642)
        self.assertLess(np.abs(shapes.colors_of(new.vertices) - new.colors.astype(float)).mean(), 9)


if __name__ == "__main__":
    unittest.main()
