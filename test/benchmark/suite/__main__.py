"""Runs the suite; tools/benchmark.sh builds first and then calls this."""

import argparse
import pathlib
import shutil
import sys
import tempfile
import textwrap
import time

from . import clean, comparison, gallery, machine, maps, paper, scaling, views
from .programs import Failure, Programs, load_clouds
from .report import ROOT, Report

SECTIONS = {
    "clean": ("Clean clouds", clean.section),
    "paper": ("The paper", paper.section),
    "comparison": ("Quality and peers", comparison.section),
    "views": ("Scans", views.section),
    "maps": ("The map to the sphere", maps.section),
    "scaling": ("Scaling", scaling.section),
    "gallery": ("Gallery", gallery.section),
}


class Context:
    """What the sections share: where things are, and how much is wanted."""

    def __init__(self, arguments, work):
        self.arguments, self.out, self.work = arguments, arguments.out, pathlib.Path(work)
        self.quick, self.large = arguments.quick, arguments.large
        self.programs = Programs(arguments.build / "bin", self.work, self.choose(10000, 50000))
        models = load_clouds(arguments.models) if arguments.models else []
        self.handles = [cloud for cloud in models if self.programs.true_genus(cloud)]
        self.models = [cloud for cloud in models if cloud not in self.handles]
        self.scans = sorted((arguments.models / "scans").glob("*.p[cl][dy]")) if arguments.models else []
        self.lost = []  # clouds that are no longer clean
        self.report = Report(self.out)
        self.started = time.monotonic()

    def choose(self, quick, full):
        return quick if self.quick else full

    def say(self, text):
        print(f"[{time.monotonic() - self.started:5.0f} s] {text}", flush=True)


def main(words):
    parser = argparse.ArgumentParser(prog="tools/benchmark.sh", description=__doc__)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("models", type=pathlib.Path, nargs="?")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--large", action="store_true")
    parser.add_argument("--only", choices=SECTIONS, action="append", default=[])
    parser.add_argument("--update-doc", action="store_true")
    parser.add_argument("--clean", type=pathlib.Path, metavar="DIR", action="append", default=[])
    parser.add_argument("--clean-list", type=pathlib.Path, metavar="FILE", default=clean.LIST)
    parser.add_argument("--update-clean", action="store_true")
    parser.add_argument("--build", type=pathlib.Path, required=True)
    arguments = parser.parse_args(words)
    if not arguments.clean and (arguments.update_clean or "clean" in arguments.only):
        raise Failure("no clouds are given to compare", "add --clean DIR")
    sections = arguments.only or [name for name in SECTIONS if name != "clean" or arguments.clean]
    out = arguments.out
    out.mkdir(parents=True, exist_ok=True)
    if any(out.iterdir()) and not (out / "report.md").is_file():
        raise Failure(f"'{out}' has files that are no report", "give a new folder")
    with tempfile.TemporaryDirectory(prefix="work_", dir=out) as work:
        context = Context(arguments, work)
        report = context.report
        provenance = machine.describe(ROOT, arguments.build)
        report.blocks["provenance"] = textwrap.fill(provenance, 120) + "\n"
        report.text(f"""
            # Benchmark report of pcl_spherical_param

            {provenance}

            Times are wall times of whole processes, the median of several runs, unless the text says otherwise.
            Lengths are in percent of the diagonal of the bounding box of the true surface. `-`: not defined, or not
            known.""")
        for name, (title, make) in SECTIONS.items():
            if name in sections:
                report.text(f"## {title}")
                make(context)
    report.write()
    if arguments.update_doc:
        report.update_documents()
        if "gallery" in sections:
            shutil.copytree(out / "gallery", ROOT / "doc" / "gallery", dirs_exist_ok=True)
    context.say(f"report: {out / 'report.md'}")
    if context.lost:
        raise Failure(f"no longer as clean as in the list: {', '.join(context.lost)}",
                      f"repair that, or remove their lines from {arguments.clean_list}")  # fmt: skip


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except Failure as failure:
        sys.exit("benchmark: {}\n{}".format(*failure.args))
    except OSError as error:
        sys.exit(f"benchmark: {error}\ngive another folder, or free some space")
