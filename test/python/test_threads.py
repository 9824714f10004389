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
points = shapes.bumpy(100000)
print("ready", flush=True)
try:
    while True:
        spherical_param.reconstruct(points)
except KeyboardInterrupt as error:
    print(traceback.extract_tb(error.__traceback__)[-1].name, flush=True)
"""


class Threads(unittest.TestCase):
    def test_other_threads_run_meanwhile(self):
        points = shapes.bumpy(60000)
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
            while not done.is_set() and turns < 20:
                time.sleep(0.001)
                turns += not done.is_set()
        finally:
            sys.setswitchinterval(interval)
            worker.join()
        self.assertEqual(turns, 20)

    def test_two_at_once_give_the_bytes_of_one_after_the_other(self):
        clouds = [shapes.bumpy(8000, seed=1), shapes.ellipsoid(8000, seed=2)]

        def run(points):
            mesh = sp.reconstruct(points)
            new = sp.remesh(mesh, points=642)
            return mesh.triangles.tobytes() + mesh.sphere.tobytes() + new.vertices.tobytes()

        expected = [run(points) for points in clouds]
        found = [b"", b""]

        def work(i):
            found[i] = run(clouds[i])

        workers = [threading.Thread(target=work, args=(i,)) for i in range(2)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        self.assertEqual(found, expected)

    def test_a_forked_process_works_on_after_its_parent_has_worked(self):
        points = shapes.bumpy(20000)
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
    def test_each_stage_is_reported_from_its_beginning_to_its_end(self):
        told = []
        thread = threading.get_ident()

        def listen(*state):
            self.assertEqual(threading.get_ident(), thread)
            told.append(state)

        mesh = sp.reconstruct(shapes.bumpy(5000), progress=listen)
        self.assertEqual(list(dict.fromkeys(stage for stage, _ in told)), STAGES)
        self.assertEqual(list(mesh.stages), STAGES)
        for stage in STAGES:
            fractions = [fraction for name, fraction in told if name == stage]
            self.assertEqual((fractions[0], fractions[-1]), (0.0, 1.0))
            self.assertTrue(all(0.0 <= fraction <= 1.0 for fraction in fractions))

    def test_false_cancels_in_any_stage_and_nothing_else_does(self):
        points = shapes.bumpy(500)
        for no in (False, np.False_):
            for last in STAGES:
                with self.assertRaises(sp.Cancelled):
                    sp.reconstruct(points, progress=lambda stage, *_: no if stage == last else True)
        for yes in (None, True, 0, "", []):
            sp.reconstruct(points, progress=lambda *_: yes)

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
        process = subprocess.Popen(
            [sys.executable, "-c", INTERRUPTED],
            stdout=subprocess.PIPE,
            text=True,
            cwd=os.path.dirname(os.path.abspath(__file__)),
        )
        try:
            self.assertEqual(process.stdout.readline(), "ready\n")
            time.sleep(0.5)  # into the work
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
            result = sp.reconstruct(points, progress=listen, smoothing=1)
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

        for _ in range(20):
            round_of_calls()
        counts, size = references(), resident()
        for _ in range(60):
            round_of_calls()
        self.assertEqual(references(), counts)
        # The arrays of each round are some 80 kB: of all they would be 5 MB.
        self.assertLess(resident() - size, 2 * 2**20)


if __name__ == "__main__":
    unittest.main()
