"""Tests that run the program, sys.argv[1], in a folder of their own."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM = sys.argv[1]


class InFolder(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = pathlib.Path(scratch.name)

    @classmethod
    def run_program(cls, *arguments, fails=None):
        """What it prints; or its errors, if it is to fail with this exit code."""
        found = subprocess.run([PROGRAM, *arguments], cwd=cls.folder, capture_output=True, text=True)
        if (fails or 0) != found.returncode:
            raise AssertionError(f"{arguments}: exit {found.returncode}\n{found.stderr}")
        return found.stderr if fails else found.stdout
