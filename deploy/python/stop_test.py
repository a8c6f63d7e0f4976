"""How a program that the package started stops: python3 -m unittest stop_test, with `cairn` on the PATH."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import threading
import time
import unittest
from pathlib import Path
from unittest import mock

import cairn
import folder_case


class StopTest(folder_case.FolderCase):
    def test_an_interrupt_waits_until_the_program_has_saved_what_it_had(self) -> None:
        os.makedirs("fake", exist_ok=True)
        fake = Path("fake/cairn")
        fake.write_text("#!/bin/sh\ntrap 'sleep 0.5; echo yes >saved; exit 130' INT\n: >started\nwhile :; do sleep 0.05; done\n")
        fake.chmod(0o755)

        def interrupt() -> None:
            while not Path("started").exists():
                time.sleep(0.01)
            os.kill(os.getpid(), signal.SIGINT)  # Python alone hears of it, as in a notebook

        before = signal.signal(signal.SIGINT, signal.default_int_handler)
        try:
            with mock.patch.dict(os.environ, PATH=f"{os.getcwd()}/fake:{os.environ['PATH']}"):
                threading.Thread(target=interrupt).start()
                with self.assertRaises(KeyboardInterrupt):
                    cairn.command("run", "job.yaml")
            self.assertEqual(Path("saved").read_text(), "yes\n")
        finally:
            signal.signal(signal.SIGINT, before)

    def python(self, program: str, path: str) -> subprocess.Popen:
        environment = {**os.environ, "PATH": f"{os.getcwd()}/{path}:{os.environ['PATH']}"}
        environment["PYTHONPATH"] = os.pathsep.join(sys.path)
        return subprocess.Popen([sys.executable, "-c", program], env=environment, start_new_session=True, stderr=subprocess.DEVNULL)

    def until(self, is_so) -> None:
        for _ in range(1200):
            if is_so():
                return
            time.sleep(0.05)
        self.fail("it never came to that")

    def program_in(self, folder: str, script: str) -> None:
        os.makedirs(folder)
        Path(folder, "cairn").write_text("#!/bin/sh\n" + script)
        Path(folder, "cairn").chmod(0o755)

    def test_an_interrupt_of_a_terminal_is_one(self) -> None:
        # What a terminal does: a signal to the whole group of processes.
        self.program_in("counts", "trap 'echo signal >>signals' INT\n: >counting\n"
                        "while [ ! -s signals ]; do sleep 0.05; done\nsleep 0.7; : >counted; exit 130\n")
        with self.python("import cairn; cairn.command('run', 'job.yaml')", "counts") as process:
            self.until(Path("counting").exists)
            os.killpg(process.pid, signal.SIGINT)
        self.assertTrue(Path("counted").exists(), "Python waits")
        self.assertEqual(Path("signals").read_text(), "signal\n")

    def test_a_second_interrupt_is_passed_on(self) -> None:
        self.program_in("deaf", "trap 'echo signal >>deaf/signals; [ $(wc -l <deaf/signals) -lt 2 ] || exit 130' INT\n"
                        ": >deaf/on\nwhile :; do sleep 0.05; done\n")
        with self.python("import cairn; cairn.command('run', 'job.yaml')", "deaf") as process:
            self.until(Path("deaf/on").exists)
            os.killpg(process.pid, signal.SIGINT)
            self.until(Path("deaf/signals").exists)
            os.killpg(process.pid, signal.SIGINT)
        self.assertEqual(Path("deaf/signals").read_text(), "signal\nsignal\n")

    def test_a_run_ends_with_python_having_saved(self) -> None:
        self.program_in("tells", f"echo $$ >tells/id\nexec {shutil.which('cairn')} \"$@\"\n")
        call = "import cairn; cairn.run('landmark_map', 'log.h5', out='ended', options={'iterations': 10000, 'starts': 100}, workers=1)"
        with self.python(call, "tells") as process:
            self.until(lambda: any(Path("ended").glob(".cairn/*.sqlite")))
            process.kill()
        status = Path(f"/proc/{Path('tells/id').read_text().strip()}/status")
        self.until(lambda: not status.exists() or "State:\tZ" in status.read_text())
        self.assertFalse(Path("ended/landmark_map.h5").exists(), "it was not done yet")
        self.assertTrue(any(Path("ended").glob(".cairn/checkpoints/*/*.h5")))
        self.assertFalse(Path("ended/.cairn/jobs.sqlite-wal").exists(), "it ended in order, by no write to a pipe")

    def test_a_folder_that_another_run_has_is_busy(self) -> None:
        job = {"options": {"iterations": 10000, "starts": 100}, "workers": 1, "out": "busy"}
        with self.python(f"import cairn; cairn.run('landmark_map', 'log.h5', **{job})", ".") as process:
            self.until(lambda: any(Path("busy").glob(".cairn/*.sqlite")))
            with self.assertRaisesRegex(cairn.BusyError, "in use by another cairn process") as caught:
                cairn.run("landmark_map", "log.h5", **job)
            self.assertEqual(caught.exception.exit_code, 2)
            process.send_signal(signal.SIGINT)
        with self.assertRaises(cairn.InputError) as caught:
            cairn.run("landmark_map", "nowhere.h5")
        self.assertNotIsInstance(caught.exception, cairn.BusyError)


if __name__ == "__main__":
    unittest.main()
