"""Runs a program under RenderDoc and has it capture frames.

RenderDoc's layer watches Vulkan. Mesa's zink turns a program's OpenGL, of any version and with fixed functions too, into
Vulkan."""
import os
import subprocess
import threading
import time

import renderdoc as rd

from attempts import EarlyCrash, first_success
from failure import Failure
from redraw import ask_for_redraw

HOST = "127.0.0.1"  # RenderDoc's own default is the name localhost, which not every machine knows
REDRAW_AFTER = 2.0  # seconds without a new picture before the program's windows are asked to draw again
COUNTING = 3.0  # seconds after the time limit within which a program's next picture says how many there were
LAST_WORDS = 0.5  # seconds that are waited for the rest of what a program prints; what it has started may go on

ENVIRONMENT = {"ENABLE_VULKAN_RENDERDOC_CAPTURE": "1", "MESA_LOADER_DRIVER_OVERRIDE": "zink",
               "LIBGL_ALWAYS_SOFTWARE": "1"}


class Recording:
    """`paths` of the captures in the order of frames, and the number of the first frame."""

    def __init__(self):
        self.paths, self.frame = [], None


class _Output:
    """The end of what a program prints. Some print so much that looking at every line would hold them up; this takes
    large pieces and forgets them."""

    def __init__(self, stream):
        self.tail = b""
        self.reader = threading.Thread(target=self._read, args=(stream.fileno(), stream), daemon=True)
        self.reader.start()

    def _read(self, descriptor, stream):
        try:
            while piece := os.read(descriptor, 1 << 20):
                self.tail = (self.tail + piece)[-1000:]
        finally:
            stream.close()

    def last(self):
        self.reader.join(LAST_WORDS)
        lines = [line.strip() for line in self.tail.decode(errors="replace").splitlines() if line.strip()]
        return f' (it last said: "{lines[-1][:200]}")' if lines else ""


def _attach(program):
    """RenderDoc's control of the program or of a process that it has started, or None if there is none yet."""
    ident = rd.EnumerateRemoteTargets(HOST, 0)
    while ident:
        control = rd.CreateTargetControl(HOST, ident, "beampipe", True)
        if control is not None:
            try:
                if os.getpgid(control.GetPID()) == program.pid:
                    return control
            except ProcessLookupError:
                pass
            control.Shutdown()
        ident = rd.EnumerateRemoteTargets(HOST, ident)
    return None


