"""Processes that this program starts, each with a process group of its own, and that end with it."""
import ctypes
import os
import signal
import subprocess
import time

GRACE = 2.0  # seconds that a process has to end itself
KILLED = 10.0  # seconds after which a process that was killed is no longer waited for
_PR_SET_CHILD_SUBREAPER = 36


def _children():
    """(number, has ended) of this process's children."""
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/stat") as file:
                state, parent = file.read().rpartition(")")[2].split()[:2]
        except OSError:
            continue
        if int(parent) == os.getpid():
            yield int(name), state == "Z"


def _send(child, number):
    """Sends a signal to a child and its group, unless that is this process's own."""
    try:
        group = os.getpgid(child)
        if group == os.getpgrp():
            os.kill(child, number)
        else:
            os.killpg(group, number)
    except (ProcessLookupError, PermissionError):
        pass


class Processes:
    """A context: whatever was started within it has ended after it, also after errors and Ctrl-C, and also what was
    started by what was started. From its end on, this process ignores signals that ask it to end."""

    def __init__(self):
        self.started = []

    def __enter__(self):
        self.strangers = {child for child, _ in _children()}  # a shell may have started some before it became us
        ctypes.CDLL(None).prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)  # children whose parent has ended become ours
        return self

    def __exit__(self, *error):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, signal.SIG_IGN)
        told, start = set(), time.monotonic()
        while living := self._living():
            late = time.monotonic() - start > GRACE
            for child in living:
                if late or child not in told:
                    _send(child, signal.SIGKILL if late else signal.SIGTERM)
            told.update(living)
            if time.monotonic() - start > GRACE + KILLED:
                break
            time.sleep(0.02)

    def _living(self):
        """The children that have not ended. Reaps those that have."""
        for process in self.started:
            process.poll()
        living = []
        for child, has_ended in _children():
            if child in self.strangers:
                continue
            if has_ended:
                os.waitpid(child, os.WNOHANG)
            else:
                living.append(child)
        return living

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
