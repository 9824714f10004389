"""Where and from what a report was made."""

import datetime
import os
import pathlib
import re
import subprocess


def _first_match(path, pattern, fallback="unknown"):
    try:
        found = re.search(pattern, pathlib.Path(path).read_text(errors="replace"), re.MULTILINE)
    except OSError:
        found = None
    return found.group(1).strip() if found else fallback


def _output(*command):
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError:
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""


def available_memory():
    """Bytes that a process can use now."""
    return 1024 * int(_first_match("/proc/meminfo", r"^MemAvailable:\s*(\d+) kB", "0"))


def describe(root, build):
    """A sentence about the commit of a checkout, the machine and the compiler."""
    git = ("git", "-C", str(root))
    commit = _output(*git, "rev-parse", "--short=10", "HEAD") or "unknown"
    changed = _output(*git, "status", "--porcelain", "--untracked-files=no")
    compiler = _first_match(build / "CMakeCache.txt", r"^CMAKE_CXX_COMPILER:\w+=(.+)$", "c++")
    memory = int(_first_match("/proc/meminfo", r"^MemTotal:\s*(\d+) kB", "0")) / 2**20
    version = (_output(compiler, "--version") or pathlib.Path(compiler).name).splitlines()[0]
    processor = _first_match("/proc/cpuinfo", r"^model name\s*:\s*(.+)$")
    system = _first_match("/etc/os-release", r'^PRETTY_NAME="?([^"\n]+)')
    changes = " with changes that are not committed" if changed else ""
    return (
        f"Measured at commit `{commit}`{changes} on {datetime.date.today().isoformat()}: {processor}, "
        f"{len(os.sched_getaffinity(0))} cores, {memory:.0f} GiB, {system}, {version}."
    )
