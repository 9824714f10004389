"""What all tools promise: help, silence, reports, the same bytes, and nothing half done."""

import glob
import json
import os
import pathlib
import re
import signal
import stat
import subprocess
import time
import unittest

import numpy as np
from tool_test import (Mesh, ToolTest, call, check_surface, ellipsoid, hemisphere, listing, program, report_of, run,
                       write, write_ply, write_xyz)  # fmt: skip

# Of each tool that takes the options of the reconstruction: a run that writes all it can, the options besides those of
# the reconstruction, and the last stages of its report.
TOOLS = {
    "reconstruction": ("in.ply out.ply -sphere s.vtk -smoothing 4 -outliers 5",
                       "sphere report", "optimization smoothing cleaning embedding quality write"),
    "remesh": ("in.ply out.ply -sphere s.ply -harmonics c.json -degree 6",
               "grid points fit sphere harmonics series degree area-weight map-sweeps",
               "map surface harmonics resample untangle verify write"),
    "texture": ("in.ply out.obj -size 64 -chart cube",
                "chart size gutter checker image area-weight map-sweeps", "quality map atlas image write"),
    "morph": ("in.ply other.ply out.ply -frames 3 -pairs pairs.txt",
              "frames pairs align connectivity samples fit match check area-weight map-sweeps", "write"),
}  # fmt: skip
GUIDE = (pathlib.Path(__file__).resolve().parents[2] / "doc" / "guide.md").read_text()
# Those of the table of the library, which the guide prints.
OPTIONS = re.findall(r"^\| `(\w+)`(?: \(expert\))? \| `[\w.]+` \|", GUIDE, re.MULTILINE)


def options_of(tool):
    """The names of all options as in the report."""
    names = f"{TOOLS[tool][1]} outliers json ascii strict quiet".replace("-", "_")
    return [*names.split(), *OPTIONS]


def write_cloud(name, count):
    points = ellipsoid(count)
    write_ply(name, points, colors=np.round(100 * np.abs(points) + 20))


def each():
    """Each tool with the words of its run."""
    return [(tool, words.split()) for tool, (words, _, _) in TOOLS.items()]


