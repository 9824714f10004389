"""The package as its users read it: documentation, types, example, version, files."""

import ast
import base64
import dataclasses
import html
import inspect
import json
import os
import re
import subprocess
import sys
import typing
import unittest
import unittest.mock
import zlib
from importlib import util
from pathlib import Path

import numpy as np
import shapes
import spherical_param as sp
from spherical_param import _core

SOURCE = Path(__file__).resolve().parents[2]
EXAMPLE = SOURCE / "src/python/examples/mesh_points.py"


class Documentation(unittest.TestCase):
    def test_every_public_name_has_a_docstring_and_types(self):
        for name in set(sp.__all__) - {"__version__"}:
            with self.subTest(name):
                thing = getattr(sp, name)
                text = inspect.getdoc(thing)
                self.assertTrue(text)
                if inspect.isclass(thing):
                    # That of a dataclass would be its signature.
                    self.assertFalse(text.startswith(name + "("))
                    for own, member in vars(thing).items():
                        if not own.startswith("_") and inspect.isfunction(member):
                            self.assertTrue(inspect.getdoc(member), own)
                    continue
                parameters = inspect.signature(thing).parameters
                if thing is not sp.reconstruct:  # whose types are in _reconstruct.pyi
                    self.assertEqual(set(typing.get_type_hints(thing)), {*parameters, "return"})
                for parameter in parameters:
                    self.assertRegex(text, rf"(?m)(^|[ ,;]){parameter}( :|, |$)")
                self.assertIn("Raises\n------\nInvalidInput", text)

    def test_type_checkers_read_the_types_that_are_made(self):
        stub = ast.parse((Path(sp.__file__).parent / "_reconstruct.pyi").read_text())
        overloads = [node for node in stub.body if isinstance(node, ast.FunctionDef)]
        self.assertEqual(len(overloads), 4)
        for function in overloads:
            names = [argument.arg for argument in function.args.args + function.args.kwonlyargs]
            self.assertEqual(names, list(inspect.signature(sp.reconstruct).parameters))
            self.assertLessEqual(set(re.findall(r"Results?", ast.unparse(function.returns))), set(sp.__all__))
            types = {argument.arg: ast.unparse(argument.annotation) for argument in function.args.kwonlyargs}
            for row in _core.option_table():
                if row["name"] not in ("parts", "topology"):  # by which the overloads differ
                    self.assertEqual([name for name in row["choices"] if repr(name) not in types[row["name"]]], [])
        for name in ("Topology", "Diagnosis", "Embedding", "Opening"):
            made = getattr(sp, name)
            self.assertEqual(set(typing.get_type_hints(made)), {field.name for field in dataclasses.fields(made)})

    def test_help_explains_the_marks_of_triangles(self):
        for mark in sp.TriangleMark:
            self.assertIn(f"TriangleMark.{mark.name}`` ({mark.value})", inspect.getdoc(sp.TriangleMark))

    def test_there_is_one_version(self):
        cmake = (SOURCE / "CMakeLists.txt").read_text()
        self.assertEqual(sp.__version__, re.search(r" VERSION ([0-9.]+)", cmake)[1])
        project = (SOURCE / "pyproject.toml").read_text()
        self.assertNotRegex(project, r"(?m)^version")
        self.assertRegex(project, r'(?m)^dynamic = \["version"\]')


class Files(shapes.InFolder):
    @classmethod
    def setUpClass(cls):
        points = shapes.bumpy(300)
        cls.mesh = sp.reconstruct(shapes.record(points, shapes.colors_of(points)), smoothing=1)
        cls.new = sp.remesh(cls.mesh, points=162)

    def test_the_example_writes_a_mesh_and_its_page(self):
        points = shapes.bumpy(300)
        np.savetxt(self.folder / "scan.xyz", points, fmt="%.17g")
        run = subprocess.run(
            [sys.executable, EXAMPLE, "scan.xyz", "mesh.obj", "page.html"],
            cwd=self.folder, capture_output=True, text=True, check=False,
        )  # fmt: skip
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("A sound mesh. 300 vertices, 596 triangles", run.stdout)
        shapes.check_closed(self, 300, shapes.faces_of(self.folder / "mesh.obj"))
        self.assertIn("</html>", (self.folder / "page.html").read_text(encoding="utf-8"))

    def test_files_have_points_normals_and_colors(self):
        for mesh in (self.mesh, self.new):
            mesh.write(str(self.folder / "m.obj"))
            np.testing.assert_array_equal(shapes.faces_of(self.folder / "m.obj"), mesh.triangles)
            cloud = sp.reconstruct(self.folder / "m.obj")
            np.testing.assert_allclose(cloud.vertices, mesh.vertices, atol=1e-6)
            np.testing.assert_allclose(cloud.normals, mesh.normals, atol=1e-6)
            np.testing.assert_array_equal(cloud.colors, mesh.colors)

    def test_a_file_is_written_whole_or_not_at_all(self):
        file = self.folder / "m.glb"
        self.mesh.write(file)
        self.assertGreater(file.stat().st_size, 3 * 4 * len(self.mesh.vertices))
        file.unlink()
        for name in ("mesh.docx", "mesh", "mesh.pcd"):
            with self.assertRaisesRegex(sp.InvalidInput, "; use one of .ply"):
                self.mesh.write(self.folder / name)
        with self.assertRaises(OSError):
            self.mesh.write(self.folder / "missing" / "mesh.ply")
        self.assertEqual([*self.folder.iterdir()], [])


