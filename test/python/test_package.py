"""The package as its users read it: documentation, types, example, version."""

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
PACKAGE = SOURCE / "src/python/spherical_param"
EXAMPLE = SOURCE / "src/python/examples/mesh_points.py"


class Documentation(unittest.TestCase):
    def test_every_public_name_has_a_docstring_and_types(self):
        for name in sp.__all__:
            if name == "__version__":
                continue
            with self.subTest(name):
                thing = getattr(sp, name)
                self.assertTrue(inspect.getdoc(thing))
                if inspect.isclass(thing):
                    # That of a dataclass would be its signature.
                    self.assertFalse(inspect.getdoc(thing).startswith(name + "("))
                    for own, member in vars(thing).items():
                        if not own.startswith("_") and (inspect.isfunction(member)):
                            self.assertTrue(inspect.getdoc(member), own)
                else:
                    parameters = set(inspect.signature(thing).parameters)
                    self.assertEqual(set(typing.get_type_hints(thing)), parameters | {"return"})

    def test_help_names_every_parameter_with_its_range_and_what_is_raised(self):
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

    def test_the_stub_has_the_functions_of_the_extension(self):
        from spherical_param import _core

        stub = ast.parse((PACKAGE / "_core.pyi").read_text())
        declared = {node.name: node for node in stub.body if isinstance(node, ast.FunctionDef)}
        there = {name for name, thing in vars(_core).items() if inspect.isbuiltin(thing)}
        self.assertEqual(set(declared), there)
        for name, node in declared.items():
            arguments = [a.arg for a in node.args.args + node.args.kwonlyargs]
            signature = getattr(_core, name).__doc__.splitlines()[0]
            self.assertEqual(re.findall(r"(\w+): ", signature), arguments, name)

    def test_the_module_carries_its_types_beside_it(self):
        folder = Path(sp.__file__).parent
        for name in ("py.typed", "_core.pyi", "_reconstruct.pyi"):
            self.assertTrue((folder / name).is_file(), name)


class Version(unittest.TestCase):
    def test_there_is_one_version(self):
        cmake = (SOURCE / "CMakeLists.txt").read_text()
        self.assertEqual(sp.__version__, re.search(r" VERSION ([0-9.]+)", cmake)[1])
        project = (SOURCE / "pyproject.toml").read_text()
        self.assertNotRegex(project, r"(?m)^version")
        self.assertRegex(project, r'(?m)^dynamic = \["version"\]')


class Example(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.points = shapes.bumpy(800)
        np.savetxt(self.folder / "scan.xyz", self.points, fmt="%.17g")

    def run_example(self, *arguments):
        return subprocess.run(
            [sys.executable, EXAMPLE, *arguments],
            cwd=self.folder,
            capture_output=True,
            text=True,
            check=False,
        )

    def test_it_writes_a_ply_by_itself(self):
        run = self.run_example("scan.xyz", "mesh.ply")
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        self.assertIn("800 vertices, 1596 triangles", run.stdout)
        self.assertIn("Looks like a closed genus-0 surface.", run.stdout)
        vertices, triangles = shapes.read_ply(self.folder / "mesh.ply")
        np.testing.assert_array_equal(vertices, self.points)
        shapes.check_closed_genus0(self, 800, triangles)

    @unittest.skipUnless(util.find_spec("meshio"), "meshio is not installed")
    def test_it_writes_other_formats_by_meshio(self):
        import meshio

        run = self.run_example("scan.xyz", "mesh.vtk")
        self.assertEqual(run.returncode, 0, run.stderr)
        mesh = meshio.read(self.folder / "mesh.vtk")
        np.testing.assert_array_equal(mesh.points, self.points)
        shapes.check_closed_genus0(self, 800, mesh.cells_dict["triangle"])
        self.assertEqual(sorted(f.name for f in self.folder.iterdir()), ["mesh.vtk", "scan.xyz"])

    def test_a_file_that_cannot_be_written_leaves_nothing(self):
        mesh = sp.reconstruct(self.points)
        for name in ("mesh.docx", "mesh"):
            with self.assertRaisesRegex(sp.InvalidInput, "; give one ending in .ply"):
                mesh.write(self.folder / name)
        with self.assertRaises(OSError):
            mesh.write(self.folder / "missing" / "mesh.ply")
        self.assertEqual([f.name for f in self.folder.iterdir()], ["scan.xyz"])


class Conversions(unittest.TestCase):
    def check(self, library, convert, vertices_of, triangles_of):
        mesh = sp.reconstruct(shapes.ellipsoid(300))
        for source in (mesh, sp.remesh(mesh, points=162)):
            if util.find_spec(library) is None:
                with self.assertRaises(ImportError):
                    convert(source)
                continue
            other = convert(source)
            np.testing.assert_array_equal(vertices_of(other), source.vertices)
            np.testing.assert_array_equal(triangles_of(other), source.triangles)

    def test_meshio_has_the_same_mesh(self):
        self.check(
            "meshio",
            lambda mesh: mesh.to_meshio(),
            lambda mesh: mesh.points,
            lambda mesh: mesh.cells_dict["triangle"],
        )

    def test_trimesh_has_the_same_mesh(self):
        self.check(
            "trimesh",
            lambda mesh: mesh.to_trimesh(),
            lambda mesh: mesh.vertices,
            lambda mesh: mesh.faces,
        )

    def test_open3d_has_the_same_mesh(self):
        self.check(
            "open3d",
            lambda mesh: mesh.to_open3d(),
            lambda mesh: np.asarray(mesh.vertices),
            lambda mesh: np.asarray(mesh.triangles),
        )

    def test_normals_and_smoothed_points_are_written(self):
        mesh = sp.reconstruct(shapes.ellipsoid(300), smoothing=1)
        new = sp.remesh(mesh, points=162)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "m.ply")
            mesh.write(path)
            np.testing.assert_array_equal(shapes.read_ply(path)[0], mesh.smoothed)
            new.write(path)
            np.testing.assert_array_equal(
                shapes.read_ply(path)[0], np.hstack([new.vertices, new.normals])
            )
            even = sp.remesh(mesh, points=100, grid="even")
            even.write(str(path))
            self.assertEqual(len(shapes.read_ply(path)[1]), 0)


if __name__ == "__main__":
    unittest.main()
