"""Which Debian packages a capture needs and this machine lacks."""
import importlib.util
import os
import shutil

from failure import MissingPackages


def _missing(needs_display, program):
    if importlib.util.find_spec("numpy") is None:
        yield "python3-numpy"
    if importlib.util.find_spec("renderdoc") is None:
        yield "python3-renderdoc"
    if importlib.util.find_spec("PIL") is None:
        yield "python3-pil"
    if needs_display and not os.environ.get("DISPLAY") and not shutil.which("Xvfb"):
        yield "xvfb"
    if program == "glretrace" and not shutil.which("glretrace"):
        yield "apitrace"
    if program == "gfxrecon-replay" and not shutil.which("gfxrecon-replay"):
        yield "gfxreconstruct"


def require(needs_display, program):
    """Raises MissingPackages, one line, if something is not installed."""
    missing = list(_missing(needs_display, program))
    if missing:
        raise MissingPackages("capture needs Debian packages that are not installed; try: apt-get install "
                              + " ".join(missing))
