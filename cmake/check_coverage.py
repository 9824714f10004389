#!/usr/bin/python3
"""Runs tests of a library that clang has instrumented, and checks how much of it they reach.

Prints lines and branches of each file of src/core and include/spherical_param. Exits with 1 if a
test fails, or if the share over all files is below one that is asked for. A line or branch counts
as reached if an instance of its template is; a branch is an outcome, true or false, of a condition.
"""

import argparse
import concurrent.futures
import json
import os
import pathlib
import shutil
import subprocess
import sys

FOLDERS = ("include/spherical_param", "src/core")


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("tests", nargs="+", help="programs of tests")
    parser.add_argument("--source", required=True, type=pathlib.Path, help="root of the sources")
    parser.add_argument("--work", required=True, type=pathlib.Path, help="folder for the counts")
    parser.add_argument("--library", required=True, help="what is tested")
    parser.add_argument("--profdata", default="llvm-profdata")
    parser.add_argument("--cov", default="llvm-cov")
    parser.add_argument("--lines", type=float, default=0.0, help="least share [%%]")
    parser.add_argument("--branches", type=float, default=0.0, help="least share [%%]")
    parser.add_argument("--html", help="folder for the sources with their counts")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="tests at once")
    parser.add_argument("--missed", action="store_true", help="list what is not reached, too")
    parser.add_argument("--reuse", action="store_true", help="the counts of the last run")
    return parser.parse_args()


def run_shard(arguments, test, shard):
    """Runs one of `arguments.jobs` parts of a program's tests; whether they passed."""
    # One file for each library (%m) and process. Tests ask for several threads where it matters;
    # elsewhere threads would wait for each other, and for the counts.
    environment = dict(
        os.environ,
        LLVM_PROFILE_FILE=str(arguments.work / "%m-%p.profraw"),
        GTEST_TOTAL_SHARDS=str(arguments.jobs),
        GTEST_SHARD_INDEX=str(shard),
        OMP_NUM_THREADS="1",
        OMP_WAIT_POLICY="passive",
    )
    name = pathlib.Path(test).name
    log = arguments.work / f"{name}-{shard}.log"
    with open(log, "w", encoding="utf-8") as output:
        # On one processor, since counts are not atomic.
        processors = sorted(os.sched_getaffinity(0))
        result = subprocess.run(
            [test],
            env=environment,
            stdout=output,
            stderr=subprocess.STDOUT,
            check=False,
            preexec_fn=lambda: os.sched_setaffinity(0, {processors[shard % len(processors)]}),
        )
    text = log.read_text(encoding="utf-8", errors="replace")
    if result.returncode == 0:
        print(f"{name}, part {shard + 1}: {text.splitlines()[-1]}", flush=True)
        return True
    print("".join(line for line in text.splitlines(True) if "FAILED" in line))
    print(f"{name}: exit code {result.returncode}, see {log}", flush=True)
    return False


def count(arguments, merged):
    """Runs the tests, and merges what they count."""
    shutil.rmtree(arguments.work, ignore_errors=True)
    arguments.work.mkdir(parents=True)
    runs = [(test, shard) for test in arguments.tests for shard in range(arguments.jobs)]
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        passed = all(list(pool.map(lambda run: run_shard(arguments, *run), runs)))
    raw = sorted(str(file) for file in arguments.work.glob("*.profraw"))
    subprocess.run([arguments.profdata, "merge", "-sparse", "-o", merged, *raw], check=True)
    for file in raw:
        os.remove(file)
    return passed


def export(arguments, merged):
    """What llvm-cov tells of each file in the folders."""
    folders = [str(arguments.source / folder) for folder in FOLDERS]
    output = subprocess.run(
        [arguments.cov, "export", f"-instr-profile={merged}", arguments.library, *folders],
        stdout=subprocess.PIPE,
        check=True,
    ).stdout
    return {
        os.path.relpath(file["filename"], arguments.source): file
        for file in json.loads(output)["data"][0]["files"]
    }


def missed_of(file):
    """The lines that nothing reached, and the outcomes of conditions that never were."""
    # A segment: line, column, count, whether there is a count, whether a region begins, is a gap.
    lines = set()
    segments = file["segments"]
    for segment, following in zip(segments, segments[1:]):
        if segment[3] and segment[2] == 0 and not segment[5]:
            lines.update(range(segment[0], max(segment[0] + 1, following[0])))
    # A branch: from line and column, to line and column, counts of true and of false.
    outcomes = {}
    for line, column, _, _, is_true, is_false, *_ in file.get("branches", []):
        counts = outcomes.setdefault((line, column), [0, 0])
        counts[0] += is_true
        counts[1] += is_false
    conditions = [
        f"{line}:{column} never {never}"
        for (line, column), counts in sorted(outcomes.items())
        for count_, never in zip(counts, ("true", "false"))
        if count_ == 0
    ]
    return sorted(lines), conditions


def row(name, lines, branches):
    """A line of the table; `lines` and `branches` are (reached, all)."""

    def share(part):
        return f"{part[0]:6d} of {part[1]:6d} {percent(part):6.1f} %"

    return f"{name:45s} {share(lines)}   {share(branches)}"


def percent(part):
    return 100.0 * part[0] / part[1] if part[1] else 100.0


def main():
    arguments = parse_arguments()
    merged = str(arguments.work / "merged.profdata")
    passed = True
    if not arguments.reuse:
        passed = count(arguments, merged)
    files = export(arguments, merged)
    total = {"lines": [0, 0], "branches": [0, 0]}
    print(f"\n{'':45s} {'lines':>25s}   {'branches':>25s}")
    for name, file in sorted(files.items()):
        parts = []
        for kind in ("lines", "branches"):
            summary = file["summary"][kind]
            parts.append((summary["covered"], summary["count"]))
            total[kind] = [a + b for a, b in zip(total[kind], parts[-1])]
        print(row(name, *parts))
        if arguments.missed:
            lines, conditions = missed_of(file)
            if lines:
                print("    lines", *lines)
            for condition in conditions:
                print("    " + condition)
    print(row("all", total["lines"], total["branches"]))
    # A source that was not compiled would be left out of the sums.
    compiled = {pathlib.Path(name).name for name in files}
    for source in sorted((arguments.source / "src/core").glob("*.cpp")):
        if source.name not in compiled:
            print(f"src/core/{source.name} was not measured")
            passed = False
    for kind, least in (("lines", arguments.lines), ("branches", arguments.branches)):
        if percent(total[kind]) < least:
            print(f"too few {kind}: {percent(total[kind]):.2f} %, but {least} % are asked for")
            passed = False
    if arguments.html:
        folders = [str(arguments.source / folder) for folder in FOLDERS]
        subprocess.run(
            [
                arguments.cov,
                "show",
                "-format=html",
                "-show-branches=count",
                "-show-instantiations=false",
                f"-output-dir={arguments.html}",
                f"-instr-profile={merged}",
                arguments.library,
                *folders,
            ],
            check=True,
        )
        print(f"counts: {arguments.html}/index.html")
    return 0 if passed else 1


if __name__ == "__main__":
    sys.exit(main())
