"""pcl_spherical_param_remesh: grids, harmonics and report."""

import pathlib
import struct
import unittest
import zlib

import numpy as np
from tool_test import (Mesh, ToolTest, ellipsoid, lengths, read_json, read_ply, report_of, run, volume, write_ply,
                       write_xyz)  # fmt: skip

AXES, CENTER = (2, 1, 0.7), (10, 0, 0)
NORMALS, COLORS = "nx ny nz", "red green blue"


def unit(vectors):
    return vectors / lengths(vectors)[:, None]


def colors_at(directions):
    """Linear, so that what is interpolated between the points is as good as the surface there."""
    return 127.5 * (unit(directions) + 1)


def directions_of(points):
    """The directions of points near the ellipsoid, of length 1 on it."""
    return (points - CENTER) / AXES


def decode_16_bits(png):
    """Rows, columns and channels of a PNG of 16 bits a channel. Needed as matplotlib reads 8 bits of them."""
    size = struct.unpack(">II", png[16:24])
    data, at = b"", 8
    while at < len(png):
        length, kind = struct.unpack(">I4s", png[at : at + 8])
        data += png[at + 8 : at + 8 + length] if kind == b"IDAT" else b""
        at += length + 12
    row, rows = bytearray(6 * size[0]), []
    lines = zlib.decompress(data)
    for start in range(0, len(lines), len(row) + 1):
        filtered, above, row = lines[start], row, bytearray(lines[start + 1 : start + 1 + len(row)])
        for i in range(len(row)):  # PNG specification, section 9.2
            left, corner = (row[i - 6], above[i - 6]) if i >= 6 else (0, 0)
            paeth = min((left, above[i], corner), key=lambda each: abs(left + above[i] - corner - each))
            row[i] = (row[i] + (0, left, above[i], (left + above[i]) // 2, paeth)[filtered]) % 256
        rows.append(np.frombuffer(bytes(row), ">u2").reshape(-1, 3))
    return np.stack(rows)


class RemeshTool(ToolTest):
    """in.ply has 500 points of the ellipsoid, coloured by their directions."""

    def setUp(self):
        super().setUp()
        points = ellipsoid(500, AXES, CENTER)
        write_ply("in.ply", points, colors=np.round(colors_at(directions_of(points))))

    def remeshed(self, *options):
        run("remesh", "in.ply", "out.ply", *options)
        return Mesh("out.ply")

    def check_on_the_surface(self, mesh):
        directions = directions_of(mesh.points)
        self.assertLess(np.abs(lengths(directions) - 1).max(), 0.01)
        self.assertGreater((mesh[NORMALS] * unit(directions / AXES)).sum(axis=1).min(), 0.98)
        self.assertLess(np.abs(mesh[COLORS] - colors_at(directions)).max(), 6)

    def test_meshes_are_closed_on_the_surface_and_have_the_nearest_number_of_points(self):
        for grid, made in (("icosahedral", 1002), ("octahedral", 1026)):  # 10 f^2 + 2 and 4 f^2 + 2
            with self.subTest(grid):
                mesh = self.remeshed("-grid", grid, "-points", 1000, "-sphere", "s.ply")
                self.assertEqual(len(mesh.points), made)
                self.check_sphere(mesh)
                self.check_on_the_surface(mesh)
                sphere = Mesh("s.ply")
                self.same(sphere.triangles, mesh.triangles)
                self.same(sphere[COLORS], mesh[COLORS])
                self.assertNotIn("nx", sphere)
                self.assertLess(np.abs(lengths(sphere.points) - 1).max(), 2e-7)

    def test_geometry_image_has_the_vertices_of_the_octahedral_grid_in_16_bits(self):
        report = report_of("remesh", "in.ply", "out.ply", "-grid", "octahedral", "-points", 258, "-image", "out.png")
        image = report["image"]
        self.assertEqual(image["side"], 17)
        points = Mesh("out.ply").points
        self.assertLess(np.abs(points.min(axis=0) - image["low"]).max(), 1e-6)
        self.assertLess(np.abs(points.max(axis=0) - image["high"]).max(), 1e-6)
        pixels = decode_16_bits(pathlib.Path("out.png").read_bytes()).reshape(-1, 3)
        self.assertEqual(len(pixels), 17 * 17)
        low, high = np.array(image["low"]), np.array(image["high"])
        positions = low + pixels / 65535 * (high - low)
        nearest = lengths((positions[:, None] - points[None]).reshape(-1, 3)).reshape(len(positions), -1)
        self.assertLess(nearest.min(axis=1).max(), 1e-4)  # each pixel is a vertex, and each vertex a pixel
        self.assertLess(nearest.min(axis=0).max(), 1e-4)

    def test_harmonics_of_a_sphere_are_its_center_and_its_radius(self):
        write_xyz("sphere.xyz", ellipsoid(1000, (3, 3, 3), CENTER))
        report = report_of("remesh", "sphere.xyz", "series.ply", "-series", "-harmonics", "c.json", "-degree", 4,
                           "-points", 642)  # fmt: skip
        file = read_json("c.json")
        self.assertEqual([file["degree"], type(file["convention"])], [4, str])
        self.assertLess(file["rms_residual"], 0.05)
        self.assertEqual(file["rms_residual"], report["harmonics"]["rms_residual"])
        coefficients = file["coefficients"]
        self.assertEqual(len(coefficients), 25)
        self.assertEqual([(each["l"], each["m"]) for each in coefficients[:4]], [(0, 0), (1, -1), (1, 0), (1, 1)])
        # The mean of the position over the sphere is c_00 Y_00.
        self.assertLess(np.abs(np.divide(coefficients[0]["xyz"], (4 * np.pi) ** 0.5) - CENTER).max(), 0.02)
        # The mesh of the series is the series at the points of the sphere.
        series = Mesh("series.ply")
        self.assertEqual(len(series.points), 642)
        self.check_sphere(series)
        self.assertLess(np.abs(lengths(series.points - CENTER) - 3).max(), 0.05)

    def test_report_is_that_of_the_written_mesh(self):
        report = report_of("remesh", "in.ply", "out.ply", "-points", 1000)
        self.check_entries(report, {
            "input_points": 500, "vertices": 500, "mesh_triangles": 996, "mesh_self_intersections": 0,
            "points": 1002, "triangles": 2000, "components": 1, "genus": 0, "self_intersections": 0,
            "closed": True, "manifold": True, "oriented": True, "harmonics": None,
            "grid": {"kind": "icosahedral", "frequency": 10},
            "untangling": {"self_intersections_before": 0, "moved": 0},
            "options": {"points": 1000, "fit": "smooth", "area_weight": 0.5, "map_sweeps": 40, "degree": None},
        })  # fmt: skip
        self.assertIs(type(report["embedding_distortion"]["flipped_triangles"]), int)
        # Of as many points as the mesh has, unless told.
        self.assertEqual(report_of("remesh", "in.ply", "usual.ply")["points"], 492)
        mesh = Mesh("out.ply")
        self.assertAlmostEqual(report["volume"], volume(mesh.points, mesh.triangles), delta=1e-9)

    def test_distance_is_that_of_the_points_from_the_new_mesh(self):
        run("scan", "bird", "bird.ply", "-points", 500)
        report = report_of("remesh", "bird.ply", "out.ply", "-points", 42, "-topology", "sphere")
        mesh = Mesh("out.ply")
        # From many points of each triangle: 60 on a side.
        i, j = np.mgrid[:61, :61].reshape(2, -1) / 60
        weights = np.stack([i, j, 1 - i - j])[:, i + j < 1.001]
        some = np.einsum("tcd,cw->twd", mesh.points[mesh.triangles], weights).reshape(-1, 3)
        distances = np.array([lengths(some - point).min() for point in read_ply("bird.ply")[0]])
        rms = (distances**2).mean() ** 0.5
        for name, value in (("mean", distances.mean()), ("rms", rms), ("max", distances.max())):
            self.assertAlmostEqual(report["distance"][name], value, delta=0.01 * value)

    def test_options_of_the_map_and_the_fit_reach_them(self):
        even, conformal, valid_only = (report_of("remesh", "in.ply", "out.ply", *options) for options in (
            ("-area-weight", 0.9), ("-area-weight", 0), ("-map-sweeps", 0)))  # fmt: skip
        self.assertLess(even["area_distortion"]["mean"], conformal["area_distortion"]["mean"])
        self.assertNotEqual(valid_only["area_distortion"], even["area_distortion"])
        self.assertIsNone(valid_only["options"]["area_weight"])
        smooth, linear = (self.remeshed("-fit", fit).points for fit in ("smooth", "linear"))
        self.assertFalse(np.array_equal(smooth, linear))
