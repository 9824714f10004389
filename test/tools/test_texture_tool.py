"""pcl_spherical_param_texture: its formats, taken apart without the tools."""

import io
import json
import os
import pathlib
import struct
import unittest

import numpy as np
from matplotlib import image as images
from tool_test import Mesh, ToolTest, ellipsoid, lengths, report_of, run, single, volume, write_ply


def decode(png):
    """The pixels (height, width, 3), the highest row first."""
    image = np.round(255 * images.imread(io.BytesIO(png)))
    assert image.shape[2] == 3
    return image


def colors_of(points):
    """Colours that change slowly over an object of about this size."""
    return np.round(127 + 110 * points)


def cloud():
    """An ellipsoid with a bump."""
    points = ellipsoid(700, (0.9, 0.6, 0.7))
    points[:, 2] *= 1 + 0.3 * np.exp(-8 * (1 - points[:, 2] / 0.7) ** 2)
    return single(points)


class Textured:
    """What a file has in it. v is up."""

    def __init__(self, points, normals, coordinates, triangles, coordinate_triangles=None):
        self.points, self.normals, self.coordinates, self.triangles = points, normals, coordinates, triangles
        self.coordinate_triangles = triangles if coordinate_triangles is None else coordinate_triangles

    def worst_color(self, image):
        """The largest error of a colour where the image has a corner of a triangle."""
        height, width, _ = image.shape
        u, v = self.coordinates[self.coordinate_triangles.ravel()].T
        row = height - 1 - np.clip((v * height).astype(int), 0, height - 1)
        pixels = image[row, np.clip((u * width).astype(int), 0, width - 1)]
        return np.abs(pixels - colors_of(self.points)[self.triangles.ravel()]).max()


def parse_glb(name):
    """The mesh, the bytes of the image and the sampler of a binary glTF file, checked by the specification."""
    data = pathlib.Path(name).read_bytes()
    magic, version, size, json_size, kind = struct.unpack_from("<4sIII4s", data)
    assert (magic, version, size, json_size % 4, kind) == (b"glTF", 2, len(data), 0, b"JSON")
    parts = json.loads(data[20 : 20 + json_size])
    size, kind = struct.unpack_from("<I4s", data, 20 + json_size)
    buffer = data[28 + json_size :]
    assert (size, size % 4, kind) == (len(buffer), 0, b"BIN\0")
    assert (parts["asset"]["version"], parts["buffers"][0]["byteLength"]) == ("2.0", size)
    views, end = [], 0
    for view in parts["bufferViews"]:
        assert view["byteOffset"] % 4 == 0 and view["byteOffset"] >= end
        end = view["byteOffset"] + view["byteLength"]
        views.append(buffer[view["byteOffset"] : end])
    assert end <= size

    def rows(index, kind, component):
        accessor = parts["accessors"][index]
        assert (accessor["type"], accessor["componentType"]) == (kind, component)
        values = np.frombuffer(views[accessor["bufferView"]], {5126: "<f4", 5125: "<i4"}[component])
        values = values.reshape(-1, {"VEC3": 3, "VEC2": 2, "SCALAR": 1}[kind])
        assert len(values) == accessor["count"]
        if "min" in accessor:
            assert (np.array(accessor["min"], values.dtype) == values.min(axis=0)).all()
            assert (np.array(accessor["max"], values.dtype) == values.max(axis=0)).all()
        return values.astype(float if component == 5126 else int)

    primitive = parts["meshes"][parts["nodes"][parts["scenes"][0]["nodes"][0]]["mesh"]]["primitives"][0]
    attributes = primitive["attributes"]
    assert "max" in parts["accessors"][attributes["POSITION"]]
    points, normals = (rows(attributes[name], "VEC3", 5126) for name in ("POSITION", "NORMAL"))
    places = rows(attributes["TEXCOORD_0"], "VEC2", 5126) * (1, -1) + (0, 1)
    mesh = Textured(points, normals, places, rows(primitive["indices"], "SCALAR", 5125).reshape(-1, 3))
    material = parts["materials"][primitive["material"]]
    assert material["doubleSided"] is False
    roughness = material["pbrMetallicRoughness"]
    assert (roughness["metallicFactor"], roughness["roughnessFactor"]) == (0, 1)
    texture = parts["textures"][roughness["baseColorTexture"]["index"]]
    image = parts["images"][texture["source"]]
    assert image["mimeType"] == "image/png"
    return mesh, views[image["bufferView"]], parts["samplers"][texture["sampler"]]


def parse_obj(name):
    """The mesh and the name of its material."""
    lines = [line.split() for line in pathlib.Path(name).read_text().splitlines()]
    points, normals, places = (np.array([line[1:] for line in lines if line[0] == kind], float)
                               for kind in ("v", "vn", "vt"))  # fmt: skip
    corners = [[corner.split("/") for corner in line[1:]] for line in lines if line[0] == "f"]
    vertex, place, normal = np.array(corners, int).transpose(2, 0, 1) - 1
    assert (vertex == normal).all()
    material = next(line[1] for line in lines if line[0] == "mtllib")
    return Textured(single(points), normals, places, vertex, place), material


