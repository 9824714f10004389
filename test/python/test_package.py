"""The package as its users read it: documentation, types, example, version, files."""

import ast
import inspect
import re
import subprocess
import sys
import tempfile
import typing
import unittest
from importlib import util
from pathlib import Path

import numpy as np
import shapes
import spherical_param as sp

SOURCE = Path(__file__).resolve().parents[2]
EXAMPLE = SOURCE / "src/python/examples/mesh_points.py"


class Documentation(unittest.TestCase):
    def test_every_public_name_has_a_docstring_and_types(self):
        for name in set(sp.__all__) - {"__version__"}:
            with self.subTest(name):
                thing = getattr(sp, name)
                self.assertTrue(inspect.getdoc(thing))
                if inspect.isclass(thing):
                    # That of a dataclass would be its signature.
                    self.assertFalse(inspect.getdoc(thing).startswith(name + "("))
                    for own, member in vars(thing).items():
                        if not own.startswith("_") and inspect.isfunction(member):
                            self.assertTrue(inspect.getdoc(member), own)
                else:
                    parameters = set(inspect.signature(thing).parameters)
                    self.assertEqual(set(typing.get_type_hints(thing)), parameters | {"return"})

    def test_help_names_every_parameter_and_what_is_raised(self):
        for function in (sp.reconstruct, sp.sphere_map, sp.remesh, sp.find_outliers):
            text = inspect.getdoc(function)
            for parameter in inspect.signature(function).parameters:
                self.assertRegex(text, rf"(?m)(^|[ ,;]){parameter}( :|, |$)", function.__name__)
            self.assertIn("Raises\n------\nInvalidInput", text)

    def test_type_checkers_read_the_signature_of_reconstruct(self):
        stub = ast.parse((Path(sp.__file__).parent / "_reconstruct.pyi").read_text())
        (function,) = (node for node in stub.body if isinstance(node, ast.FunctionDef))
        names = [argument.arg for argument in function.args.args + function.args.kwonlyargs]
        self.assertEqual(names, list(inspect.signature(sp.reconstruct).parameters))

    def test_there_is_one_version(self):
        cmake = (SOURCE / "CMakeLists.txt").read_text()
        self.assertEqual(sp.__version__, re.search(r" VERSION ([0-9.]+)", cmake)[1])
        project = (SOURCE / "pyproject.toml").read_text()
        self.assertNotRegex(project, r"(?m)^version")
        self.assertRegex(project, r'(?m)^dynamic = \["version"\]')


class Files(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.mesh = sp.reconstruct(shapes.bumpy(300), smoothing=1)
        cls.new = sp.remesh(cls.mesh, points=162)
        cls.even = sp.remesh(cls.mesh, points=100, grid="even")

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_the_example_writes_a_ply(self):
        points = shapes.bumpy(300)
        np.savetxt(self.folder / "scan.xyz", points, fmt="%.17g")
        run = subprocess.run(
            [sys.executable, EXAMPLE, "scan.xyz", "mesh.ply"],
            cwd=self.folder, capture_output=True, text=True, check=False,
        )  # fmt: skip
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        self.assertIn("300 vertices, 596 triangles", run.stdout)
        self.assertIn("Looks like a closed genus-0 surface.", run.stdout)
        vertices, triangles = shapes.read_ply(self.folder / "mesh.ply")
        np.testing.assert_array_equal(vertices, points)
        shapes.check_closed(self, 300, triangles)

    def test_ply_has_smoothed_points_or_normals_in_double_precision(self):
        path = self.folder / "m.ply"
        for mesh, columns in (
            (self.mesh, [self.mesh.smoothed]),
            (self.new, [self.new.vertices, self.new.normals]),
            (self.even, [self.even.vertices, self.even.normals]),
        ):
            mesh.write(str(path))
            vertices, triangles = shapes.read_ply(path)
            np.testing.assert_array_equal(vertices, np.hstack(columns))
            np.testing.assert_array_equal(triangles, mesh.triangles)

    def test_what_cannot_be_written_leaves_nothing(self):
        for name in ("mesh.docx", "mesh"):
            with self.assertRaisesRegex(sp.InvalidInput, "; give one ending in .ply"):
                self.mesh.write(self.folder / name)
        with self.assertRaises(OSError):
            self.mesh.write(self.folder / "missing" / "mesh.ply")
        self.assertEqual([*self.folder.iterdir()], [])

    @unittest.skipUnless(util.find_spec("meshio"), "meshio is not installed")
    def test_other_formats_are_written_by_meshio(self):
        import meshio

        self.mesh.write(self.folder / "mesh.vtk")
        mesh = meshio.read(self.folder / "mesh.vtk")
        np.testing.assert_array_equal(mesh.points, self.mesh.smoothed)
        np.testing.assert_array_equal(mesh.cells_dict["triangle"], self.mesh.triangles)
        self.assertEqual([file.name for file in self.folder.iterdir()], ["mesh.vtk"])


class Conversions(unittest.TestCase):
    def check(self, library, vertices, others):
        mesh = sp.reconstruct(shapes.ellipsoid(300))
        source = sp.remesh(mesh, points=162)
        if util.find_spec(library) is None:
            with self.assertRaises(ImportError):
                getattr(source, f"to_{library}")()
            return
        other = getattr(source, f"to_{library}")()
        triangles, normals = others(other)
        np.testing.assert_array_equal(getattr(other, vertices), source.vertices)
        np.testing.assert_array_equal(triangles, source.triangles)
        np.testing.assert_allclose(normals, source.normals, atol=1e-12)
        self.assertEqual(len(getattr(getattr(mesh, f"to_{library}")(), vertices)), 300)

    def test_meshio_has_the_same_mesh(self):
        self.check("meshio", "points", lambda mesh: (mesh.cells[0].data, mesh.point_data["normals"]))

    def test_trimesh_has_the_same_mesh(self):
        self.check("trimesh", "vertices", lambda mesh: (mesh.faces, mesh.vertex_normals))

    def test_open3d_has_the_same_mesh(self):
        self.check("open3d", "vertices", lambda mesh: (mesh.triangles, mesh.vertex_normals))


if __name__ == "__main__":
    unittest.main()