class EveryTool(ToolTest):
    def setUp(self):
        super().setUp()
        write_cloud("in.ply", 300)
        write_cloud("other.ply", 250)
        write("pairs.txt", "3 5\n290 240\n")

    def test_help_lists_every_option_those_of_experts_last_and_version_succeeds(self):
        self.assertGreater(len(OPTIONS), 20)
        for tool, _ in each():
            with self.subTest(tool):
                said = run(tool, "-h", "expert")
                for option in options_of(tool):
                    self.assertIn(f"\n  -{option.replace('_', '-')} ", said)
                experts = said.index("\nExpert options:\n")
                for option in ("surface", options_of(tool)[0]):
                    self.assertLess(said.index(f"\n  -{option} "), experts)
                self.assertGreater(said.index("\n  -ascii "), experts)
                brief = run(tool, "--help")
                self.assertNotIn("\n  -ascii ", brief)
                self.assertIn("-h expert", brief)
                self.assertTrue(run(tool, "--version").startswith(f"pcl_spherical_param_{tool} "))

    def test_report_is_alone_on_standard_output_and_has_every_option(self):
        for tool, words in each():
            with self.subTest(tool):
                report = report_of(tool, *words, "-seed", 7, "-threads", 2)
                self.check_entries(report["options"], {"seed": 7, "threads": 2, "tolerance": None})
                self.assertEqual(set(options_of(tool)) - set(report["options"]), set())
                self.assertIs(type(report["version"]), str)
                self.assertIn("peak_memory_bytes", report)
                self.assertGreaterEqual(min(stage["seconds"] for stage in report["stages"]), 0)
                self.assertIn(TOOLS[tool][2], " ".join(stage["name"] for stage in report["stages"]))
                if tool == "reconstruction":
                    continue
                of_map = report["first"] if tool == "morph" else report
                self.assertEqual(of_map["flipped_triangles"], 0)
                self.assertLessEqual(1, of_map["angle_distortion"]["mean"])

    def test_quiet_prints_nothing_and_writes_the_same_bytes_by_any_number_of_threads(self):
        for tool, words in each():
            with self.subTest(tool):
                files = []
                for threads in (1, 3):
                    self.assertEqual(run(tool, *words, "-quiet", "-threads", threads), "")
                    files.append(listing())
                self.assertIn(pathlib.Path("out_002.ply" if tool == "morph" else words[1]), files[0])
                self.assertTrue(files[0] == files[1])

    def test_strict_makes_faults_a_failure_and_writes_the_files(self):
        run("scan", "bowl", "in.ply", "-points", 500)
        for tool, words in each():
            with self.subTest(tool):
                words += ["-topology", "sphere", "-quiet"]
                self.assertEqual(run(tool, *words), "")
                files = listing()
                strict = call(tool, *words, "-strict", "-json", "-")
                self.assertEqual(strict.returncode, 1)
                cause, remedy = strict.stderr.rstrip("\n").split("\n")
                self.assertTrue(remedy.startswith("  remedy: the files were written"), remedy)
                self.assertTrue(listing() == files)
                report = json.loads(strict.stdout)
                self.assertIs(report["options"]["strict"], True)
                # Morphing has findings of each object.
                findings = (report["first"] if tool == "morph" else report)["findings"]
                self.assertTrue(findings)
                for finding in findings:
                    self.assertTrue(not finding["is_fault"] or finding["text"] in cause, finding)
        # Without faults -strict changes nothing.
        run("reconstruction", "other.ply", "out.ply", "-strict", "-quiet")

    def test_open_surfaces_stay_open(self):
        write_xyz("open.xyz", hemisphere(1000))
        for output, *words in (["texture.ply", "texture", "-checker", 8],
                               ["mesh.ply", "reconstruction"], ["grid.ply", "remesh", "-points", 2000],
                               ["m_000.ply", "morph", "-frames", 2]):  # fmt: skip
            tool, *options = words
            files = ["in.ply", "m.ply"] if tool == "morph" else [output]
            run(tool, "open.xyz", *files, *options, "-surface", "open", "-quiet")
            mesh = Mesh(output)
            # Without vertices where the opening is.
            self.assertLess(mesh.points[:, 2].max(), 0.05, output)
            # Vertices on the cuts of the chart are there once for each side.
            if output != "texture.ply":
                euler, open_edges = check_surface(mesh.triangles, len(mesh.points))
                self.assertEqual([euler, open_edges > 0], [1, True])

    def test_output_is_where_links_lead_with_the_rights_of_the_old_file_or_in_a_pipe(self):
        os.symlink("second.ply", "first.ply")
        os.symlink("out.ply", "second.ply")
        for rights in (0o640, 0o600):  # of the umask, of the old file
            run("reconstruction", "in.ply", "first.ply", "-quiet", umask=0o027)
            self.assertTrue(os.path.islink("first.ply") and os.path.islink("second.ply"))
            self.assertEqual(os.lstat("out.ply").st_mode, stat.S_IFREG | rights)
            os.chmod("out.ply", 0o600)
        os.mkfifo("pipe.ply")
        reader = os.open("pipe.ply", os.O_RDONLY | os.O_NONBLOCK)
        self.addCleanup(os.close, reader)
        run("reconstruction", "in.ply", "pipe.ply", "-quiet")
        self.assertEqual(os.read(reader, 1 << 16), pathlib.Path("out.ply").read_bytes())
        self.assertTrue(pathlib.Path("pipe.ply").is_fifo())

    def test_a_signal_leaves_nothing_behind_and_keeps_the_old_file(self):
        # The tool waits for a reader of the pipe, with the mesh in a temporary file.
        os.mkfifo("pipe.ply")
        write("out.ply", "kept")
        before = listing()
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL):
            with self.subTest(number), subprocess.Popen([program("reconstruction"), "in.ply", "out.ply", "-sphere",
                                                         "pipe.ply"]) as tool:  # fmt: skip
                end = time.monotonic() + 20
                while tool.poll() is None and not glob.glob(".spherical_param.*") and time.monotonic() < end:
                    time.sleep(0.0001)
                tool.send_signal(number)
                try:
                    self.assertEqual(tool.wait(20), -number)
                finally:
                    tool.kill()
                if number != signal.SIGKILL:
                    self.assertTrue(listing() == before)
                self.assertEqual(pathlib.Path("out.ply").read_text(), "kept")
