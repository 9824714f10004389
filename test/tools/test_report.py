"""The page of -report, taken apart by code of its own."""

import base64
import json
import os
import pathlib
import re
import resource
import shlex
import tempfile
import unittest
import zlib

import numpy as np
from tool_test import ToolTest, areas, call, check_surface, lengths, limited, nearest, read_json, read_ply, run, spiral

STEP = 1 / 65535  # of the numbers in 16 bits
SPHERE = "-topology", "sphere"


class Page:
    def __init__(self, name="page.html"):
        self.html = pathlib.Path(name).read_text()
        texts = dict(re.findall(r'<script type="text/plain" id="([\w-]+)">([^<]*)</script>', self.html))
        unpacked = {name: zlib.decompress(base64.b64decode(text)) for name, text in texts.items()}
        self.data = json.loads(unpacked["data"])
        self.texts = {name: texts[f"array-{name}"] for name in self.data["arrays"]}
        self.integers, self.arrays = {}, {}
        for name, about in self.data["arrays"].items():
            kind = np.dtype(f"<u{about['bits'] // 8}")
            rows = np.frombuffer(unpacked[f"array-{name}"], kind).reshape(-1, about["components"])
            self.integers[name] = rows = np.cumsum(rows, axis=0, dtype=kind)  # stored are differences
            if "min" in about:
                low, high = np.array(about["min"]), np.array(about["max"])
                self.arrays[name] = low + rows / (2 ** about["bits"] - 1) * (high - low)

    def share(self, name):
        """Of the range of a colouring, in [0, 1]."""
        return self.integers[name][:, 0] / 255


def around(values, triangles, count):
    """The sums of the triangles' values around the vertices."""
    return np.bincount(triangles.ravel(), np.repeat(values, 3), count)


