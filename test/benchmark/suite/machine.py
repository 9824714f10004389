"""Where and from what a report was made."""

import dataclasses
import datetime
import os
import pathlib
import platform
import re
import subprocess


def _first_match(path, pattern, fallback):
    try:
        found = re.search(pattern, pathlib.Path(path).read_text(errors="replace"), re.MULTILINE)
    except OSError:
        found = None
    return found.group(1).strip() if found else fallback


def _output(*command):
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError:
        return None
    return done.stdout.strip() if done.returncode == 0 else None


def _git(root, *arguments):
    return _output("git", "-C", str(root), *arguments)


@dataclasses.dataclass
class Provenance:
    """Commit, machine and date, as printed in the report and in the README."""

    commit: str  # short hash, "unknown" outside of a checkout
    modified: bool  # files of the project differ from that commit
    date: str
    processor: str
    cores: int
    memory_gib: float
    system: str
    compiler: str

    def sentence(self):
        state = " with changes that are not committed" if self.modified else ""
        return (
            f"Measured at commit `{self.commit}`{state} on {self.date}: {self.processor}, "
            f"{self.cores} cores, {self.memory_gib:.0f} GiB, {self.system}, {self.compiler}."
        )


def available_memory():
    """Bytes that a process can use now."""
    kib = _first_match("/proc/meminfo", r"^MemAvailable:\s*(\d+) kB", "0")
    return int(kib) * 1024


def describe(root, build):
    """The provenance of what is measured now, of a checkout and its build folder."""
    compiler = _first_match(build / "CMakeCache.txt", r"^CMAKE_CXX_COMPILER:\w+=(.+)$", "c++")
    version = _output(compiler, "--version") or pathlib.Path(compiler).name
    kib = _first_match("/proc/meminfo", r"^MemTotal:\s*(\d+) kB", "0")
    return Provenance(
        commit=_git(root, "rev-parse", "--short=10", "HEAD") or "unknown",
        modified=bool(_git(root, "status", "--porcelain", "--untracked-files=no")),
        date=datetime.date.today().isoformat(),
        processor=_first_match("/proc/cpuinfo", r"^model name\s*:\s*(.+)$", platform.machine()),
        cores=len(os.sched_getaffinity(0)),
        memory_gib=int(kib) / 2**20,
        system=_first_match("/etc/os-release", r'^PRETTY_NAME="?([^"\n]+)', platform.system()),
        compiler=version.splitlines()[0],
    )
