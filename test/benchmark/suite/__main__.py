"""Runs the suite; tools/benchmark.sh builds first and then calls this."""

import argparse
import json
import os
import pathlib
import shutil
import sys
import tempfile
import time

from . import comparison, machine, maps, paper, readme, scaling, stages
from .processes import Failure
from .product import Programs, Renderer, load_clouds
from .report import write_report


class Context:
    """What the sections share: where things are, and how much is wanted."""

    def __init__(self, arguments, models, work):
        self.out = arguments.out
        self.work = work
        self.quick = arguments.quick
        self.large = arguments.large
        self.timeout = 30.0 if arguments.quick else 120.0
        self.programs = Programs(arguments.build / "bin", 20000 if self.quick else None)
        self.renderer = Renderer(self.programs.optional("pcl_spherical_param_render"))
        self.models = models
        self.started = time.monotonic()

    def choose(self, quick, full):
        return quick if self.quick else full

    def scan(self, name, noise=None, truth=True):
        """A generated scan. See Programs.make_scan()."""
        return self.programs.make_scan(name, self.work, noise, truth)

    def save_plot(self, plot, name):
        plot.save(self.out / f"{name}.svg")
        return f"{name}.svg"

    @staticmethod
    def distortion(quality):
        """The columns about the map from the referee's measures."""
        return {
            "angle": quality["map_angle_distortion_mean"],
            "angle_95": quality["map_angle_distortion_p95"],
            "area": quality["map_area_distortion_rms_log2"],
            "inverted": quality["map_inverted_percent"],
            "collapsed": quality["map_collapsed_triangles"],
        }

    def say(self, text):
        print(f"[{time.monotonic() - self.started:5.0f} s] {text}", flush=True)


SECTIONS = {
    "paper": paper.section,
    "comparison": comparison.section,
    "maps": maps.section,
    "scaling": scaling.section,
    "stages": stages.section,
}


class Parser(argparse.ArgumentParser):
    """Tells a wrong command line in two lines."""

    def error(self, message):
        self.exit(2, f"benchmark: {message}\nrun '{self.prog} -h' for what it takes\n")


def parse(words):
    parser = Parser(prog="tools/benchmark.sh", description=__doc__)
    parser.add_argument("out", type=pathlib.Path, help="folder for the report")
    parser.add_argument("models", type=pathlib.Path, nargs="?", help="folder with real models")
    parser.add_argument("--quick", action="store_true", help="a minute's worth")
    parser.add_argument("--large", action="store_true", help="up to ten million points")
    parser.add_argument("--only", choices=SECTIONS, action="append", help="some sections alone")
    parser.add_argument("--keep", action="store_true", help="keep clouds and meshes in OUT/work")
    parser.add_argument("--build", type=pathlib.Path, required=True, help="the build folder")
    parser.add_argument("--readme", type=pathlib.Path, required=True, help="README to compare with")
    parser.add_argument("--update-readme", action="store_true", help="write the numbers there")
    parser.add_argument("--check-only", action="store_true", help="look at this line, do nothing")
    arguments = parser.parse_args(words)
    if arguments.update_readme and (arguments.quick or arguments.only):
        parser.error("the README quotes a whole report: --quick and --only do not go with it")
    return arguments


def prepare(out):
    """Makes the folder of the report; one with other things in it is left alone."""
    try:
        out.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=out):
            pass
    except OSError as error:
        raise Failure(f"cannot write to '{out}': {error.strerror}", "give another folder") from None
    if any(out.iterdir()) and not (out / "results.json").is_file():
        raise Failure(f"'{out}' has files that are no report", "give a new folder")


def main(words):
    arguments = parse(words)
    models = load_clouds(arguments.models) if arguments.models else []
    prepare(arguments.out)
    if arguments.check_only:
        return 0
    root = pathlib.Path(__file__).resolve().parents[3]
    with tempfile.TemporaryDirectory(prefix="work_", dir=arguments.out) as work:
        context = Context(arguments, models, pathlib.Path(work))
        provenance = machine.describe(root, arguments.build)
        sections = [
            make(context) for name, make in SECTIONS.items()
            if not arguments.only or name in arguments.only
        ]  # fmt: skip
        write_report(
            arguments.out, provenance, sections, time.monotonic() - context.started
        )
        if arguments.keep:
            kept = arguments.out / "work"
            shutil.rmtree(kept, ignore_errors=True)
            shutil.copytree(work, kept)
    context.say(f"report: {arguments.out / 'report.md'}")
    results = json.loads((arguments.out / "results.json").read_text())
    if arguments.update_readme:
        for name in readme.update(arguments.readme, results):
            print(f"README: the table {name} is gone, for it was not measured")
        return 0
    differences, compared = readme.check(arguments.readme, results)
    for difference in differences:
        print(difference)
    print(f"README: {compared} numbers compared, {len(differences)} differ")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except Failure as failure:
        print(f"benchmark: {failure.cause}\n{failure.remedy}", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        os._exit(130)
