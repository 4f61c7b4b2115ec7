"""Processes that this program starts, each with a process group of its own, and that end with it."""
import os
import signal
import subprocess
import time

GRACE = 2.0  # seconds that a process has to end itself


class Processes:
    """A context: whatever was started within it has ended after it, also after errors and Ctrl-C."""

    def __init__(self):
        self.started = []

    def __enter__(self):
        return self

    def __exit__(self, *error):
        for process in reversed(self.started):
            self.end(process)

    def start(self, words, **options):
        """A subprocess.Popen whose process group is its own."""
        process = subprocess.Popen(words, start_new_session=True, **options)
        self.started.append(process)
        return process

    def end(self, process):
        """Ends a process and its group; kills what does not end within GRACE."""
        if process not in self.started:
            return
        self.started.remove(process)
        for number in (signal.SIGTERM, signal.SIGKILL):
            try:
                os.killpg(process.pid, number)
            except ProcessLookupError:
                break
            deadline = time.monotonic() + GRACE
            while process.poll() is None and time.monotonic() < deadline:
                time.sleep(0.02)
        process.wait()