class TextureTool(ToolTest):
    def setUp(self):
        super().setUp()
        write_ply("in.ply", cloud(), colors=colors_of(cloud()))
        write_ply("plain.ply", cloud())

    def check_textured(self, mesh, image, largest_error):
        self.assertAlmostEqual(volume(mesh.points, mesh.triangles), self.volume, delta=1e-6)
        self.assertEqual(mesh.triangles.shape, mesh.coordinate_triangles.shape)
        self.assertEqual(mesh.points.shape, mesh.normals.shape)
        self.assertLess(np.abs(lengths(mesh.normals) - 1).max(), 1e-5)
        self.assertTrue(0 <= mesh.coordinates.min() and mesh.coordinates.max() <= 1)
        # All points of the cloud are there, and the image has their colours.
        self.check_all_in(cloud(), mesh.points)
        self.assertLessEqual(mesh.worst_color(image), largest_error)

    def test_all_formats_hold_the_closed_mesh_and_the_colours_of_the_points(self):
        run("reconstruction", "in.ply", "mesh.ply")
        self.volume = volume(Mesh("mesh.ply").points, Mesh("mesh.ply").triangles)
        # Half of a pixel of 512 is up to 0.01 of the object on its side in the image.
        for chart, width, error in (("equirectangular", 1024, 6), ("octahedral", 512, 6), ("cube", 768, 8)):
            with self.subTest(chart):
                options = "-chart", chart, "-size", 512, "-quiet"
                run("texture", "in.ply", "out.glb", *options)
                glb, png, sampler = parse_glb("out.glb")
                image = decode(png)
                self.assertEqual(image.shape, (512, width, 3))
                self.check_textured(glb, image, error)
                around = 10497 if chart == "equirectangular" else 33071
                self.check_entries(sampler, {"wrapS": around, "wrapT": 33071})

                run("texture", "in.ply", "out.obj", *options)
                obj, material = parse_obj("out.obj")
                self.assertEqual(material, "out.mtl")
                self.assertIn("\nmap_Kd out.png\n", pathlib.Path("out.mtl").read_text())
                self.assertTrue(pathlib.Path("out.png").read_bytes() == png)
                self.check_textured(obj, image, error)
                # Without welding: each vertex is there once.
                self.assertEqual(obj.triangles.shape, glb.triangles.shape)
                self.assertEqual(obj.coordinates.shape[0], glb.points.shape[0])
                self.assertLess(len(obj.points), len(glb.points))
        # Vertices, coordinates and triangles are those of .glb, whatever the chart.
        run("texture", "in.ply", "mesh.ply", "-image", "other.png", *options)
        mesh = Mesh("mesh.ply")
        self.assertEqual(mesh.comment, ["comment TextureFile other.png"])
        self.assertTrue(pathlib.Path("other.png").read_bytes() == png)
        self.check_textured(Textured(mesh.points, mesh["nx ny nz"], mesh["s t"], mesh.triangles), image, error)
        self.assertTrue(np.array_equal(mesh.points, glb.points))
        run("texture", "in.ply", "mesh.ply", "-image", "other.png", "-ascii", *options)
        self.assertIn(b"format ascii", pathlib.Path("mesh.ply").read_bytes())
        self.assertEqual(len(os.listdir()), 8)  # two clouds, glb, obj, mtl, ply and two images

    def test_report_tells_of_the_map_and_the_texture(self):
        report = report_of("texture", "in.ply", "out.obj", "-size", 100, "-chart", "cube", "-gutter", 3)
        mesh, _ = parse_obj("out.obj")
        self.check_entries(report, {
            "chart": "cube", "texture": "colors", "image": {"width": 150, "height": 100},
            "vertices": 700, "mesh_triangles": 1396, "findings": [],
            "options": {"gutter": 3, "checker": None, "image": "out.png"}, "triangles": len(mesh.triangles),
            "cut_vertices": len(mesh.points) - 700, "texture_coordinates": len(mesh.coordinates),
        })  # fmt: skip
        # 3 of 50 pixels at both sides of each face.
        self.assertAlmostEqual(report["image"]["covered_fraction"], 0.88 * 0.88, delta=0.03)
        self.assertGreater(report["image"]["gutter_fraction"], 0.15)

    def test_without_colours_there_is_a_checkerboard_and_that_is_said(self):
        plain = report_of("texture", "plain.ply", "plain.glb", "-size", 64)
        self.assertEqual([plain["texture"], len(plain["findings"])], ["checkerboard", 1])
        self.assertIn("no colours", plain["findings"][0]["text"])
        # Asked for, it is the same, and needs no warning.
        for name in ("plain.ply", "in.ply"):
            asked = report_of("texture", name, "asked.glb", "-size", 64, "-checker", 8)
            self.assertTrue(pathlib.Path("asked.glb").read_bytes() == pathlib.Path("plain.glb").read_bytes(), name)
            self.assertEqual(asked["findings"], [])

    def test_files_mention_each_other_by_paths_from_where_they_are(self):
        os.mkdir("folder")
        run("texture", "in.ply", "folder/a.obj", "-size", 16, "-image", "b.png", "-quiet")
        self.assertEqual(parse_obj("folder/a.obj")[1], "a.mtl")
        self.assertIn("map_Kd ../b.png\n", pathlib.Path("folder/a.mtl").read_text())
        # Blanks are no matter where the name is the rest of a line, or there is no name.
        run("texture", "in.ply", "a b.ply", "-size", 16, "-quiet")
        self.assertEqual(Mesh("a b.ply").comment, ["comment TextureFile a b.png"])
        run("texture", "in.ply", "a b.glb", "-size", 16, "-quiet")