class _Session:
    """One run of the program."""

    def __init__(self, processes, words, display, folder, wishes, progress, deadline):
        self.wishes, self.progress, self.display = wishes, progress, display
        self.start, self.deadline = time.monotonic(), deadline
        environment = {**os.environ, **ENVIRONMENT, "DISPLAY": display,
                       "RENDERDOC_CAPFILE": os.path.join(folder, "capture")}
        try:
            self.program = processes.start(words, env=environment, stdin=subprocess.DEVNULL,
                                           stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        except OSError as error:
            raise Failure(f"{words[0]}: {error.strerror}")
        self.output = _Output(self.program.stdout)
        self.name = os.path.basename(words[0])
        self.result = Recording()
        self.control, self.triggered_at, self.windows, self.cycled = None, None, 0, False
        self.presents, self.refused, self.last_frame = False, "", None

    def run(self):
        """Waits until all frames are captured. Raises Failure."""
        try:
            while len(self.result.paths) < self.wishes.frames:
                self._check()
                if self.control is None:
                    self.control = _attach(self.program)
                    if self.control is None:
                        time.sleep(0.05)
                        continue
                    if self.wishes.frame is not None:
                        self._trigger()
                self._trigger_in_time()
                self._receive()
        finally:
            if self.control is not None:
                self.control.Shutdown()
        return self.result

    def _check(self):
        if self.refused and not self.presents:
            raise Failure(f"RenderDoc cannot capture {self.name} ({self.refused})")
        done = self.program.poll()
        if done is not None:
            how = f"was ended by signal {-done}" if done < 0 else f"ended with exit code {done}"
            seconds = time.monotonic() - self.start
            kind = EarlyCrash if done < 0 and not self.presents else Failure
            raise kind(f"{self.name} {how} after {seconds:.1f} s, {self._before_what()}{self._last_words()}")
        if time.monotonic() > self.deadline:
            what = "frame captured" if self.presents else "picture shown"
            raise Failure(f"{self.name}: no {what} within the time limit ({self._reached()}see --timeout)"
                          f"{self._last_words()}")
        self.progress.show(f"{self.name} runs" + (", capturing" if self.triggered_at else ""))

    def _reached(self):
        """Up to which frame a program came. RenderDoc numbers only frames that it captures."""
        if not self.presents:
            return "0 frames were presented; "
        if self.wishes.frame is None or self.control is None:
            return ""
        self.control.TriggerCapture(1)
        end = time.monotonic() + COUNTING
        before = len(self.result.paths)
        while len(self.result.paths) == before and self.control is not None and time.monotonic() < end:
            self._receive()
        return f"frame {self.last_frame} was reached; " if self.last_frame is not None else ""

    def _before_what(self):
        """What the program has ended without."""
        if not self.presents:
            return "without showing a picture"
        if self.wishes.frame is not None:
            return f"before frame {self.wishes.frame + self.wishes.frames - 1}"
        if self.triggered_at is None:
            return f"before the {self.wishes.after:g} s of --after; --frame 1 takes the first frame"
        return "before another frame"

    def _last_words(self):
        display = os.environ.get("DISPLAY")
        hint = f"; DISPLAY is {display}; without it, a program gets a virtual display"
        return self.output.last() + (hint if display and not self.presents else "")

    def _trigger(self):
        if self.wishes.frame is not None:
            self.control.QueueCapture(self.wishes.frame, self.wishes.frames)
        else:
            self.control.TriggerCapture(self.wishes.frames)
        self.triggered_at = time.monotonic()
        self.asked_at = self.triggered_at

    def _trigger_in_time(self):
        now = time.monotonic()
        if self.wishes.second_window and self.windows > 1 and not self.cycled:
            self.control.CycleActiveWindow()
            self.cycled = True
        if self.triggered_at is None and now - self.start > self.wishes.after:
            self._trigger()
        if self.triggered_at and self.wishes.frame is None and now - self.asked_at > REDRAW_AFTER:
            ask_for_redraw(self.display)  # a program that draws only when it must
            self.asked_at = now

    def _receive(self):
        message = self.control.ReceiveMessage(None)
        kind = rd.TargetControlMessageType
        if message.type == kind.NewCapture:
            capture = message.newCapture
            self.result.paths.append(capture.path)
            self.last_frame = capture.frameNumber
            self.result.frame = capture.frameNumber if self.result.frame is None else self.result.frame
        elif message.type == kind.RegisterAPI:
            use = message.apiUse
            if use.presenting and use.supported:
                self.presents = True
            elif use.presenting:
                self.refused = " ".join(str(use.supportMessage).split()) or f"{use.name} of this kind"
        elif message.type == kind.CapturableWindowCount:
            self.windows = message.capturableWindowCount
        elif message.type == kind.Disconnected:
            # RenderDoc's Vulkan layer goes with an instance that only probes, and comes again with the next.
            self.control.Shutdown()
            self.control, self.triggered_at = None, None
        elif message.type == kind.Noop:
            time.sleep(0.01)


class Wishes:
    """`frame`: the number of the first frame, or None: `after` so many seconds. `frames`: how many in a row.
    `second_window`: RenderDoc's next window shows the frames (apitrace's replayer has a first one that stays empty)."""

    def __init__(self, after, frame, frames, second_window=False):
        self.after, self.frame, self.frames, self.second_window = after, frame, frames, second_window


def record(processes, words, display, folder, wishes, progress, timeout):
    """Captures frames of the program `words`."""
    deadline = time.monotonic() + timeout

    def attempt():
        session = _Session(processes, words, display, folder, wishes, progress, deadline)
        try:
            return session.run()
        finally:
            processes.end(session.program)

    return first_success(attempt)