class Report(ToolTest):
    def setUp(self):
        super().setUp()
        run("scan", "sphere", "in.ply", "-points", 300)

    def page(self, shape, points, *options):
        """Of a generated scan, with its mesh out.ply."""
        run("scan", shape, "scan.ply", "-points", points)
        run("reconstruction", "scan.ply", "out.ply", "-report", "page.html", "-quiet", *options)
        return Page()

    def check(self, page):
        """The page has the mesh and the sphere that were written. The vertices of these in the order of the page."""
        (points, _, triangles), (sphere, _, _) = read_ply("out.ply"), read_ply("sphere.ply")
        order = nearest(page.arrays["positions"], points)
        self.assertEqual(sorted(order), list(range(len(points))))
        self.assertLessEqual((np.abs(page.arrays["positions"] - points[order]) / np.ptp(points, axis=0)).max(), 0.51 * STEP)
        self.assertLessEqual(np.abs(page.arrays["sphere"] - sphere[order]).max(), 1.01 * STEP)
        self.assertEqual(*({tuple(np.roll(row, -row.argmin())) for row in rows}
                           for rows in (order[page.integers["triangles"]], triangles)))  # fmt: skip
        for name, count in (("vertices", len(points)), ("triangles", len(triangles))):
            self.assertEqual([page.data["mesh"][name], page.data["mesh"][f"shown_{name}"]], [count, count])
        return points, sphere, triangles, order

    def test_mesh_marks_and_distortion_are_on_the_page_up_to_rounding(self):
        page = self.page("bowl", 2000, *SPHERE, "-sphere", "sphere.ply")
        points, sphere, triangles, order = self.check(page)
        holes = page.integers["triangles"][page.integers["suspicious"][:, 0] & 2 != 0]
        self.assertGreater(len(holes), 10)
        self.assertGreater(page.arrays["positions"][holes][:, :, 2].min(), 0)  # at the top
        self.assertFalse({"cloud", "colors", "left_out"} & set(page.integers))
        weights, count, image = areas(points, triangles), len(points), areas(sphere, triangles)
        of_vertex = around(weights, triangles, count)
        ratios = np.log2(around(image, triangles, count) / image.sum() / of_vertex * weights.sum())[order]
        about = page.data["arrays"]
        ends = np.where(ratios < 0, -about["area"]["min"][0], about["area"]["max"][0])
        # Files in single precision round a few small triangles of the sphere.
        off = np.abs(page.share("area") - np.clip((ratios / ends + 1) / 2, 0, 1))
        self.assertLess(np.quantile(off, 0.98), 0.51 / 255)
        self.assertGreaterEqual(about["angle"]["min"][0], 0)
        self.assertLess(page.arrays["residual"].max(), 0)  # of logarithms

    def test_a_mesh_with_handles_has_no_sphere_and_surfaces_seen_from_one_place_share_one(self):
        self.assertIn("sphere", self.page("desk", 4800).integers)
        page = self.page("torus", 1500)
        self.assertEqual(page.data["report"]["genus"], 1)
        self.assertEqual(set(page.integers), {"positions", "triangles", "suspicious"})
        self.assertIsNone(page.data["sphere_turn"])

    def test_the_page_says_which_of_the_surfaces_it_shows(self):
        run("scan", "pair", "scan.ply", "-points", 400)
        run("reconstruction", "scan.ply", "out_%03d.ply", "-report", "page_%03d.html", "-quiet")
        for number in (1, 2):
            mesh = Page(f"page_00{number - 1}.html").data["mesh"]
            self.assertEqual([mesh["surface"], mesh["surfaces"]], [number, 2])

    def test_one_page_has_all_surfaces_with_their_marks(self):
        run("scan", "bowl", "bowl.xyz", "-points", 2000)
        bowl = np.loadtxt("bowl.xyz")
        np.savetxt("two.xyz", np.concatenate([bowl, bowl + [5, 0, 0]]))
        run("reconstruction", "two.xyz", "out.ply", *SPHERE, "-parts", "each", "-report", "page.html", "-quiet",
            "-json", "report.json")  # fmt: skip
        page = Page()
        self.assertEqual(page.data["mesh"]["shown_surfaces"], 2)
        self.assertEqual(set(page.integers), {"positions", "triangles", "suspicious"})
        points, _, triangles = read_ply("out.ply")
        order = nearest(page.arrays["positions"], points)
        self.assertEqual(*({tuple(np.roll(row, -row.argmin())) for row in rows}
                           for rows in (order[page.integers["triangles"]], triangles)))  # fmt: skip
        holes = page.integers["triangles"][page.integers["suspicious"][:, 0] & 2 != 0]
        corners = page.arrays["positions"][holes]
        self.assertGreater(corners[..., 2].min(), 0)  # at the top
        right = (corners[..., 0] > 2.5).all(axis=1)
        self.assertTrue(10 < right.sum() < len(holes) - 10)
        self.assertEqual(page.data["report"]["parts"], read_json("report.json")["parts"])

    def test_smoothed_points_outliers_and_colours_are_shown(self):
        run("scan", "head", "scan.xyz", "-points", 1500)
        far = [(x, 0.1 * i, -2) for i, x in enumerate((0.9, 3, 3, 3, 3, 3))]
        points = np.concatenate([np.loadtxt("scan.xyz"), far])
        colors = np.stack([np.arange(1506) % 251, np.arange(1506) // 251, 255 - np.arange(1506) % 13], axis=1)
        np.savetxt("colors.xyz", np.concatenate([points, colors], axis=1), fmt="%.9g")
        run("reconstruction", "colors.xyz", "out.ply", "-columns", "x,y,z,red,green,blue", *SPHERE, "-outliers", 4,
            "-smoothing", 5, "-sphere", "sphere.ply", "-report", "page.html", "-quiet")  # fmt: skip
        page = Page()
        self.check(page)
        at = nearest(page.arrays["cloud"], points)
        self.assertLess(np.abs(page.arrays["cloud"] - points[at]).max(), 1e-4)
        spacing = np.median([np.sort(lengths(points - point))[1] for point in points])
        self.assertTrue(spacing < page.data["spacing"] < 2 * spacing)
        self.assertTrue(np.array_equal(page.integers["colors"], colors[at]))
        # Those that are far off come to the side of a box that is as much larger than the mesh as its diagonal is
        # long, in its middle.
        mesh = page.arrays["positions"]
        high = mesh.max(axis=0) + np.linalg.norm(np.ptp(mesh, axis=0)) / 2
        self.assertLess(high[0], 3)
        self.assertEqual(page.data["left_out"], 6)
        self.assertLess(np.abs(page.arrays["left_out"][:, 0] - np.minimum([p[0] for p in far], high[0])).max(), 1e-4)

    def test_arrays_are_the_same_for_any_number_of_threads(self):
        first, *others = [self.page("animal", 2000, *SPHERE, "-smoothing", 2, "-threads", threads).texts
                          for threads in (1, 2, 3)]  # fmt: skip
        self.assertTrue(all(other == first for other in others))

    def test_a_large_mesh_is_reduced_and_has_twelve_bytes_a_triangle(self):
        points = spiral(507000)
        np.savetxt("large.xyz", points[points[:, 2] < 0.99], fmt="%.7f")
        run("reconstruction", "large.xyz", "out.ply", "-report", "page.html", "-quiet", *SPHERE)
        page = Page()
        self.assertGreater(page.data["mesh"]["triangles"], 1000000)
        self.assertEqual(page.data["mesh"]["shown_triangles"], 1000000)
        self.assertEqual(check_surface(page.integers["triangles"], 500002), (2, 0))
        self.assertGreater((page.integers["suspicious"] & 2 != 0).sum(), 10)
        points, _, triangles = read_ply("out.ply")
        whole = areas(points, triangles).sum()
        self.assertAlmostEqual(areas(page.arrays["positions"], page.integers["triangles"]).sum() / whole, 1, delta=0.01)
        size = sum(map(len, page.texts.values()))
        self.assertLess(size, 13.5e6)

    def test_tiny_clouds_have_a_page(self):
        for points in (4, 5, 12):
            self.check(self.page("sphere", points, *SPHERE, "-sphere", "sphere.ply"))

    def test_what_is_no_page_is_refused_and_a_full_disk_leaves_nothing_behind(self):
        line = "reconstruction in.ply out.ply -report"
        names = "''", "-", "page", "page.htm", "page.json", ".html", "in.ply"
        self.check_refused(2, {f"{line}={name}": "-report" for name in names})
        self.check_refused(2, {f"{line} r.html -json r.html": "would overwrite"})
        self.check_refused(1, {f"{line} no/page.html": "missing directory"})
        full = limited(resource.RLIMIT_FSIZE, 100000)  # room for the mesh, not for the page
        self.check_refused(1, {f"{line} page.html": "cannot write 'page.html'"}, **full)

    def test_the_page_loads_nothing_and_holds_the_report_of_json(self):
        names = "a </script><!-- \"it's\" &.ply", "b </script>.ply"
        for name in names:
            pathlib.Path(name).parent.mkdir()
        pathlib.Path("in.ply").rename(names[0])
        options = ["-seed=7", "-smoothing", "2", "-report", "page.HTML", "-json", "report.json", "-quiet"]
        run("reconstruction", *names, *options)
        page = Page("page.HTML")
        self.assertIn("content=\"default-src 'none'; script-src 'sha256-", page.html)
        for text in ("three.js authors", "Permission is hereby granted, free of charge"):
            self.assertIn(text, page.html)
        # Nothing but the elements of program, data and arrays is where the data are.
        data = page.html[page.html.index('<script type="text/plain"') : page.html.index("<script>")]
        self.assertEqual(data.count("<"), 2 * len(page.texts) + 4)
        report, expected = page.data["report"], read_json("report.json")
        self.assertEqual([report["input"], report["output"], report["options"]["report"]], [*names, "page.HTML"])
        self.assertEqual(expected["stages"][-1]["name"], "report")
        self.assertEqual(*({**one, "stages": None, "peak_memory_bytes": None} for one in (report, expected)))
        self.assertEqual(shlex.split(page.data["command"]), ["pcl_spherical_param_reconstruction", *names, *options])

    def test_the_command_repeats_the_run(self):
        os.rename("in.ply", "-it's in.ply")
        for options in (["-seed", "3", "-outliers", "9"], ["-method", "paper", "-max-iterations", "20"]):
            words = [*options, "-sphere", "s.ply", "--", "-it's in.ply", "out.ply"]
            run("reconstruction", *words)  # without a page
            before = [pathlib.Path(name).read_bytes() for name in ("out.ply", "s.ply")]
            said = run("reconstruction", "-report", "page.html", *words)
            self.assertIn("\nwritten   out.ply, s.ply, page.html\n", said)
            first = Page()
            for repeat in range(2):
                self.assertEqual([pathlib.Path(name).read_bytes() for name in ("out.ply", "s.ply")], before)
                if repeat == 0:
                    run("reconstruction", *shlex.split(first.data["command"])[1:])
            self.assertEqual([Page().texts, Page().data["command"]], [first.texts, first.data["command"]])


def setUpModule():
    with tempfile.TemporaryDirectory() as folder:
        done = call("reconstruction", f"{folder}/none.ply", f"{folder}/out.ply", f"-report={folder}/page.html")
    if "built without the page" in done.stderr:
        raise unittest.SkipTest("this build has no page of the report")
