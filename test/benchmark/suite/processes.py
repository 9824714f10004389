"""Runs programs and measures their time from outside.

Not their memory: what the system tells of a child starts with the memory of the process that made
it, which is this one with its modules. The programs tell their own.
"""

import dataclasses
import os
import statistics
import subprocess
import tempfile
import threading
import time


class Failure(Exception):
    """Something that the user can mend: a cause and a remedy, a line each."""

    def __init__(self, cause, remedy):
        super().__init__(cause)
        self.cause = cause
        self.remedy = remedy


@dataclasses.dataclass
class Run:
    """What a process took and said."""

    seconds: float  # wall time
    cpu_seconds: float  # of all its threads, user and system
    exit_code: int  # negative: the signal that ended it
    timed_out: bool
    output: str
    errors: str

    @property
    def good(self):
        return self.exit_code == 0 and not self.timed_out


def run(command, timeout=None, threads=None):
    """Runs a command to its end, for at most `timeout` seconds, with so many OpenMP threads."""
    environment = dict(os.environ)
    if threads is not None:
        environment["OMP_NUM_THREADS"] = str(threads)
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
        start = time.monotonic()
        process = subprocess.Popen(
            [str(word) for word in command],
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=errors,
            env=environment,
        )
        timed_out = threading.Event()

        def stop():
            timed_out.set()
            process.kill()

        timer = threading.Timer(timeout, stop) if timeout else None
        if timer:
            timer.start()
        # wait4() and not Popen.wait(): it tells what this one child used.
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.monotonic() - start
        if timer:
            timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        errors.seek(0)
        return Run(
            seconds=seconds,
            cpu_seconds=usage.ru_utime + usage.ru_stime,
            exit_code=process.returncode,
            timed_out=timed_out.is_set(),
            output=output.read().decode(errors="replace"),
            errors=errors.read().decode(errors="replace"),
        )


def check(command, result):
    """Raises Failure with the program's last words if it did not do what it should."""
    if not result.good:
        words = " ".join(str(word) for word in command)
        said = [line for line in result.errors.splitlines() if line.strip()]
        reason = "it took too long" if result.timed_out else f"exit code {result.exit_code}"
        raise Failure(
            f"'{words}' failed, {reason}: {said[0] if said else 'no message'}",
            said[1] if len(said) > 1 else "run that command by itself to see more",
        )
    return result


def require(command, timeout=None, threads=None):
    """run() for what must not fail."""
    return check(command, run(command, timeout, threads))


def in_turn(commands, repeats, timeout=None, long_run=4.0):
    """Runs commands in turn, so that a busy machine is shared fairly: a list of runs for each.

    A command that took longer than `long_run` seconds, or failed, is not repeated.
    """
    runs = [[] for _ in commands]
    for _ in range(repeats):
        for command, done in zip(commands, runs):
            if not done or (done[-1].good and done[-1].seconds <= long_run):
                done.append(run(command, timeout))
    return runs


def median_seconds(runs):
    return statistics.median(one.seconds for one in runs)
