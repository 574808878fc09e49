"""Calls while they last: progress, cancelling, Ctrl-C, time limits, other threads, and what callbacks raise."""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import support
from support import BOX, ball, np

import laves

HUGE = dict(source="sphere(1)", size=0.004)  # more than any of these tests waits for
# Waiting for an answer that comes within 0.2 s on a machine of its own; these tests assert no time but that they end at all.
PATIENCE = 60


class Progress(unittest.TestCase):
    def test_it_is_called_from_the_calling_thread(self):
        said = []
        laves.mesh("sphere(1)", size=0.05, progress=lambda phase, fraction: said.append((phase, fraction, threading.get_ident())))
        self.assertGreaterEqual({phase for phase, _, _ in said}, {"classify", "improve"})
        self.assertTrue(all(0 <= fraction <= 1 for _, fraction, _ in said))
        self.assertEqual({thread for _, _, thread in said}, {threading.get_ident()})

    def test_false_cancels(self):
        calls = []

        def stop(phase, fraction):
            calls.append(phase)
            return len(calls) < 3

        with self.assertRaises(laves.CancelledError) as cancelled:
            laves.mesh(**HUGE, progress=stop)
        self.assertEqual(cancelled.exception.exit_code, 130)
        self.assertEqual(len(calls), 3)

    def test_what_it_raises_comes_through(self):
        def fail(phase, fraction):
            raise KeyError("of the callback")

        domain = laves.Domain("sphere(1)")
        with self.assertRaisesRegex(KeyError, "of the callback"):
            domain.mesh(size=0.05, progress=fail)
        self.assertGreater(domain.mesh(size=0.2).tet_count, 1000)  # and nothing is left of it

    def test_timeout(self):
        with self.assertRaisesRegex(TimeoutError, "0.05 seconds") as over:
            laves.mesh(**HUGE, timeout=0.05)
        self.assertIsInstance(over.exception, laves.TimeoutError)

    def test_an_object_is_not_used_by_its_own_callback(self):
        domain = laves.Domain("sphere(1)")
        with self.assertRaisesRegex(RuntimeError, "its own callback"):
            domain.mesh(size=0.1, progress=lambda *_: domain.mesh(size=0.5))

    def test_other_calls_report_and_are_cancelled(self):
        mesh = laves.mesh("sphere(1)", size=0.05)
        for call in (mesh.check, mesh.certify, lambda progress: mesh.check(mesh.domain, progress=progress),
                     lambda progress: mesh.write(os.devnull, "vtu", progress=progress)):
            self.assertRaises(laves.CancelledError, call, progress=lambda *_: False)


class Interrupt(unittest.TestCase):
    def run_until_interrupted(self, code):
        """Runs code in a process of its own, sends Ctrl-C once it says so, and returns what it printed."""
        with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as child:
            self.assertEqual(child.stdout.readline(), "ready\n")
            time.sleep(0.1)
            child.send_signal(signal.SIGINT)
            try:
                out, err = child.communicate(timeout=PATIENCE)
            except subprocess.TimeoutExpired:
                child.kill()
                self.fail("Ctrl-C is not answered")
        return out, err, child.returncode

    def test_keyboard_interrupt(self):
        out, err, code = self.run_until_interrupted("""
import laves, signal
print("ready", flush=True)
try:
    laves.mesh("sphere(1)", size=0.004)
except KeyboardInterrupt:
    print("interrupted", signal.getsignal(signal.SIGINT) is signal.default_int_handler)
    print(laves.mesh("sphere(1)", size=0.5).check().valid)
""")
        self.assertEqual((out, err, code), ("interrupted True\nTrue\n", "", 0))

    def test_keyboard_interrupt_with_callbacks(self):
        out, err, code = self.run_until_interrupted("""
import laves, numpy as np
print("ready", flush=True)
try:
    laves.mesh(lambda p: np.linalg.norm(p, axis=1) - 1, bounds=[[-2] * 3, [2] * 3], size=0.01, progress=lambda phase, fraction: None)
except KeyboardInterrupt:
    print("interrupted")
""")
        self.assertEqual((out, err, code), ("interrupted\n", "", 0))

    def test_ones_own_handler(self):
        out, err, code = self.run_until_interrupted("""
import laves, signal
def handler(number, frame):
    raise RuntimeError("my own")
signal.signal(signal.SIGINT, handler)
print("ready", flush=True)
try:
    laves.mesh("sphere(1)", size=0.004)
except RuntimeError as e:
    print(e, signal.getsignal(signal.SIGINT) is handler)
""")
        self.assertEqual((out, err, code), ("my own True\n", "", 0))

    def test_a_handler_that_only_notes(self):
        out, err, code = self.run_until_interrupted("""
import laves, signal
noted = []
signal.signal(signal.SIGINT, lambda number, frame: noted.append(number))
print("ready", flush=True)
while not noted:
    mesh = laves.mesh("sphere(1)", size=0.04)
print(mesh.check().valid, len(noted))
""")
        self.assertEqual((out, err, code), ("True 1\n", "", 0))


