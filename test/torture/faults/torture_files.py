#!/usr/bin/python3
"""Files, signals and pipes that go wrong while the tools work.

    torture_files.py [--tools DIRECTORY] [--quick] [--seed N] [PART...]

Parts: paths, full, kill, signals, pipes, memory; all of them by default. Whatever happens, an
old file must be whole, or the new one; a failure must be told by a line of cause and one of remedy;
and nothing else may be left.
"""

import argparse
import ctypes
import json
import os
import random
import resource
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
import threading
import time

PREFIX = "pcl_spherical_param_"
TEMPORARY = ".spherical_param."
OLD = b"what was there before\n"
NOBODY = 65534
# The signals that end a tool politely.
POLITE = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
END_LIMIT = 0.5  # [s] from a signal to the end


def end_limit():
    """More where others use the processors: a program that waits for one cannot end."""
    return END_LIMIT * max(1.0, os.getloadavg()[0] / (os.cpu_count() or 1))


class Count:
    """What the rows of the table hold."""

    def __init__(self):
        self.tried = 0
        self.injected = 0
        self.found = 0
        self.lost = 0

    def find(self, what):
        self.found += 1
        print("FOUND", what, flush=True)

    def lose(self, what):
        self.lost += 1
        print("LOST", what, flush=True)

    def row(self, load):
        print(f"row: faults | {load} | {self.tried} | {self.injected} | {self.found} | {self.lost}",
              flush=True)


class Ended:
    """How a program ended."""

    def __init__(self, process, output, errors):
        self.exit_code = process.returncode if process.returncode >= 0 else None
        self.signal = -process.returncode if process.returncode < 0 else 0
        self.output = output
        self.errors = errors

    def told(self):
        """A line of cause, and one of remedy. OpenMP's runtime prints one of its own before it ends
        the program, which nobody can keep it from."""
        lines = [line for line in self.errors.decode(errors="replace").split("\n")
                 if line and not line.startswith("libgomp: ")]
        return len(lines) == 2 and PREFIX in lines[0] and lines[1].startswith("  remedy: ")

    def __str__(self):
        how = f"signal {self.signal}" if self.signal else f"exit code {self.exit_code}"
        return f"{how}, {self.errors[:300]!r}"


class Job:
    """A run of a tool: its words, the files that it reads and those that it writes."""

    def __init__(self, name, tool, words, inputs, outputs):
        self.name = name
        self.tool = tool
        self.words = words
        self.inputs = inputs
        self.outputs = outputs
        self.right = {}  # contents by name, of those that are the same in each run
        self.seconds = 0.0


