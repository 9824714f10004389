"""Runs the project's tools, the referee and the peers, and measures their time from outside."""

import collections
import contextlib
import dataclasses
import json
import os
import pathlib
import statistics
import subprocess
import sys
import time

import numpy as np

from .quality import Mesh, Referee, compare

# Exit code of our tools if too many triangles intersect. The mesh is written, and measured like others.
NOT_USABLE = 3

LARGE = 1e5  # coordinates [unit of the cloud]: beyond, single precision has steps of 1/128 and more


class Failure(Exception):
    """Something that the user can repair: a cause and a remedy, a line each."""


# The generated scans that stand for those of the paper, of their sizes in its Table 1.
PAPER_SCANS = {"tweety": "bird_19818", "max": "head_52809", "igea": "head_134345"}


@dataclasses.dataclass
class Run:
    seconds: float  # wall time of the whole process
    problem: str  # empty if all is well
    output: str = ""


def run(command, timeout=None):
    """Runs a command to its end, for at most `timeout` seconds."""
    start = time.monotonic()
    try:
        done = subprocess.run([str(word) for word in command], stdin=subprocess.DEVNULL, text=True,
                              capture_output=True, timeout=timeout, check=False)  # fmt: skip
    except subprocess.TimeoutExpired:
        return Run(time.monotonic() - start, f"not done after {timeout:.0f} s")
    seconds, is_done = time.monotonic() - start, done.returncode in (0, NOT_USABLE)
    problem = "" if is_done else (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[0]
    return Run(seconds, problem, done.stdout)


def require(command):
    """run() of what must not fail."""
    done = run(command)
    if done.problem:
        line = " ".join(str(word) for word in command)
        raise Failure(f"'{line}' failed: {done.problem}", "run that command alone to see more")
    return done


def in_turn(commands, repeats, timeout=None, long_run=1.0):
    """A list of runs for each command. In turn, so that another load hits all of them alike.

    A command that takes longer than `long_run` seconds, or fails, is not repeated.
    """
    runs = [[] for _ in commands]
    for _ in range(repeats):
        for command, done in zip(commands, runs):
            if not done or (not done[-1].problem and done[-1].seconds <= long_run):
                done.append(run(command, timeout))
    return runs


@contextlib.contextmanager
def busy_cores():
    """With a process on each core that does nothing but compute."""
    loops = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in os.sched_getaffinity(0)]
    try:
        yield
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()


def median_seconds(runs):
    return statistics.median(one.seconds for one in runs)


def stage_seconds(report):
    """Seconds of each stage in a report of a tool."""
    seconds = collections.Counter()
    for stage in report["stages"]:
        seconds[stage["name"]] += stage["seconds"]
    return seconds


def surfaces_of(report):
    """The reports of its surfaces: of one surface the report itself."""
    return report.get("parts", [report])


def is_sound(report):
    """By the verdict of our tool."""
    return report["usable"] and not report["failures"] and not any(one["is_fault"] for one in report["findings"])


def flat(report, prefix=""):
    """The numbers of a report of a tool by names such as "area_distortion.mean"."""
    numbers = {}
    for name, value in report.items():
        if isinstance(value, dict):
            numbers.update(flat(value, f"{prefix}{name}."))
        elif isinstance(value, (int, float)):
            numbers[prefix + name] = value
    return numbers


@dataclasses.dataclass(frozen=True)
class Cloud:
    """Points to mesh, and a mesh of the surface that they are from, if there is one."""

    name: str
    points: pathlib.Path
    truth: pathlib.Path | None = None
    image: pathlib.Path | None = None  # the points in the order in which a sensor saw them, .pcd


class Programs:
    def __init__(self, folder, work, samples):
        self.folder, self.work, self.samples = folder, work, samples
        self.reconstruction = self.find("pcl_spherical_param_reconstruction")
        self.referee = Referee(self.find("libbenchmark_quality.so"))

    def find(self, name, required=True):
        path = self.folder / name
        if required and not path.is_file():
            raise Failure(f"there is no program '{path}'", "run tools/benchmark.sh, which builds it")
        return path if path.is_file() else None

    def _generate(self, shape, file, **options):
        words = [word for name, value in options.items() if value for word in (f"-{name}", value)]
        require([self.find("pcl_spherical_param_scan"), shape, file, *words])

    def scan(self, name, noise=None, truth=True, views=None):
        """A generated scan, by SHAPE_POINTS or the name of a scan of the paper; made once."""
        shape, points = PAPER_SCANS.get(name, name).rsplit("_", 1)
        name += "".join(f"_{option}_{value}" for option, value in (("noise", noise), ("views", views)) if value)
        cloud = Cloud(name, self.work / f"{name}.ply", self.work / f"{shape}_truth.ply" if truth else None)
        if not cloud.points.is_file() or (truth and not cloud.truth.is_file()):
            self._generate(shape, cloud.points, points=points, noise=noise, views=views, truth=cloud.truth)
        return cloud

    def view(self, name):
        """What a sensor sees of a scene from one place, SCENE or SCENE_POINTS; made once. The sensor is the origin.

        The coordinates of an airborne scan are too large for the single precision of PCL: whole units are subtracted from them
        here, for all methods alike.
        """
        scene, _, points = name.partition("_")
        files = (self.work / f"{name}{end}" for end in (".ply", "_truth.ply", ".pcd"))
        cloud = Cloud(name, *files)
        if not cloud.points.is_file():
            self._generate(scene, cloud.image, points=points, truth=cloud.truth)
            self._generate(scene, cloud.points, points=points)
            low = Mesh.read(cloud.points).points.min(axis=0)
            for path in (cloud.points, cloud.truth) if np.abs(low).max() > LARGE else ():
                mesh = Mesh.read(path)
                Mesh(mesh.points - np.floor(low), mesh.triangles).write(path)
        return cloud

    def reconstruct(self, cloud, mesh, *options):
        """Runs the tool: the process, and the tool's report."""
        process = require([self.reconstruction, cloud.points, mesh, "-quiet", "-json", "-", *options])
        return process, json.loads(process.output)

    def true_genus(self, cloud):
        """Of the true surface; None if that is not known, or no oriented manifold."""
        return self.referee.topology(Mesh.read(cloud.truth))["genus"] if cloud.truth else None

    def measure(self, mesh, cloud=None, sphere=None):
        """The referee's measures of a mesh, by the keys of the tables."""
        mesh = Mesh.read(mesh)
        found = {"vertices": len(mesh.points), "triangles": len(mesh.triangles), **self.referee.topology(mesh),
                 "intersections": self.referee.intersections(mesh)}  # fmt: skip
        truth = Mesh.read(cloud.truth) if cloud and cloud.truth else None
        if cloud:
            found.update(compare(mesh, Mesh.read(cloud.points).points, truth))
        if truth:
            found.update(self.referee.distances(mesh, truth, self.samples))
        if sphere:
            found.update(self.referee.distortion(mesh, Mesh.read(sphere)))
        return found


def load_clouds(folder):
    """The models in a folder: points/NAME.ply and, where it is known, truth/NAME.ply."""
    paths = sorted((folder / "points").glob("*.ply"))
    if not paths:
        raise Failure(f"'{folder}' has no points/NAME.ply", "give the folder of the models")
    truths = [folder / "truth" / path.name for path in paths]
    return [Cloud(path.stem, path, truth if truth.is_file() else None) for path, truth in zip(paths, truths)]
