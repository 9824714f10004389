"""Other Python threads, signals, forks, progress and memory while the package works."""

import gc
import os
import signal
import subprocess
import sys
import threading
import time
import traceback
import unittest

import numpy as np
import shapes
import spherical_param as sp

STAGES = ["neighbors", "graph", "embedding", "triangulation", "optimization", "quality"]

INTERRUPTED = """
import signal, sys, traceback
signal.signal(signal.SIGINT, signal.default_int_handler)
import shapes, spherical_param
points = shapes.bumpy(50000)
print("ready", flush=True)
try:
    while True:
        spherical_param.reconstruct(points)
except KeyboardInterrupt as error:
    print(traceback.extract_tb(error.__traceback__)[-1].name, flush=True)
"""


class Threads(unittest.TestCase):
    def test_other_threads_run_meanwhile(self):
        points = shapes.bumpy(10000)
        works = threading.Event()
        done = threading.Event()

        def work():
            works.set()
            sp.reconstruct(points, threads=1)
            done.set()

        interval = sys.getswitchinterval()
        # A thread that does not give up the interpreter by itself keeps it.
        sys.setswitchinterval(1000.0)
        try:
            worker = threading.Thread(target=work)
            worker.start()
            works.wait()
            turns = 0
            while not done.is_set() and turns < 10:
                time.sleep(0.001)
                turns += not done.is_set()
        finally:
            sys.setswitchinterval(interval)
            worker.join()
        self.assertEqual(turns, 10)

    def test_several_at_once_and_any_number_of_threads_give_the_same_bytes(self):
        points = shapes.bumpy(5000)  # more than a block of sums

        def run(threads):
            mesh = sp.reconstruct(points, threads=threads)
            new = sp.remesh(mesh, points=642, sweeps=3, threads=threads)
            return mesh.triangles.tobytes() + mesh.sphere.tobytes() + new.vertices.tobytes()

        expected = run(1)
        found = {}
        workers = [
            threading.Thread(target=lambda count=count: found.update({count: run(count)}))
            for count in (0, 2)
        ]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        self.assertEqual(found, {0: expected, 2: expected})

    def test_a_forked_process_works_on_after_its_parent_has_worked(self):
        points = shapes.bumpy(3000)
        expected = sp.reconstruct(points, threads=2).triangles.tobytes()
        reader, writer = os.pipe()
        child = os.fork()
        if child == 0:
            try:
                same = sp.reconstruct(points, threads=2).triangles.tobytes() == expected
                os.write(writer, b"same" if same else b"different")
            finally:
                os._exit(0)
        os.close(writer)
        with os.fdopen(reader, "rb") as answer:
            # OpenMP's threads are not those of the child, which would wait for them forever.
            killer = threading.Timer(60.0, os.kill, (child, signal.SIGKILL))
            killer.start()
            self.assertEqual(answer.read(), b"same")
            killer.cancel()
        os.waitpid(child, 0)


class Progress(unittest.TestCase):
    def test_stages_are_reported_from_beginning_to_end_and_false_ends_them(self):
        mesh = sp.reconstruct(shapes.bumpy(500))
        self.assertEqual(list(mesh.stages), STAGES)
        thread = threading.get_ident()
        for run, stages in (
            (lambda **on: sp.reconstruct(mesh.vertices, **on), STAGES),
            (
                lambda **on: sp.remesh(mesh, points=200, sweeps=3, **on),
                ["map", "surface", "resample", "untangle", "intersections"],
            ),
            (lambda **on: sp.find_outliers(mesh.vertices, **on), ["neighbors", "outliers"]),
        ):
            told = []

            def listen(*state):
                self.assertEqual(threading.get_ident(), thread)
                told.append(state)

            run(progress=listen)
            self.assertEqual(list(dict.fromkeys(stage for stage, _ in told)), stages)
            for stage in stages:
                fractions = [fraction for name, fraction in told if name == stage]
                self.assertEqual(fractions[-1], 1.0, stage)
                self.assertTrue(all(0.0 <= fraction <= 1.0 for fraction in fractions))
                for no in (False, np.False_):
                    with self.assertRaises(sp.Cancelled):
                        run(progress=lambda name, _: no if name == stage else True)
            for yes in (None, True, 0, ""):
                run(progress=lambda *_: yes)

    def test_exceptions_of_the_function_come_out_as_they_are(self):
        error = LookupError("mine")

        def fail(stage, *_):
            if stage == "graph":
                raise error

        with self.assertRaises(LookupError) as raised:
            sp.reconstruct(shapes.bumpy(500), progress=fail)
        self.assertIs(raised.exception, error)
        names = [frame.name for frame in traceback.extract_tb(error.__traceback__)]
        self.assertIn("fail", names)
        with self.assertRaises(TypeError):
            sp.reconstruct(shapes.bumpy(500), progress=lambda: None)


class Signals(unittest.TestCase):
    def test_ctrl_c_ends_long_work_within_the_call(self):
        folder = os.path.dirname(os.path.abspath(__file__))
        process = subprocess.Popen(
            [sys.executable, "-c", INTERRUPTED], stdout=subprocess.PIPE, text=True, cwd=folder
        )
        try:
            self.assertEqual(process.stdout.readline(), "ready\n")
            time.sleep(0.1)  # into the work
            process.send_signal(signal.SIGINT)
            where, _ = process.communicate(timeout=100)
        finally:
            process.kill()
        self.assertEqual(where, "reconstruct\n")
        self.assertEqual(process.returncode, 0)

    def test_handlers_of_signals_run_during_the_work(self):
        caught = []
        before = signal.signal(signal.SIGUSR1, lambda *_: caught.append(len(told)))
        told = []

        def listen(*state):
            told.append(state)
            if len(told) == 3:
                signal.raise_signal(signal.SIGUSR1)

        try:
            sp.reconstruct(shapes.bumpy(500), progress=listen)
        finally:
            signal.signal(signal.SIGUSR1, before)
        self.assertEqual(len(caught), 1)
        self.assertLess(caught[0], len(told))


def resident():
    gc.collect()
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


class Memory(unittest.TestCase):
    def test_calls_leave_nothing_behind(self):
        points = shapes.bumpy(300)

        def listen(*_):
            return None

        def stop(stage, *_):
            return stage != "embedding"

        def fail(stage, *_):
            if stage == "graph":
                raise LookupError

        def round_of_calls():
            result = sp.reconstruct(points, progress=listen, smoothing=1, optimization="none")
            sp.remesh(sp.sphere_map(result, sweeps=1), points=100, progress=listen)
            for function, error in ((stop, sp.Cancelled), (fail, LookupError)):
                with self.assertRaises(error):
                    sp.reconstruct(points, progress=function)
            with self.assertRaises(sp.InvalidInput):
                sp.reconstruct(points[:3])
            sp.find_outliers(points)

        def references():
            gc.collect()
            return [sys.getrefcount(one) for one in (points, listen, stop, fail, sp.InvalidInput)]

        for _ in range(10):
            round_of_calls()
        counts, size = references(), resident()
        for _ in range(30):
            round_of_calls()
        self.assertEqual(references(), counts)
        # The arrays of each round are some 80 kB: of all they would be 2.4 MB.
        self.assertLess(resident() - size, 1.2 * 2**20)


if __name__ == "__main__":
    unittest.main()