class Torture:
    def __init__(self, arguments):
        self.tools = os.path.abspath(arguments.tools)
        self.quick = arguments.quick
        self.random = random.Random(arguments.seed)
        self.count = Count()
        self.work = os.path.realpath(tempfile.mkdtemp(prefix="torture_files."))
        os.chmod(self.work, 0o777)
        self.inputs = os.path.join(self.work, "inputs")
        os.mkdir(self.inputs)
        self.directories = 0
        self.mounts = self.has_mounts()
        self.unprivileged = self.can_be_unprivileged()
        self.jobs = []

    # --- running ---------------------------------------------------------------------------------

    def tool(self, name):
        return os.path.join(self.tools, PREFIX + name)

    def start(self, job, directory, words=None, limits=(), nobody=False, before=None, **streams):
        def prepare():
            for what, value in limits:
                resource.setrlimit(what, (value, value))
            if before:
                before()
            if nobody and os.geteuid() == 0:
                os.setuid(NOBODY)

        streams.setdefault("stdin", subprocess.DEVNULL)
        streams.setdefault("stdout", subprocess.DEVNULL)
        streams.setdefault("stderr", subprocess.PIPE)
        return subprocess.Popen([self.tool(job.tool)] + (words or job.words), cwd=directory,
                                preexec_fn=prepare, **streams)

    def run(self, job, directory, words=None, **how):
        process = self.start(job, directory, words, **how)
        return self.wait(process)

    def wait(self, process):
        try:
            output, errors = process.communicate(timeout=300)
        except subprocess.TimeoutExpired:
            self.count.find(f"{process.args}: does not end")
            process.kill()
            output, errors = process.communicate()
        return Ended(process, output or b"", errors or b"")

    def directory(self, job, old=True, inside=None):
        """A new one with the job's inputs and, if wanted, an old file for each output."""
        self.directories += 1
        path = os.path.join(inside or self.work, str(self.directories))
        os.mkdir(path)
        os.chmod(path, 0o777)
        for name in job.inputs:
            os.symlink(os.path.join(self.inputs, name), os.path.join(path, name))
        for name in job.outputs if old else ():
            self.put(os.path.join(path, name), OLD)
        return path

    @staticmethod
    def put(path, content):
        with open(path, "wb") as file:
            file.write(content)

    @staticmethod
    def get(path):
        try:
            with open(path, "rb") as file:
                return file.read()
        except OSError:
            return None

    def is_right(self, job, name, content):
        if content is None:
            return False
        if name in job.right:
            return content == job.right[name]
        if name.endswith(".json"):
            try:
                return "version" in json.loads(content)
            except ValueError:
                return False
        return content.rstrip().endswith(b"</html>")

    def check(self, job, directory, ended, what, old=True, killed=False):
        """Each output is old or new and whole, as the end says, and nothing else is there."""
        self.count.tried += 1
        where = f"{job.name}: {what}: {ended}"
        before = OLD if old else None
        new = 0
        for name in job.outputs:
            content = self.get(os.path.join(directory, name))
            if content == before:
                continue
            if not self.is_right(job, name, content):
                self.count.lose(f"{where}: {name} is {content and content[:20]!r}, "
                                f"{content and len(content)} bytes")
            new += 1
        known = set(job.inputs) | set(job.outputs)
        rest = [name for name in os.listdir(directory) if name not in known]
        if killed:
            rest = [name for name in rest if not name.startswith(TEMPORARY)]
        if rest:
            self.count.find(f"{where}: leaves {rest}")
        if ended.exit_code == 0:
            if new != len(job.outputs):
                self.count.find(f"{where}: {len(job.outputs) - new} outputs are missing")
        elif ended.exit_code is not None:
            if ended.exit_code != 1 or not ended.told():
                self.count.find(f"{where}: not told as it should be")
            if new:
                self.count.find(f"{where}: {new} outputs are there")
        elif not killed:
            self.count.find(f"{where}: ended by a signal")

    def remove(self, directory):
        shutil.rmtree(directory, ignore_errors=True)

    # --- what there is ---------------------------------------------------------------------------

    def has_mounts(self):
        """A name space for mounts of our own, which are gone with this process."""
        new_name_space = 0x20000
        private, recursive = 1 << 18, 1 << 14
        libc = ctypes.CDLL(None, use_errno=True)
        self.libc = libc
        return (os.geteuid() == 0 and libc.unshare(new_name_space) == 0 and
                libc.mount(b"none", b"/", None, private | recursive, None) == 0)

    def mount(self, path, options):
        os.makedirs(path, exist_ok=True)
        if self.libc.mount(b"tmpfs", path.encode(), b"tmpfs", 0, options.encode()) != 0:
            raise OSError(ctypes.get_errno(), "mount")

    def unmount(self, path):
        self.libc.umount2(path.encode(), 2)

    def can_be_unprivileged(self):
        if os.geteuid() != 0:
            return True
        try:
            process = subprocess.run([self.tool("scan"), "-version"], check=False,
                                     stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                     preexec_fn=lambda: os.setuid(NOBODY))
            return process.returncode == 0
        except OSError:
            return False

    def cloud(self, name, shape, points):
        path = os.path.join(self.inputs, name)
        if not os.path.exists(path):
            subprocess.run([self.tool("scan"), shape, path, "-points", str(points)], check=True,
                           stdout=subprocess.DEVNULL)
        return name

    def learn(self, job):
        """What is right, from a run that nothing disturbs."""
        directory = self.directory(job)
        begin = time.monotonic()
        ended = self.run(job, directory)
        job.seconds = time.monotonic() - begin
        if ended.exit_code != 0:
            sys.exit(f"{job.name} does not work: {ended}")
        for name in job.outputs:
            if not name.endswith((".json", ".html")):
                job.right[name] = self.get(os.path.join(directory, name))
        self.check(job, directory, ended, "undisturbed")
        self.remove(directory)
        return job

    def make_jobs(self):
        small = self.cloud("small.ply", "bird", 400)
        other = self.cloud("other.ply", "head", 300)
        outputs = ["out.ply", "sphere.ply", "report.json"]
        words = [small, "out.ply", "-sphere", "sphere.ply", "-json", "report.json", "-threads", "2"]
        page = Job("reconstruction", "reconstruction", words + ["-report", "page.html"], [small],
                   outputs + ["page.html"])
        directory = self.directory(page)
        if self.run(page, directory).exit_code != 0:
            print("without pages: this build has none")
            page = Job("reconstruction", "reconstruction", words, [small], outputs)
        self.remove(directory)
        self.jobs = [
            page,
            Job("remesh", "remesh",
                [small, "out.ply", "-points", "642", "-sphere", "sphere.ply", "-threads", "2"],
                [small], ["out.ply", "sphere.ply"]),
            Job("image", "remesh", [small, "out.tif", "-side", "33", "-threads", "2"], [small],
                ["out.tif"]),
            Job("morph", "morph",
                [small, other, "out.ply", "-frames", "3", "-json", "report.json", "-threads", "2"],
                [small, other], ["out_000.ply", "out_001.ply", "out_002.ply", "report.json"]),
            Job("texture", "texture",
                [small, "out.glb", "-checker", "8", "-size", "128", "-threads", "2"], [small],
                ["out.glb"]),
            Job("texture of OBJ", "texture",
                [small, "out.obj", "-checker", "8", "-size", "128", "-threads", "2"], [small],
                ["out.obj", "out.mtl", "out.png"]),
            Job("scan", "scan", ["star", "out.pcd", "-points", "300", "-truth", "truth.ply"], [],
                ["out.pcd", "truth.ply"]),
        ]
        for job in self.jobs:
            self.learn(job)

    # --- the parts -------------------------------------------------------------------------------

    def paths(self):
        """Outputs that are something else than a file."""
        for job in self.jobs:
            name = job.outputs[-1] if job.tool == "morph" else job.outputs[0]
            frame = name if job.tool == "morph" else job.outputs[0]
            self.odd_outputs(job, frame)
        self.inputs_as_outputs()

    def odd_outputs(self, job, name):
        def case(what, make, right=None, fails=True, **how):
            """right: what must be there afterwards, by name."""
            directory = self.directory(job)
            path = os.path.join(directory, name)
            os.unlink(path)
            make(path)
            before = self.tree(directory)
            ended = self.run(job, directory, **how)
            self.count.tried += 1
            self.count.injected += 1
            where = f"{job.name}: {what}: {ended}"
            after = self.tree(directory)
            if fails:
                if ended.exit_code not in (1, 2) or not ended.told():
                    self.count.find(f"{where}: not told as it should be")
                if after != before:
                    changed = sorted({entry[0] for entry in set(after) ^ set(before)})
                    self.count.lose(f"{where}: changed {changed}")
            else:
                if ended.exit_code != 0:
                    self.count.find(where)
                for file, kind in (right or {}).items():
                    entry = os.path.join(directory, file)
                    if kind == "link" and not os.path.islink(entry):
                        self.count.lose(f"{where}: the link {file} is gone")
                    if kind == "new" and not self.is_right(job, name, self.get(entry)):
                        self.count.find(f"{where}: {file} is not what it should be")
                    if kind == "old" and self.get(entry) != OLD:
                        self.count.lose(f"{where}: {file} is changed")
                if any(file.startswith(TEMPORARY) for file in os.listdir(directory)):
                    self.count.find(f"{where}: leaves something")
            subprocess.run(["chmod", "-R", "u+w", directory], check=False)
            self.remove(directory)

        beside = "beside" + os.path.splitext(name)[1]

        def link_to(target):
            return lambda path: os.symlink(target, path)

        def link_to_file(path):
            self.put(os.path.join(os.path.dirname(path), beside), OLD)
            os.symlink(beside, path)

        def hard_link(path):
            self.put(path, OLD)
            os.link(path, os.path.join(os.path.dirname(path), beside))

        def loop(path):
            os.symlink(beside, path)
            os.symlink(name, os.path.join(os.path.dirname(path), beside))

        case("a directory", os.mkdir)
        case("a link to a file", link_to_file, {name: "link", beside: "new"}, fails=False)
        case("a dangling link", link_to(beside), {name: "link", beside: "new"}, fails=False)
        case("a link to nowhere", link_to("missing/" + beside))
        case("a link loop", loop)
        case("a link to a directory", link_to("/tmp"))
        case("/dev/null", link_to("/dev/null"), {name: "link"}, fails=False)
        case("/dev/full", link_to("/dev/full"))
        case("hard links", hard_link, {name: "new", beside: "old"}, fails=False)
        if not stat.S_ISCHR(os.stat("/dev/null").st_mode):
            self.count.lose("/dev/null is no device any more")
        if self.unprivileged:
            def read_only_file(path):
                self.put(path, OLD)
                os.chmod(path, 0o444)

            def read_only_directory(path):
                os.chmod(os.path.dirname(path), 0o555)

            case("a read-only file", read_only_file, nobody=True)
            case("a read-only directory", read_only_directory, nobody=True)
        if self.mounts:
            place = os.path.join(self.work, "read-only")
            self.mount(place, "size=1m")
            directory = self.directory(job, inside=place)
            read_only, remount = 1, 32
            self.libc.mount(b"tmpfs", place.encode(), None, read_only | remount, None)
            ended = self.run(job, directory)
            self.count.injected += 1
            self.check(job, directory, ended, "a read-only disk")
            self.unmount(place)
        self.fifo(job, name)

    def fifo(self, job, name):
        """A pipe with a name: read to its end, for a while, or not at all."""
        for what in ("read", "cut off", "not opened"):
            directory = self.directory(job)
            path = os.path.join(directory, name)
            os.unlink(path)
            os.mkfifo(path)
            got = []

            def read(path=path, what=what, got=got):
                with open(path, "rb") as pipe:
                    got.append(pipe.read(-1 if what == "read" else 10))

            reader = threading.Thread(target=read, daemon=True)
            if what != "not opened":
                reader.start()
            process = self.start(job, directory)
            if what == "not opened":
                try:
                    process.wait(job.seconds + 1.0)
                except subprocess.TimeoutExpired:
                    pass
                begin = time.monotonic()
                process.send_signal(signal.SIGINT)
            ended = self.wait(process)
            self.count.tried += 1
            self.count.injected += 1
            where = f"{job.name}: a pipe with a name, {what}: {ended}"
            if what == "read":
                reader.join(10.0)
                if ended.exit_code != 0 or not self.is_right(job, name, got and got[0]):
                    self.count.find(where)
            elif what == "not opened":
                if ended.signal != signal.SIGINT or time.monotonic() - begin > end_limit():
                    self.count.find(where)
            elif not (ended.exit_code == 1 and ended.told() or ended.exit_code == 0):
                self.count.find(where)
            if not stat.S_ISFIFO(os.lstat(path).st_mode):
                self.count.lose(f"{where}: it is no pipe any more")
            if any(file.startswith(TEMPORARY) for file in os.listdir(directory)):
                self.count.find(f"{where}: leaves something")
            self.remove(directory)

    @staticmethod
    def tree(directory):
        """All that is there: names, kinds and contents."""
        entries = []
        for root, directories, files in os.walk(directory):
            for name in directories + files:
                path = os.path.join(root, name)
                if os.path.islink(path):
                    entries.append((path, "link", os.readlink(path)))
                elif os.path.isfile(path):
                    entries.append((path, "file", Torture.get(path)))
                else:
                    entries.append((path, "other", ""))
        return sorted(entries)

    def inputs_as_outputs(self):
        """The input is never written over, by whatever name."""
        job = self.jobs[0]
        for what in ("same", "dots", "link", "hard link", "link of the input"):
            directory = os.path.join(self.work, "same")
            os.mkdir(directory)
            scan = os.path.join(directory, "scan.ply")
            shutil.copy(os.path.join(self.inputs, job.inputs[0]), scan)
            source, target = "scan.ply", "mesh.ply"
            if what == "same":
                target = "scan.ply"
            elif what == "dots":
                target = "../same/./scan.ply"
            elif what == "link":
                os.symlink("scan.ply", os.path.join(directory, "mesh.ply"))
            elif what == "hard link":
                os.link(scan, os.path.join(directory, "mesh.ply"))
            else:
                os.symlink("scan.ply", os.path.join(directory, "mesh.ply"))
                source, target = "mesh.ply", "scan.ply"
            before = self.tree(directory)
            for tool in ("reconstruction", "remesh"):
                again = Job(tool, tool, [source, target], [], [])
                ended = self.run(again, directory)
                self.count.tried += 1
                self.count.injected += 1
                if ended.exit_code != 2 or not ended.told():
                    self.count.find(f"{tool}: output is input, {what}: {ended}")
                if self.tree(directory) != before:
                    self.count.lose(f"{tool}: output is input, {what}: {ended}")
            self.remove(directory)

    def full(self):
        """Files that may not grow, and disks that become full, at each of many points."""
        points = 4 if self.quick else 50
        for job in self.jobs:
            largest = max(len(self.read_reference(job, name)) for name in job.outputs)
            for i in range(points):
                limit = int(largest * 1.05 * i / (points - 1))
                directory = self.directory(job)
                ended = self.run(job, directory, limits=[(resource.RLIMIT_FSIZE, limit)])
                self.count.injected += 1
                self.check(job, directory, ended, f"files of {limit} bytes at most")
                self.remove(directory)
        if not self.mounts:
            print("SKIPPED: without root no disks can be mounted")
            return
        place = os.path.join(self.work, "disk")
        for job in self.jobs:
            total = sum(len(self.read_reference(job, name)) + 8192 for name in job.outputs)
            for i in range(points):
                free = int(total * 1.1 * i / (points - 1))
                size = 1 << 24
                self.mount(place, f"size={size}")
                directory = self.directory(job, inside=place)
                room = os.statvfs(place)
                with open(os.path.join(place, "filler"), "wb") as filler:
                    filler.write(bytes(max(0, room.f_bavail * room.f_bsize - free)))
                ended = self.run(job, directory)
                self.count.injected += 1
                self.check(job, directory, ended, f"a disk with {free} bytes")
                self.unmount(place)
            # No room for another name.
            self.mount(place, "size=16m,nr_inodes=200")
            directory = self.directory(job, inside=place)
            try:
                for i in range(200):
                    self.put(os.path.join(place, f"filler{i}"), b"")
            except OSError:
                pass
            ended = self.run(job, directory)
            self.count.injected += 1
            self.check(job, directory, ended, "a disk without inodes")
            self.unmount(place)

    def read_reference(self, job, name):
        # Reports are not the same twice, but about as large.
        return job.right.get(name, bytes(40000))

    def kill(self):
        """Killed, by what cannot be answered, at random times."""
        times = 12 if self.quick else 50
        for job in self.jobs[:1] if self.quick else self.jobs:
            left = 0
            for i in range(times):
                directory = self.directory(job)
                process = self.start(job, directory)
                # Every other one while it writes.
                if i % 2:
                    self.await_temporary(process, directory)
                    time.sleep(self.random.uniform(0.0, 0.05 * job.seconds))
                else:
                    time.sleep(self.random.uniform(0.0, 1.1 * job.seconds))
                process.kill()
                ended = self.wait(process)
                self.count.injected += 1
                self.check(job, directory, ended, f"killed ({i})", killed=True)
                temporary = [file for file in os.listdir(directory) if file.startswith(TEMPORARY)]
                left += len(temporary)
                # The next run works.
                if temporary or i % 8 == 0:
                    ended = self.run(job, directory)
                    self.check(job, directory, ended, f"after it was killed ({i})", killed=True)
                self.remove(directory)
            print(f"{job.name}: killed {times} times, {left} temporary files were left")

    @staticmethod
    def await_temporary(process, directory):
        while process.poll() is None:
            if any(file.startswith(TEMPORARY) for file in os.listdir(directory)):
                return
            time.sleep(0.0005)

    def signals(self):
        """Told to end, at random times, with clouds of all sizes."""
        sizes = (1000, 20000) if self.quick else (1000, 10000, 50000, 200000)
        times = 6 if self.quick else 30
        variants = [("", []), ("-outliers", ["-outliers", "3"]),
                    ("statistical", ["-outliers", "3", "-outlier-method", "statistical"]),
                    ("-tolerance", ["-tolerance", "1e-8", "-smooth", "3"]),
                    ("paper", ["-graph", "knn", "-solver", "iterative", "-hull", "qhull",
                               "-optimize", "none", "-attempts", "1", "-iterations", "100"])]
        worst = 0.0
        for size in sizes:
            cloud = self.cloud(f"{size}.xyz", "bird", size)
            for variant, words in variants:
                outputs = ["out.ply", "report.json"]
                job = Job(f"{size} points {variant}", "reconstruction",
                          [cloud, "out.ply", "-json", "report.json", "-ascii", "-threads", "2"] +
                          words, [cloud], outputs)
                self.learn(job)
                slowest = 0.0
                for i in range(times):
                    slowest = max(slowest, self.signalled(job, i))
                worst = max(worst, slowest)
                print(f"{job.name}: {job.seconds:.2f} s; after a signal {slowest:.3f} s at most",
                      flush=True)
        for job in self.jobs[1:]:
            for i in range(2 if self.quick else 10):
                worst = max(worst, self.signalled(job, i))
        print(f"from signal to end: {worst:.3f} s at most")

    def signalled(self, job, i):
        """\\return seconds to its end. A time that is too long is tried thrice: the machine may have
        other things to do."""
        which = POLITE[i % len(POLITE)]
        moment = self.random.uniform(0.0, 1.1 * job.seconds)
        for _ in range(3):
            directory = self.directory(job)
            process = self.start(job, directory)
            if i % 5 == 4:
                self.await_temporary(process, directory)
            else:
                time.sleep(moment)
            process.send_signal(which)
            begin = time.monotonic()
            ended = self.wait(process)
            seconds = time.monotonic() - begin
            self.count.injected += 1
            if ended.signal not in (0, which):
                self.count.find(f"{job.name}: told to end by {which}: {ended}")
            self.check(job, directory, ended, f"told to end by {which} after {moment:.3f} s",
                       killed=ended.signal == which)
            if any(file.startswith(TEMPORARY) for file in os.listdir(directory)):
                self.count.find(f"{job.name}: told to end by {which}: leaves something")
            self.remove(directory)
            if seconds > END_LIMIT:
                print(f"{job.name}: {which} after {moment:.3f} s: ended {seconds:.3f} s later, load "
                      f"{os.getloadavg()[0]:.0f}")
            if seconds <= end_limit():
                return seconds
        self.count.find(f"{job.name}: {which} after {moment:.3f} s: too slow")
        return seconds

    def pipes(self):
        """Standard streams that are closed, or close."""
        job = self.jobs[0]
        for name, closed, codes in (("input", 0, (0,)), ("output", 1, (1,)), ("error", 2, (0,))):
            directory = self.directory(job)
            ended = self.run(job, directory, before=lambda closed=closed: os.close(closed))
            self.count.injected += 1
            if ended.exit_code not in codes:
                self.count.find(f"standard {name} closed: {ended}")
            if closed != 2 or ended.exit_code == 0:
                self.check(job, directory, ended, f"standard {name} closed")
            self.remove(directory)
        # All three, and a failure that nobody can be told.
        directory = self.directory(job)
        ended = self.run(job, directory, before=lambda: [os.close(i) for i in range(3)])
        if ended.exit_code != 1:
            self.count.find(f"all standard streams closed: {ended}")
        self.remove(directory)
        for job in self.jobs:
            # One that is read by nobody, one of which ten bytes are, with and without SIGPIPE.
            for bytes_read in (0, 10):
                for handler in (signal.SIG_DFL, signal.SIG_IGN):
                    words = [word for word in job.words if word not in ("-json", "report.json")]
                    outputs = [name for name in job.outputs if name != "report.json"]
                    piped = Job(job.name, job.tool,
                                words + (["-json", "-"] if job.tool != "scan" else []), job.inputs,
                                outputs)
                    piped.right = job.right
                    directory = self.directory(piped)
                    process = self.start(piped, directory, stdout=subprocess.PIPE,
                                         before=lambda h=handler: signal.signal(signal.SIGPIPE, h))
                    if bytes_read:
                        process.stdout.read(bytes_read)
                    process.stdout.close()
                    errors = process.stderr.read()
                    process.wait()
                    self.count.injected += 1
                    self.check(piped, directory, Ended(process, b"", errors),
                               f"a pipe closed after {bytes_read} bytes")
                    self.remove(directory)
        # The standard error has gone: what cannot be told must still not crash.
        job = Job("failing", "reconstruction", ["missing.ply", "out.ply"], [], ["out.ply"])
        directory = self.directory(job)
        process = self.start(job, directory)
        process.stderr.close()
        if process.wait() != 1:
            self.count.find(f"a failure with a closed standard error: {process.returncode}")
        self.count.tried += 1
        self.count.injected += 1
        self.remove(directory)

    def memory(self):
        """Less and less address space."""
        values = 5 if self.quick else 30
        for job in self.jobs[:1] if self.quick else self.jobs:
            def works(limit, words, job=job):
                directory = self.directory(job)
                ended = self.run(job, directory, words, limits=[(resource.RLIMIT_AS, limit)])
                self.remove(directory)
                return ended.exit_code == 0

            def least(words, low, high):
                while high - low > 1 << 20:
                    middle = (low + high) // 2
                    low, high = (low, middle) if works(middle, words) else (middle, high)
                return high

            least_start = least(["-version"], 1 << 24, 1 << 32)
            least_work = least(job.words, least_start, 1 << 33)
            told = 0
            for i in range(values):
                limit = int(least_start + (1.02 * least_work - least_start) * i / (values - 1))
                directory = self.directory(job)
                ended = self.run(job, directory, limits=[(resource.RLIMIT_AS, limit)])
                self.count.injected += 1
                self.check(job, directory, ended, f"{limit} bytes of address space")
                told += ended.exit_code == 1
                self.remove(directory)
            print(f"{job.name}: starts with {least_start >> 20} MiB, works with "
                  f"{least_work >> 20} MiB of address space; refused {told} times", flush=True)


def main():
    parser = argparse.ArgumentParser(description="See the head of this file.")
    parser.add_argument("--tools", default="build/release/bin")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("parts", nargs="*")
    arguments = parser.parse_args()
    # Programs that a shell runs in the background ignore SIGINT, and so would the tools.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    print(f"seed {arguments.seed}")
    torture = Torture(arguments)
    rows = {
        "paths": "outputs that are directories, links, pipes, devices, inputs or read-only",
        "full": "disks and files that become full, at many points",
        "kill": "killed at random times, with old files there",
        "signals": "SIGINT, SIGTERM, SIGHUP at random times: ended within 0.5 s",
        "pipes": "closed streams and broken pipes",
        "memory": "tools with less and less address space",
    }
    bad = 0
    try:
        torture.make_jobs()
        for part, load in rows.items():
            if arguments.parts and part not in arguments.parts:
                continue
            begin = time.monotonic()
            getattr(torture, part)()
            print(f"{part}: {time.monotonic() - begin:.1f} s")
            torture.count.row(load)
            bad += torture.count.found + torture.count.lost
            torture.count = Count()
    finally:
        shutil.rmtree(torture.work, ignore_errors=True)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
