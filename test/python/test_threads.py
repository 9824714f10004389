"""Other Python threads, signals, progress and memory while the package works."""

import gc
import io
import os
import signal
import subprocess
import sys
import threading
import time
import traceback
import tracemalloc
import unittest
from contextlib import redirect_stderr

import numpy as np
import shapes
import spherical_param as sp

STAGES = ["view", "neighbors", "graph", "outliers", "parts"]
STAGES += ["consolidation", "openings", "embedding", "triangulation", "optimization", "cleaning", "quality"]

INTERRUPTED = """
import signal, traceback
signal.signal(signal.SIGINT, signal.default_int_handler)
import shapes, spherical_param
points = shapes.bumpy(10000)
print("ready", flush=True)
try:
    while True:
        spherical_param.reconstruct(points)
except KeyboardInterrupt as error:
    print(*(frame.name for frame in traceback.extract_tb(error.__traceback__)), flush=True)
"""


def in_thread(work, *arguments):
    thread = threading.Thread(target=work, args=arguments)
    thread.start()
    return thread


class Threads(unittest.TestCase):
    def test_other_threads_run_meanwhile(self):
        points, works = shapes.bumpy(4000), threading.Event()

        def work():
            works.set()
            sp.reconstruct(points, threads=1)

        # A thread that does not give up the interpreter by itself keeps it.
        self.addCleanup(sys.setswitchinterval, sys.getswitchinterval())
        sys.setswitchinterval(1000.0)
        worker = in_thread(work)
        works.wait()
        turns = 0
        while worker.is_alive() and turns < 10:
            time.sleep(0.001)
            turns += worker.is_alive()
        worker.join()
        self.assertEqual(turns, 10)

    def test_several_at_once_and_any_number_of_threads_give_the_same_bytes(self):
        points, found = shapes.bumpy(1000), {}

        def run(threads):
            mesh = sp.reconstruct(points, threads=threads, details=True)
            new = sp.remesh(mesh, points=162, sweeps=3, threads=threads)
            found[threads] = mesh.sphere.tobytes() + new.vertices.tobytes()

        run(1)
        for worker in [in_thread(run, 0), in_thread(run, 2)]:
            worker.join()
        self.assertEqual(found, dict.fromkeys((0, 1, 2), found[1]))


class Progress(unittest.TestCase):
    def test_stages_are_reported_from_beginning_to_end_and_false_ends_them(self):
        points, thread = shapes.bumpy(300), threading.get_ident()
        mesh = sp.reconstruct(points)
        self.assertEqual(list(mesh.stages), STAGES)
        remeshing = ["map", "surface", "resample", "untangle", "intersections"]
        for stages, function, arguments, options in (
            (STAGES, sp.reconstruct, [points], {}),
            (remeshing, sp.remesh, [mesh], {"points": 200, "sweeps": 3}),
            (["map", "morph"], sp.morph, [mesh, mesh], {"sweeps": 0}),
            (["neighbors", "graph", "outliers"], sp.find_outliers, [points], {}),
            (["neighbors", "graph", "outliers", "parts"], sp.find_parts, [points], {}),
        ):
            told = []

            def listen(*state):
                self.assertEqual(threading.get_ident(), thread)
                told.append(state)

            function(*arguments, threads=1, progress=listen, **options)
            self.assertEqual(list(dict.fromkeys(stage for stage, _ in told)), stages)
            self.assertTrue(all(0.0 <= fraction <= 1.0 for _, fraction in told))
            for stage in stages:
                self.assertEqual([fraction for name, fraction in told if name == stage][-1], 1.0)
                with self.assertRaises(sp.Cancelled):
                    end = lambda name, _: np.bool_(name != stage)  # noqa: E731
                    function(*arguments, threads=1, progress=end, **options)

    def test_true_is_a_bar_for_each_stage(self):
        error = io.StringIO()
        with redirect_stderr(error):
            sp.reconstruct(shapes.bumpy(300), progress=True)
        lines = [line.split("\r")[-1] for line in error.getvalue().split("\n")[:-1]]
        self.assertEqual([*dict.fromkeys(line.split()[0] for line in lines)], STAGES)
        self.assertTrue(all("100 %" in line and "#" * 25 in line for line in lines))
        for ignored in (False, lambda *_: 0):  # only False ends the work
            sp.reconstruct(shapes.bumpy(50), progress=ignored)

    def test_exceptions_of_the_function_come_out_as_they_are(self):
        error = LookupError("mine")

        def fail(stage, *_):
            if stage == "graph":
                raise error

        try:
            sp.reconstruct(shapes.bumpy(500), progress=fail)
            self.fail("nothing was raised")
        except LookupError as raised:
            self.assertIs(raised, error)
            names = [frame.name for frame in traceback.extract_tb(raised.__traceback__)]
            self.assertIn("fail", names)
        with self.assertRaises(TypeError):
            sp.reconstruct(shapes.bumpy(500), progress=lambda: None)


class Signals(unittest.TestCase):
    def test_ctrl_c_ends_long_work_within_the_call(self):
        folder = os.path.dirname(os.path.abspath(__file__))
        process = subprocess.Popen([sys.executable, "-c", INTERRUPTED], stdout=subprocess.PIPE, text=True, cwd=folder)
        self.addCleanup(process.kill)
        self.assertEqual(process.stdout.readline(), "ready\n")
        time.sleep(0.1)  # into the work
        process.send_signal(signal.SIGINT)
        self.assertIn("reconstruct", process.communicate(timeout=100)[0].split())
        self.assertEqual(process.returncode, 0)

    def test_handlers_of_signals_run_during_the_work(self):
        caught, told = [], []
        before = signal.signal(signal.SIGUSR1, lambda *_: caught.append(len(told)))
        self.addCleanup(signal.signal, signal.SIGUSR1, before)

        def listen(*state):
            told.append(state)
            if len(told) == 3:
                signal.raise_signal(signal.SIGUSR1)

        sp.reconstruct(shapes.bumpy(500), progress=listen)
        self.assertEqual(len(caught), 1)
        self.assertLess(caught[0], len(told))


class Memory(unittest.TestCase):
    def test_calls_leave_nothing_behind(self):
        points = shapes.bumpy(300)

        def fail(stage, *_):
            if stage == "graph":
                raise LookupError

        def round_of_calls():
            sp.remesh(sp.reconstruct(points, threads=1, smoothing=1), threads=1, sweeps=1)
            with self.assertRaises(LookupError):
                sp.reconstruct(points, threads=1, progress=fail)
            with self.assertRaises(sp.InvalidInput):
                sp.reconstruct(points[:3])

        tracemalloc.start()
        self.addCleanup(tracemalloc.stop)
        sizes, counts = [], []
        for _ in range(6):
            round_of_calls()
            gc.collect()
            sizes.append(tracemalloc.get_traced_memory()[0])  # with NumPy's arrays
            counts.append([sys.getrefcount(held) for held in (points, fail, sp.InvalidInput)])
        self.assertEqual(counts[5], counts[2])
        # The arrays of a round are some 100 kB.
        self.assertLess(sizes[5] - sizes[2], 20000)
