"""An X display: the user's, or a virtual one of our own."""
import os
import select
import subprocess

from failure import Failure

SIZE = "1280x800x24"


def display_for(processes, seconds=15):
    """The name of a display, such as ":0". Without DISPLAY, starts Xvfb on a number that it finds free."""
    if os.environ.get("DISPLAY"):
        return os.environ["DISPLAY"]
    end, other = os.pipe()
    processes.start(["Xvfb", "-displayfd", str(other), "-screen", "0", SIZE, "-nolisten", "tcp"], pass_fds=[other],
                    stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    os.close(other)
    number = b""
    while not number.endswith(b"\n"):
        ready, _, _ = select.select([end], [], [], seconds)
        part = os.read(end, 16) if ready else b""
        if not part:
            raise Failure("Xvfb did not start; is the Debian package xvfb installed?")
        number += part
    os.close(end)
    return ":" + number.decode().strip()