class Conversions(unittest.TestCase):
    #: Of each library its name for the vertices, and what else its meshes have.
    LIBRARIES = {
        "meshio": ("points", lambda mesh: (
            mesh.cells[0].data, mesh.point_data["normals"], mesh.point_data["colors"])),
        "trimesh": ("vertices", lambda mesh: (
            mesh.faces, mesh.vertex_normals, mesh.visual.vertex_colors[:, :3])),
        "open3d": ("vertices", lambda mesh: (
            mesh.triangles, mesh.vertex_normals, 255 * np.asarray(mesh.vertex_colors))),
    }  # fmt: skip

    def test_other_libraries_have_the_same_mesh(self):
        points = shapes.ellipsoid(300)
        mesh = sp.reconstruct(shapes.record(points, shapes.colors_of(points)))
        source = sp.remesh(mesh, points=162)
        for library, (vertices, others) in self.LIBRARIES.items():
            with self.subTest(library):
                if util.find_spec(library) is None:
                    with self.assertRaises(ImportError):
                        getattr(source, f"to_{library}")()
                    continue
                for each in (mesh, source):
                    other = getattr(each, f"to_{library}")()
                    triangles, normals, colors = others(other)
                    np.testing.assert_array_equal(getattr(other, vertices), each.vertices)
                    np.testing.assert_array_equal(triangles, each.triangles)
                    np.testing.assert_allclose(normals, each.normals, atol=1e-12)
                    np.testing.assert_allclose(colors, each.colors, atol=1e-9)


class Views(shapes.InFolder):
    def data(self):
        """The data of the page, as its script unpacks them."""
        element = re.search(r'id="data">([^<]*)<', (self.folder / "page.html").read_text(encoding="utf-8"))
        return json.loads(zlib.decompress(base64.b64decode(element[1])))

    @unittest.skipUnless(_core.has_report, "three.js was not there when the module was built")
    def test_the_report_is_on_the_result_and_shows_what_it_does_not_hold(self):
        points = shapes.bumpy(300)
        cloud = np.concatenate([points, shapes.bumpy(100) + [9, 0, 0], [[0, 0, 99]]])
        mesh = sp.reconstruct(cloud, parts="largest", outliers="auto", k=12)
        self.assertIsNone(mesh.diagnosis.triangle_marks)
        mesh.report(self.folder / "page.html")
        data = self.data()
        self.assertEqual(data["report"]["verdict"], mesh.verdict)
        self.assertEqual(data["report"]["measures"]["volume"], mesh.measures.volume)
        self.assertEqual((data["report"]["points"], data["report"]["vertices"]), (401, 300))
        self.assertEqual(data["report"]["left_out"]["outliers"], [400])
        self.assertEqual(data["report"]["left_out"]["other_parts"], [*range(300, 400)])
        self.assertEqual(data["report"]["options"]["parts"], "largest")
        self.assertIn("sphere", data["arrays"])
        command = "spherical_param.reconstruct(points, parts='largest', outliers='auto', k=12)"
        self.assertEqual(data["command"], command)
        embedded = re.fullmatch(r'<iframe srcdoc="([^"]*)"[^>]*></iframe>', mesh._repr_html_())
        self.assertIn('id="data"', html.unescape(embedded[1]))

    def test_reports_of_other_names_or_changed_points_are_refused(self):
        points = shapes.bumpy(50)
        mesh = sp.reconstruct(points)
        with self.assertRaisesRegex(sp.InvalidInput, "; give a name that does"):
            mesh.report("page.txt")
        with self.assertRaises(OSError):
            mesh.report(self.folder / "missing" / "page.html")
        points += 1
        with self.assertRaisesRegex(sp.InvalidInput, "points were changed"):
            mesh.report(self.folder / "page.html")

    def show(self, mesh, environment):
        with unittest.mock.patch.dict(os.environ, environment):
            for name in {"DISPLAY", "WAYLAND_DISPLAY"} - set(environment):
                os.environ.pop(name, None)
            mesh.show()

    @unittest.skipUnless(util.find_spec("matplotlib"), "matplotlib is not installed")
    def test_show_draws_by_matplotlib_without_a_display(self):
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot

        points = shapes.bumpy(100)
        mesh = sp.reconstruct(shapes.record(points, shapes.colors_of(points)))
        self.show(mesh, {"MPLBACKEND": "Agg"})
        pyplot.gcf().canvas.draw()
        (drawn,) = pyplot.gcf().axes[0].collections
        colors = drawn.get_facecolor()
        self.assertEqual(len(colors), len(mesh.triangles))
        self.assertGreater(len(np.unique(colors, axis=0)), 10)
        pyplot.close("all")

    def test_show_opens_a_window_of_open3d_or_pyvista_with_a_display(self):
        mesh, shown = sp.reconstruct(shapes.bumpy(50)), unittest.mock.MagicMock()
        for libraries, call in (
            ({"open3d": shown, "pyvista": None}, shown.visualization.draw_geometries),
            ({"open3d": None, "pyvista": shown}, shown.PolyData().plot),
        ):
            with unittest.mock.patch.dict(sys.modules, libraries):
                self.show(mesh, {"DISPLAY": ":0"})
            call.assert_called_once()
