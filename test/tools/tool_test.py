"""What the tests of the tools share. SPHERICAL_PARAM_TOOLS is the folder of the programs; tools is on PYTHONPATH."""

import json
import os
import pathlib
import resource
import shlex
import subprocess
import tempfile
import unittest

import numpy as np
from draw import read_ply  # noqa: F401

TYPES = {"uchar": "u1", "int": "i4", "float": "f4", "double": "f8"}  # of PLY, those that the tools write


def program(tool):
    return f"{os.environ['SPHERICAL_PARAM_TOOLS']}/pcl_spherical_param_{tool}"


def call(tool, *words, **more):
    """Runs a tool as a user does and returns the process, which has ended."""
    return subprocess.run([program(tool), *map(str, words)],
                          **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "check": False,
                             "timeout": 600, **more})  # fmt: skip


def run(tool, *words, code=0, **more):
    """What a tool prints that ends with this code."""
    done = call(tool, *words, **more)
    assert done.returncode == code, (words, done.returncode, done.stderr)
    return done.stdout + done.stderr


def report_of(tool, *words):
    """The report by -json of a run that has to succeed."""
    done = call(tool, *words, "-json", "-")
    assert done.returncode == 0, (words, done.returncode, done.stderr)
    return json.loads(done.stdout)


def read_json(name):
    return json.loads(pathlib.Path(name).read_text())


def limited(kind, value):
    """Arguments of call() for a limit, e.g. RLIMIT_FSIZE, which acts like a full disk."""
    return {"preexec_fn": lambda: resource.setrlimit(kind, (value, value))}


def listing():
    """All that is in the folder: names with contents (of what is no file: None)."""
    return {path: path.read_bytes() if path.is_file() and os.access(path, os.R_OK) else None
            for path in pathlib.Path().rglob("*")}  # fmt: skip


def spiral(count):
    """Points of the unit sphere."""
    z = 1 - (2 * np.arange(count) + 1) / count
    angles = np.pi * (3 - 5**0.5) * np.arange(count)
    return np.stack([np.sqrt(1 - z**2) * np.cos(angles), np.sqrt(1 - z**2) * np.sin(angles), z], axis=1)


def single(points):
    """Rounded so that they are exact in single precision."""
    return points.astype(np.float32).astype(float)


def ellipsoid(count, axes=(1.2, 0.9, 0.7), center=(0, 0, 0)):
    return single(spiral(count) * axes + center)


def hemisphere(count):
    return spiral(2 * count)[count:]


def write(name, text):
    pathlib.Path(name).write_text(text)


def write_xyz(name, *clouds, head=""):
    """Points as lines of text, exact."""
    np.savetxt(name, np.concatenate(clouds), "%.17g", header=head.rstrip("\n"), comments="")


def write_ply(name, points, normals=None, colors=None):
    """The same as PLY."""
    parts = ("double x y z", points), ("float nx ny nz", normals), ("uchar red green blue", colors)
    parts = [(*words.split(), values) for words, values in parts if values is not None]
    header = [f"ply\nformat ascii 1.0\nelement vertex {len(points)}"]
    header += [f"property {kind} {name}" for kind, *names, _ in parts for name in names]
    write_xyz(name, np.hstack([part[-1] for part in parts]), head="\n".join([*header, "end_header"]))


class Mesh:
    """What a PLY file of little-endian bytes holds; a cloud has no triangles."""

    def __init__(self, name):
        head, body = pathlib.Path(name).read_bytes().split(b"end_header\n", 1)
        lines = head.decode().splitlines()
        words = [line.split() for line in lines]
        assert "format binary_little_endian 1.0" in lines
        counts = {word[1]: int(word[2]) for word in words if word[0] == "element"}
        row = [(word[2], "<" + TYPES[word[1]]) for word in words if word[0] == "property" and len(word) == 3]
        self.vertices = np.frombuffer(body, row, counts["vertex"])
        faces = np.frombuffer(body[self.vertices.nbytes :], [("size", "u1"), ("corners", "<i4", 3)])
        assert len(faces) == counts.get("face", 0) and (faces["size"] == 3).all()
        self.triangles = faces["corners"].astype(int)
        self.points = self["x y z"]
        self.comment = [line for line in lines if line.startswith("comment ")][-1:]

    def __contains__(self, name):
        return name in self.vertices.dtype.names

    def __getitem__(self, names):
        """Properties of the vertices, a column each."""
        return np.stack([self.vertices[name] for name in names.split()], axis=1).astype(float)


def nearest(points, others):
    """For each point the index of the nearest one of others."""
    return np.array([((others - point) ** 2).sum(axis=1).argmin() for point in points])


def areas(points, triangles):
    a, b, c = points[triangles].transpose(1, 0, 2)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def volume(points, triangles):
    return np.linalg.det(points[triangles]).sum() / 6


def lengths(points):
    return np.linalg.norm(points, axis=1)


def check_surface(triangles, count):
    """Checks for one oriented surface over all vertices. Returns its Euler characteristic and number of open edges."""
    links = [{} for _ in range(count)]  # the next neighbour of each around a vertex
    for corners in triangles.tolist():
        for k in range(3):
            assert links[corners[k]].setdefault(corners[k - 2], corners[k - 1]) == corners[k - 1]
    open_edges = sum(len(set(link) ^ set(link.values())) for link in links) // 2
    edges = sum(len(set(link) | set(link.values())) for link in links) // 2
    reached, found = {0}, [0]
    while found:
        new = {vertex for at in found for vertex in (*links[at], *links[at].values())} - reached
        reached |= new
        found = list(new)
    assert len(reached) == count
    for link in links:
        at = next(iter(set(link) - set(link.values()) or link))
        while at in link:
            at = link.pop(at)
        assert not link  # the triangles of a vertex are one fan
    return count - edges + len(triangles), open_edges


class ToolTest(unittest.TestCase):
    """Each test is in a folder of its own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="spherical_param_test.")
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chmod(folder.name, 0o777)
        os.chdir(folder.name)

    def same(self, values, others):
        self.assertTrue(np.array_equal(values, others))

    def check_sphere(self, mesh):
        """A closed, oriented sphere over all of its vertices."""
        self.assertEqual(check_surface(mesh.triangles, len(mesh.points)), (2, 0))

    def check_all_in(self, points, others):
        """All points are among others, exactly."""
        self.assertEqual(set(map(tuple, points)) - set(map(tuple, others)), set())

    def check_entries(self, report, expected):
        """A report has these entries, and perhaps more."""
        for key, value in expected.items():
            if isinstance(value, dict):
                self.check_entries(report[key], value)
            else:
                self.assertEqual(report[key], value, key)

    def check_refused(self, code, rows, **more):
        """Command lines fail with a cause and a remedy, one line each, and the files stay as they are."""
        for line, cause in rows.items():
            with self.subTest(line):
                before = listing()
                done = call(*shlex.split(line), **more)
                self.assertEqual(done.returncode, code, done.stderr)
                lines = [text for text in done.stderr.split("\n") if text]
                self.assertEqual(len(lines), 2, done.stderr)
                self.assertIn(cause, lines[0])
                self.assertRegex(lines[1], "^  remedy: .")
                self.assertTrue(listing() == before)
