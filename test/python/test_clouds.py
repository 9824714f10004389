"""What reconstruct() takes besides an array, with colours and normals."""

import types
import unittest
from importlib import util

import numpy as np
import shapes
import spherical_param as sp


class Clouds(shapes.InFolder):
    @classmethod
    def setUpClass(cls):
        cls.points = shapes.ellipsoid(300).astype(np.float32).astype(float)
        cls.colors = shapes.colors_of(cls.points)
        cls.packed = cls.colors.astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], np.uint32)
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

    def test_files_are_read_with_what_they_have(self):
        source = sp.reconstruct(shapes.record(self.points, self.colors, self.normals))
        for name in ("a.ply", "a.obj"):
            with self.subTest(name):
                source.write(self.folder / name)
                self.check(self.folder / name, atol=1e-6)
        np.savetxt(self.folder / "a.xyz", self.points, fmt="%.17g")
        self.check(str(self.folder / "a.xyz"), colors=False, normals=False)
        (self.folder / "broken.ply").write_text("ply\nnothing\n")
        for name, cause in (("missing.pcd", "No such file"), ("broken.ply", "broken.ply.*; ")):
            with self.assertRaisesRegex(OSError, cause):
                sp.reconstruct(self.folder / name)
        with self.assertRaisesRegex(sp.InvalidInput, "; use one of .pcd .ply"):
            sp.find_parts(self.folder / "scan.docx")

    def test_columns_of_text_have_names_and_scalars_come_along(self):
        file, intensity = self.folder / "a.csv", np.arange(300) + 0.5
        rows = np.column_stack([self.points, intensity, self.colors])
        np.savetxt(file, rows, delimiter=";")
        self.check(file, normals=False)
        sp.reconstruct(file, parts="each").write(self.folder / "a.ply")
        again = sp.reconstruct(self.folder / "a.ply")
        np.testing.assert_array_equal(again._export_scalars()["intensity"], intensity)
        plain = sp.reconstruct(file, columns="x,y,z,time")
        self.assertIsNone(plain.colors)
        self.assertEqual([*plain._export_scalars()], ["time"])
        for cloud, columns, cause in ((file, "x,y", "no x, y and z"), (self.points, "x,y,z", "columns are of a file")):
            with self.assertRaisesRegex(sp.InvalidInput, cause):
                sp.reconstruct(cloud, columns=columns)

    def test_coordinates_too_large_for_a_format_are_written_less_an_offset(self):
        far = sp.reconstruct(self.points + [500000, 5400000, 0])
        for name, given, offset in (("a.ply", None, (0, 0, 0)), ("a.glb", None, (500000, 5400000, 0)),
                                    ("b.ply", (1, 2, 3), (1, 2, 3))):  # fmt: skip
            self.assertEqual(far.write(self.folder / name, offset=given), offset)
        moved = sp.reconstruct(self.folder / "b.ply").vertices
        np.testing.assert_allclose(moved, far.vertices - [1, 2, 3], rtol=0, atol=1e-8)

    def test_surfaces_face_as_normals_do_or_the_sensor(self):
        self.assertEqual(self.expected.faced_by, "outward")
        inward = sp.reconstruct(shapes.record(self.points, self.colors, -self.normals))
        self.assertEqual(inward.faced_by, "normals")
        self.assertLess(inward.measures.volume, 0)
        bowl = shapes.ellipsoid(1200)
        bowl = bowl[bowl[:, 2] > 0]
        header = f"FIELDS x y z\nWIDTH {len(bowl)}\nVIEWPOINT 0 0 9 1 0 0 0\nDATA ascii"
        np.savetxt(self.folder / "a.pcd", bowl, header=header, comments="")
        self.assertEqual(sp.reconstruct(self.folder / "a.pcd").faced_by, "viewpoint")

    def test_rows_in_no_face_of_a_file_are_left_out(self):
        file = self.folder / "a.ply"
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
        for colors in (self.packed, self.packed.view(np.float32)):
            self.check(shapes.structured(**dict(zip("xyz", self.points.T)), rgb=colors), normals=False)
        self.check(shapes.record(self.points, self.colors / 255.0), normals=False)
        for wrong in (self.colors.astype(int) - 1, self.colors / 100.0):
            with self.assertRaisesRegex(sp.InvalidInput, "colours of .* out of range; give int"):
                sp.reconstruct(shapes.record(self.points, wrong))
        # Of vertices with several points, that of the first.
        twice = sp.reconstruct(source[np.repeat(np.arange(300), 2)])
        np.testing.assert_array_equal(twice.colors, self.colors)

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

    def test_clouds_of_trimesh_are_taken_by_their_attributes(self):
        # What they have in trimesh 4, which Debian 12 does not have.
        visual = types.SimpleNamespace(kind="vertex", vertex_colors=np.insert(self.colors, 3, 255, axis=1))
        for attributes in ({}, {"visual": visual}):
            cloud = type("PointCloud", (), {"__module__": "trimesh.points"})()
            vars(cloud).update(vertices=self.points, **attributes)
            self.check(cloud, colors=bool(attributes), normals=False)
