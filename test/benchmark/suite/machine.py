"""Where and from what a report was made."""

import datetime
import os
import pathlib
import platform
import re
import subprocess


def memory(name):
    """Bytes, of an entry of Linux such as MemTotal."""
    return 1024 * int(re.search(rf"^{name}:\s*(\d+) kB", pathlib.Path("/proc/meminfo").read_text(), re.MULTILINE)[1])


def _output(*command):
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()


def describe(root, build):
    """A sentence about the commit of a checkout, the machine and the compiler."""
    commit = _output("git", "-C", root, "rev-parse", "--short=10", "HEAD") or "unknown"
    changed = _output("git", "-C", root, "status", "--porcelain", "--untracked-files=no")
    compiler = re.search(r"^CMAKE_CXX_COMPILER:\w+=(.+)$", (build / "CMakeCache.txt").read_text(), re.MULTILINE)[1]
    processor = re.search(r"^model name\s*:\s*(.+)$", pathlib.Path("/proc/cpuinfo").read_text(), re.MULTILINE)
    return (
        f"Measured at commit `{commit}`{' with changes that are not committed' if changed else ''} on "
        f"{datetime.date.today().isoformat()}: {processor[1].strip() if processor else 'unknown'}, "
        f"{len(os.sched_getaffinity(0))} cores, {memory('MemTotal') / 2**30:.0f} GiB, "
        f"{platform.freedesktop_os_release()['PRETTY_NAME']}, {_output(compiler, '--version').splitlines()[0]}."
    )