class Threads(unittest.TestCase):
    def test_python_goes_on(self):
        """Another thread of Python counts while the library works without a callback."""
        count, done = [0], threading.Event()

        def work():
            while not done.is_set():
                count[0] += 1
                time.sleep(0.0005)

        other = threading.Thread(target=work)
        other.start()
        before = count[0]
        laves.mesh("sphere(1)", size=0.02, threads=1)
        during = count[0] - before
        done.set()
        other.join()
        self.assertGreater(during, 20)

    def test_two_meshes_at_once(self):
        wanted = [laves.mesh("sphere(1)", size=0.05).hash, laves.mesh(ball, bounds=BOX, size=0.1).hash]
        found = {}

        def work(i):
            for k in range(3):
                source = {"source": "sphere(1)", "size": 0.05} if i % 2 == 0 else {"source": ball, "bounds": BOX, "size": 0.1}
                found[i, k] = laves.mesh(**source).hash

        workers = [threading.Thread(target=work, args=(i,)) for i in range(4)]
        for w in workers:
            w.start()
        for w in workers:
            w.join()
        self.assertEqual({key: wanted[key[0] % 2] for key in found}, found)
        self.assertEqual(len(found), 12)

    def test_one_domain_from_two_threads(self):
        domain = laves.Domain("sphere(1) - cylinder{r=0.4}")
        wanted, found = domain.mesh(size=0.1).hash, []
        workers = [threading.Thread(target=lambda n=n: found.append(domain.mesh(size=0.1, threads=n).hash)) for n in (None, 1, 2)]
        for w in workers:
            w.start()
        for w in workers:
            w.join()
        self.assertEqual(found, [wanted] * 3)

    def test_cancelled_from_another_thread(self):
        stop = threading.Event()
        threading.Timer(0.05, stop.set).start()
        with self.assertRaises(laves.CancelledError):
            laves.mesh(**HUGE, progress=lambda *_: not stop.is_set())


class Functions(unittest.TestCase):
    def test_what_they_raise_comes_through(self):
        calls = [0]

        def phi(points):
            calls[0] += 1
            if calls[0] > 20:
                raise ZeroDivisionError("of the function")
            return ball(points)

        domain = laves.Domain(phi, bounds=BOX)
        with self.assertRaisesRegex(ZeroDivisionError, "of the function"):
            domain.mesh(size=0.02)
        with self.assertRaisesRegex(ZeroDivisionError, "of the function"):
            domain.evaluate([[0, 0, 0]])
        calls[0] = -10**9
        self.assertGreater(domain.mesh(size=0.3).tet_count, 500)

    def test_answers_of_the_wrong_shape(self):
        for phi, sentence in ((lambda p: 1.0, "not float"), (lambda p: np.zeros((len(p), 1)), r"not \(\d+, 1\)"),
                              (lambda p: np.zeros(len(p) + 1), r"shape \(\d+,\)"), (lambda p: None, "not NoneType")):
            with self.assertRaisesRegex(ValueError, sentence):
                laves.mesh(phi, bounds=BOX, size=0.5)

    def test_no_value_is_outside(self):
        with np.errstate(invalid="ignore"):
            mesh = laves.mesh(lambda p: np.where(p[:, 0] > 0.5, np.nan, ball(p)), bounds=BOX, size=0.2)
        self.assertLess(mesh.points[:, 0].max(), 0.8)
        self.assertTrue(mesh.check().valid)

    def test_what_was_given_may_be_kept(self):
        kept = []

        def phi(points):
            kept.append((points, points.copy()))
            return ball(points)

        laves.mesh(phi, bounds=BOX, size=0.4)
        self.assertTrue(all((points == then).all() for points, then in kept))

    def test_a_function_may_mesh(self):
        inner = []

        def phi(points):
            if not inner:
                inner.append(laves.mesh("sphere(1)", size=0.5).hash)
            return ball(points)

        laves.mesh(phi, bounds=BOX, size=0.4)
        self.assertEqual(inner, [laves.mesh("sphere(1)", size=0.5).hash])

    def test_checks_ask_them(self):
        mesh = laves.mesh(ball, bounds=BOX, size=0.3)
        self.assertTrue(mesh.check(mesh.domain).has_distance)
        self.assertTrue(mesh.certificate.promise_holds)
        broken = laves.Domain(lambda p: 1 / 0, bounds=BOX)
        with self.assertRaises(ZeroDivisionError):
            mesh.check(broken)


class Files(unittest.TestCase):
    def test_nothing_is_left_of_a_cancelled_file(self):
        mesh = laves.mesh("sphere(1)", size=0.05)
        with tempfile.TemporaryDirectory() as folder:
            self.assertRaises(laves.CancelledError, mesh.write, pathlib.Path(folder, "mesh.vtu"), progress=lambda *_: False)
            self.assertEqual(os.listdir(folder), [])


if __name__ == "__main__":
    support.main()
