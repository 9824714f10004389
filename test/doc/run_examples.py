#!/usr/bin/python3
"""Runs the marked examples of Markdown files with an installation of this project.

    run_examples.py PREFIX PYTHON_MODULE_FOLDER FILE.md...

An example is a fenced block of sh, cpp or python with the comment "<!-- test -->" before it. Its exit code must be 0.
A sh block runs by "bash -euo pipefail" with PREFIX/bin on the PATH. A cpp block is main.cpp of the CMakeLists.txt in
the cmake block after it. A python block is a script.

The examples of a page run one after the other in a scratch folder, which has scan.ply (a hand of
4,000 points), scan.xyz (the same as text), head.ply and animal.ply (2,000 points each), and what
earlier examples of the page left there.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

MARK = re.compile(r"^<!-- test -->\n+(?:```(?P<language>\w+)\n(?P<text>.*?)^```$)?(?:\n*```cmake\n(?P<project>.*?)^```$)?",
                  re.MULTILINE | re.DOTALL)  # fmt: skip
SCANS = """pcl_spherical_param_scan hand scan.ply -points 4000
pcl_spherical_param_scan hand scan.xyz -points 4000
pcl_spherical_param_scan head head.ply -points 2000
pcl_spherical_param_scan animal animal.ply -points 2000
"""


def run(command, folder):
    """True if the command succeeded. Otherwise its output is printed."""
    done = subprocess.run(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True)  # fmt: skip
    if done.returncode != 0:
        print(f"exit code {done.returncode} of: {' '.join(command)}\n{done.stdout}", flush=True)
    return done.returncode == 0


def run_example(language, text, project, folder, number, prefix):
    if language == "sh":
        return run(["bash", "-euo", "pipefail", "-c", text], folder)
    if language == "python":
        script = folder / f"example_{number}.py"
        script.write_text(text)
        return run([sys.executable, str(script)], folder)
    source, build = folder / f"source_{number}", folder / f"build_{number}"
    source.mkdir()
    (source / "main.cpp").write_text(text)
    (source / "CMakeLists.txt").write_text(project)
    program = re.search(r"add_executable\((\S+)", project)[1]
    return (run(["cmake", "-S", str(source), "-B", str(build), f"-DCMAKE_PREFIX_PATH={prefix}",
                 "-DCMAKE_BUILD_TYPE=Release"], folder)
            and run(["cmake", "--build", str(build)], folder)
            and run([str(build / program)], folder))  # fmt: skip


def main(prefix, module_folder, *pages):
    os.environ["PATH"] = f"{prefix}/bin:{os.environ['PATH']}"
    os.environ["PYTHONPATH"] = module_folder
    passed = failed = 0
    for page in pages:
        with tempfile.TemporaryDirectory() as name:
            folder, text = pathlib.Path(name), pathlib.Path(page).read_text()
            for number, mark in enumerate(MARK.finditer(text)):
                place = f"{page}:{text.count(chr(10), 0, mark.start()) + 1}"
                if mark["language"] not in ("sh", "cpp", "python"):
                    sys.exit(f"{place}: no block of sh, cpp or python follows the mark")
                good = (number > 0 or run(["bash", "-ec", SCANS], folder)) and run_example(
                    mark["language"], mark["text"], mark["project"], folder, number, prefix)
                print(f"{place}: {'passed' if good else 'FAILED'}", flush=True)
                passed, failed = passed + bool(good), failed + (not good)
    print(f"{passed} examples passed, {failed} failed")
    return int(failed > 0 or passed == 0)


if __name__ == "__main__":
    sys.exit(main(*(str(pathlib.Path(word).resolve()) for word in sys.argv[1:])) if len(sys.argv) > 3 else __doc__)
