#!/usr/bin/python3
"""Runs the fuzzers of the readers over the kept corpus, and on from there.

Nothing is written but below the folder of the work: the corpus is copied there first. A file that
is found to break a reader stays there, and its path is printed.
"""

import argparse
import concurrent.futures
import os
import pathlib
import random
import re
import resource
import shutil
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
KINDS = ("pcd", "ply", "obj", "xyz", "geometry_image", "point_pairs")
FULL_SECONDS = 300  # of each: half an hour of one core in all
QUICK_SECONDS = 7
# What takes more is a finding [s, MB]; longer files [bytes] are only slower.
LIMITS = ("-timeout=10", "-rss_limit_mb=2048", "-malloc_limit_mb=2048", "-max_len=4096")


def run_fuzzer(kind, arguments):
    """Runs one fuzzer. Returns its name, what it says, and its exit code."""
    folder = arguments.work / kind
    for name in ("corpus", "findings", "tmp"):
        (folder / name).mkdir(parents=True)
    for seed in (HERE / "corpus" / kind).iterdir():
        shutil.copy(seed, folder / "corpus")
    environment = dict(os.environ, TMPDIR=str(folder / "tmp"))
    environment.setdefault("UBSAN_OPTIONS", "print_stacktrace=1")
    seconds = QUICK_SECONDS if arguments.quick else FULL_SECONDS
    log = folder / "log"
    with open(log, "wb") as output:
        code = subprocess.call(
            [str(arguments.bin / ("fuzz_" + kind)), *LIMITS, "-print_final_stats=1",
             f"-max_total_time={seconds}", f"-seed={arguments.seed}",
             f"-dict={HERE / 'dictionaries' / (kind + '.dict')}",
             f"-artifact_prefix={folder}/findings/", str(folder / "corpus")],
            stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT, env=environment)
    return kind, log.read_text(errors="replace"), code


def last_number(pattern, text):
    found = re.findall(pattern, text)
    return int(found[-1]) if found else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="seconds instead of half an hour")
    parser.add_argument("--seed", type=int, default=0, help="of the fuzzers; 0: a new one")
    parser.add_argument("bin", type=pathlib.Path, help="folder of the fuzzers")
    parser.add_argument("work", type=pathlib.Path, help="folder to work in; it must not exist")
    arguments = parser.parse_args()
    arguments.work = arguments.work.resolve()
    if arguments.seed == 0:  # quick runs are to be the same each time, as far as they can
        arguments.seed = 1 if arguments.quick else random.randrange(1, 2**31)
    print(f"seed {arguments.seed}")
    arguments.work.mkdir(parents=True)

    start = time.monotonic()
    tried = found = kept = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for kind, text, code in pool.map(lambda kind: run_fuzzer(kind, arguments), KINDS):
            runs = last_number(r"stat::number_of_executed_units:\s*(\d+)", text)
            seeds = sum(1 for _ in (HERE / "corpus" / kind).iterdir())
            corpus = sum(1 for _ in (arguments.work / kind / "corpus").iterdir())
            coverage = last_number(r"cov: (\d+)", text)
            print(f"{kind}: {runs} runs, coverage {coverage}, "
                  f"corpus {seeds} -> {corpus}, exit code {code}")
            findings = sorted((arguments.work / kind / "findings").iterdir())
            # A fuzzer that did not get to run tells nothing, either.
            if code != 0 or findings or runs == 0:
                found += max(1, len(findings))
                print("\n".join(text.splitlines()[-60:]))
                print("\n".join(f"found: {path}" for path in findings))
            tried += runs
            kept += seeds
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = usage.ru_utime + usage.ru_stime
    print(f"row: readers | {len(KINDS)} fuzzers from {kept} files, {cpu:.0f} s of CPU in "
          f"{time.monotonic() - start:.0f} s | {tried} | 0 | {found} | 0")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
