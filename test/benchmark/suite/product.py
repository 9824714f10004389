"""The programs that the suite runs: the project's tools, its referee, its renderer, the peers."""

import dataclasses
import json
import pathlib

from .processes import Failure, require, run

# The paper's own method, with all of its iterations.
PAPER = ("-graph", "knn", "-solver", "iterative", "-hull", "qhull", "-optimize", "none",
         "-attempts", "1", "-stagnation", "0", "-tolerance", "0")  # fmt: skip


@dataclasses.dataclass(frozen=True)
class Cloud:
    """Points to mesh, and what is known of the surface they are from."""

    name: str
    points: pathlib.Path
    truth: pathlib.Path | None = None  # a mesh of the surface
    generated: bool = True


class Programs:
    """The programs in a build folder."""

    def __init__(self, folder, samples=None):
        self.folder = pathlib.Path(folder)
        self.samples = samples  # of the referee on each mesh; None: its default
        self.reconstruction = self._find("pcl_spherical_param_reconstruction")
        self.remesh = self._find("pcl_spherical_param_remesh")
        self.scan = self._find("pcl_spherical_param_scan")
        self.texture = self._find("pcl_spherical_param_texture")
        self.quality = self._find("benchmark_mesh_quality")

    def _find(self, name):
        path = self.folder / name
        if not path.is_file():
            raise Failure(f"there is no program '{path}'", "build it: tools/benchmark.sh does")
        return path

    def optional(self, name):
        """A program that not every machine can build: its path, or None."""
        path = self.folder / name
        return path if path.is_file() else None

    def make_scan(self, name, folder, noise=None, truth=True):
        """A generated scan by its name, SHAPE_POINTS or a preset; made once, then taken from the
        folder.
        """
        shape, _, points = name.partition("_")
        name = f"{name}_noise_{noise}" if noise else name
        truth_file = folder / f"{shape}_truth.ply" if truth else None
        cloud = Cloud(name, folder / f"{name}.ply", truth_file)
        if not cloud.points.is_file() or (truth and not cloud.truth.is_file()):
            command = [self.scan, shape, cloud.points]
            command += ["-points", points] if points else []
            command += ["-noise", noise] if noise else []
            command += ["-truth", cloud.truth] if truth else []
            require(command)
        return cloud

    def reconstruct(self, cloud, mesh, *options, sphere=None, threads=None, timeout=None):
        """Runs the tool on a file of points: what the process took, and the tool's report."""
        report = mesh.with_suffix(".json")
        command = [self.reconstruction, cloud, mesh, "-quiet", "-json", report, *options]
        if sphere:
            command += ["-sphere", sphere]
        process = require(command, timeout, threads)
        return process, json.loads(report.read_text())

    def measure(self, mesh, cloud, sphere=None):
        """The referee's measures of a mesh through a cloud."""
        command = [self.quality, mesh, "-cloud", cloud.points]
        if cloud.truth:
            command += ["-truth", cloud.truth]
            command += ["-samples", self.samples] if self.samples else []
        if sphere:
            command += ["-sphere", sphere]
        return json.loads(require(command).output)

    def measure_mesh(self, mesh, cloud):
        """The referee's measures of a mesh beside the truth, whatever its points are."""
        samples = ["-samples", self.samples] if self.samples else []
        return json.loads(require([self.quality, mesh, "-truth", cloud.truth, *samples]).output)

    def measure_map(self, mesh, sphere):
        """The referee's measures of a mesh alone and of its map to the sphere."""
        return json.loads(require([self.quality, mesh, "-sphere", sphere]).output)


def load_clouds(folder):
    """The models in a folder: points/NAME.ply with truth/NAME.ply, or NAME.ply alone."""
    if not folder.is_dir():
        raise Failure(f"there is no folder '{folder}'", "give one with .ply files of points")
    points = folder / "points" if (folder / "points").is_dir() else folder
    clouds = []
    for path in sorted(points.glob("*.ply")):
        truth = folder / "truth" / path.name
        clouds.append(Cloud(path.stem, path, truth if truth.is_file() else None, generated=False))
    if not clouds:
        raise Failure(f"'{points}' has no .ply files", "give a folder with .ply files of points")
    return clouds


def stage_seconds(report):
    """Seconds of each stage in a report of the tool."""
    seconds = {}
    for stage in report["stages"]:
        seconds[stage["name"]] = seconds.get(stage["name"], 0.0) + stage["seconds"]
    return seconds


class Renderer:
    """Draws meshes, where there is a renderer and a display; else draws nothing."""

    def __init__(self, program):
        self.program = program
        self.problem = None if program else "the renderer is not built: VTK with OpenGL is missing"

    def draw(self, picture, *words):
        """True if the picture was made. After a failure no other is tried."""
        if self.problem:
            return False
        # A virtual display may refuse a program while it is cleaning up after the one before.
        for _ in range(3):
            result = run([self.program, picture, *words], timeout=120)
            if result.good:
                return True
        said = result.errors.strip().splitlines()
        self.problem = said[0] if said else f"the renderer ended with {result.exit_code}"
        return False
