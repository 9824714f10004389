"""Builds the wheel: CMake compiles the module, with the core in it. All else is in pyproject.toml.

Further options of CMake are taken from the environment variable CMAKE_ARGS.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext
from setuptools.command.sdist import sdist

ROOT = Path(__file__).resolve().parent
BUILD = Path("build", "wheel-files")
# As deep below the root as the builds of the presets, so that the compiler cache has the core.
CMAKE_BUILD = Path("build", "wheel")


def version() -> str:
    found = re.search(
        r"^project\([^)]* VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE
    )
    if not found:
        sys.exit("setup.py: CMakeLists.txt has no version; give one in its project()")
    return found[1]


class CMakeBuild(build_ext):
    def build_extension(self, ext: Extension) -> None:
        settings = {
            "CMAKE_BUILD_TYPE": "Release",
            "BUILD_SHARED_LIBS": "OFF",
            "SPHERICAL_PARAM_BUILD_PYTHON": "ON",
            "SPHERICAL_PARAM_BUILD_PCL": "OFF",
            "SPHERICAL_PARAM_BUILD_TOOLS": "OFF",
            "SPHERICAL_PARAM_PYTHON_INSTALL_DIR": ".",
            # Lets make, too, compile the libraries at the same time.
            "CMAKE_OPTIMIZE_DEPENDENCIES": "ON",
            "Python3_EXECUTABLE": sys.executable,
        }
        try:
            import pybind11

            settings["pybind11_DIR"] = pybind11.get_cmake_dir()
        except ImportError:
            pass  # that of the system
        folder = str(ROOT / CMAKE_BUILD)
        target = Path(self.get_ext_fullpath(ext.name)).resolve().parent.parent
        cmake = ["cmake", "-S", str(ROOT), "-B", folder]
        if "CMAKE_GENERATOR" not in os.environ:
            cmake += ["-G", "Ninja" if shutil.which("ninja") else "Unix Makefiles"]
        # CMake refuses the cache of another generator or folder.
        Path(folder, "CMakeCache.txt").unlink(missing_ok=True)
        shutil.rmtree(Path(folder, "CMakeFiles"), ignore_errors=True)
        cmake += [f"-D{name}={value}" for name, value in settings.items()]
        cmake += shlex.split(os.environ.get("CMAKE_ARGS", ""))
        jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))
        for command in (
            cmake,
            ["cmake", "--build", folder, "--target", "spherical_param_python", "-j", jobs],
            ["cmake", "--install", folder, "--component", "python", "--strip"]
            + ["--prefix", str(target)],
        ):
            try:
                subprocess.run(command, check=True)
            except FileNotFoundError:
                sys.exit("setup.py: cmake was not found; install CMake 3.21 or newer")
            except subprocess.CalledProcessError as error:
                sys.exit(f"setup.py: {command[0]} {command[1]} failed; see above\n{error}")


class SourceDistribution(sdist):
    """With what CMake needs."""

    def make_distribution(self) -> None:
        self.filelist.append("CMakeLists.txt")
        for folder in ("cmake", "include", "src", "tools"):
            self.filelist.extend(
                str(path)
                for path in Path(folder).rglob("*")
                if path.is_file() and "__pycache__" not in path.parts
            )
        super().make_distribution()


(ROOT / BUILD).mkdir(parents=True, exist_ok=True)
setup(
    version=version(),
    ext_modules=[Extension("spherical_param._core", sources=[])],
    cmdclass={"build_ext": CMakeBuild, "sdist": SourceDistribution},
    options={"build": {"build_base": str(BUILD)}, "egg_info": {"egg_base": str(BUILD)}},
)
