#!/usr/bin/python3
"""Whether gcc and clang give the same meshes: compiles torture_meshes with both, Release, and
compares what each stage gives for all shapes, and for a folder of models.

    compare_builds.py [--quick] [--models FOLDER] [--build] [FIRST SECOND]

FIRST and SECOND are folders of two builds, else build/release and build/release-clang; --build
makes the second one by its preset. What must be the same is the connectivity; where coordinates
differ, the first stage is named.
"""

import argparse
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[3]
CONNECTIVITY = ("neighbors", "graph", "triangles")


def digests(folder, options):
    command = [folder / "bin" / "torture_meshes", "--digests", *options]
    result = subprocess.run(command, check=False, stdout=subprocess.PIPE, text=True)
    lines = result.stdout.splitlines()
    answers = {}
    for line in lines:
        words = line.rsplit(" ", 3)
        if len(words) == 4:
            cloud, kind, stage, digest = words
            answers.setdefault((cloud, kind), {})[stage] = digest
    if result.returncode != 0 or not answers:
        sys.exit(f"{command[0]} ended with {result.returncode}: {lines[-3:]}")
    return answers


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--models", type=pathlib.Path)
    parser.add_argument("--build", action="store_true")
    parser.add_argument("builds", nargs="*", type=pathlib.Path,
                        default=[ROOT / "build/release", ROOT / "build/release-clang"])
    arguments = parser.parse_args()
    if len(arguments.builds) != 2:
        parser.error("two builds are compared")
    if arguments.build:
        folder = arguments.builds[1]
        for command in (["cmake", "--preset", "release-clang", "-B", folder],
                        ["cmake", "--build", folder, "--target", "torture_meshes"]):
            if subprocess.run(command, cwd=ROOT, check=False,
                              stdout=subprocess.DEVNULL).returncode != 0:
                sys.exit(f"{' '.join(map(str, command))} failed")

    options = ["--quick"] if arguments.quick else []
    if arguments.models:
        options += ["--models", str(arguments.models)]
    first, second = (digests(folder, options) for folder in arguments.builds)
    found = len(set(first) ^ set(second))
    identical = 0
    for key in sorted(set(first) & set(second)):
        stages = [stage for stage in first[key] if first[key][stage] != second[key].get(stage)]
        if not stages:
            identical += 1
            continue
        is_other_mesh = any(stage in CONNECTIVITY for stage in stages)
        found += is_other_mesh
        print(f"{' '.join(key)}: {'other mesh' if is_other_mesh else 'same mesh'}; "
              f"first difference in {stages[0]}, then {', '.join(stages[1:]) or 'none'}")
    count = len(set(first) | set(second))
    clouds = len({cloud for cloud, _ in first})
    print(f"row: determinism | {clouds} clouds, {count} meshes and maps by gcc and clang: same "
          f"connectivity, {identical} of {count} the same to the last bit | {2 * count} | 0 | "
          f"{found} | 0")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
