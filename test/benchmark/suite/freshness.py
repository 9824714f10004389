"""Are the numbers in the README still true? Measures what takes seconds of it again.

Of the generated scans, our own rows, but for the largest; no times. And the commit that the README
says it was measured at has to be one that led to this one.
"""

import argparse
import pathlib
import subprocess
import sys
import tempfile

from . import comparison, readme
from .processes import Failure
from .product import Programs
from .tables import Table

MAX_POINTS = 20000


def commit_problem(path):
    """What is wrong with the commit that the README quotes; None if nothing, or if there is no
    history to look it up in."""
    commit = readme.quoted_commit(path)
    if commit is None:
        return "the README does not say at which commit it was measured"

    def git(*arguments):
        return subprocess.run(("git", "-C", str(path.parent), *arguments),
                              capture_output=True, text=True, check=False)  # fmt: skip

    try:
        shallow = git("rev-parse", "--is-shallow-repository")
    except OSError:
        return None
    if shallow.returncode != 0 or shallow.stdout.strip() == "true":
        return None
    if git("merge-base", "--is-ancestor", commit, "HEAD").returncode != 0:
        return f"the README was measured at {commit}, which is no ancestor of this commit"
    return None


def measure_again(programs, path, work):
    """A table like that of the report, with those rows of the README that take seconds."""
    table = Table("generated", comparison.QUALITY, keys=2)
    titles, rows = readme.quoted_tables(path)["generated"]
    for row in rows:
        name, method = row[:2]
        if method != comparison.OURS:
            continue
        cloud = programs.make_scan(name, work)
        if cloud.points.stat().st_size > 12 * MAX_POINTS + 1000:
            continue
        mesh = work / "mesh.ply"
        programs.reconstruct(cloud.points, mesh)
        quality = comparison.quality_row(programs.measure(mesh, cloud))
        table.rows.append({"model": name, "method": method, **quality})
    return table


def main(words):
    parser = argparse.ArgumentParser(prog="freshness", description=__doc__)
    parser.add_argument("--programs", type=pathlib.Path, required=True)
    parser.add_argument("--readme", type=pathlib.Path, required=True)
    arguments = parser.parse_args(words)
    with tempfile.TemporaryDirectory() as work:
        table = measure_again(Programs(arguments.programs), arguments.readme, pathlib.Path(work))
    differences, compared = readme.check(arguments.readme, readme.results_of([table]), times=False)
    problem = commit_problem(arguments.readme)
    if problem:
        differences.append(problem)
    for difference in differences:
        print(difference)
    print(f"{len(table.rows)} clouds, {compared} numbers compared, {len(differences)} differ")
    if differences:
        print("run tools/benchmark.sh OUT --update-readme")
    return 1 if differences or len(table.rows) < 3 else 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except Failure as failure:
        print(f"{failure.cause}\n{failure.remedy}", file=sys.stderr)
        sys.exit(1)
