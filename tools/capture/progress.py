"""Progress on a terminal, one line that is written over; nothing where standard error is not a terminal."""
import sys
import time


class Progress:
    def __init__(self):
        self.on = sys.stderr.isatty()
        self.start = time.monotonic()
        self.shown, self.last = 0, ""

    def show(self, text):
        """Replaces the line on the terminal."""
        if self.on:
            line = f"{time.monotonic() - self.start:5.1f} s  {text}"[:100]
            if line == self.last:
                return
            self.last = line
            sys.stderr.write("\r" + line.ljust(self.shown))
            sys.stderr.flush()
            self.shown = len(line)

    def clear(self):
        if self.on and self.shown:
            sys.stderr.write("\r" + " " * self.shown + "\r")
            sys.stderr.flush()
            self.shown = 0
