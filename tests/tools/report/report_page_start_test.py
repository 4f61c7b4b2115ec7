#!/usr/bin/env python3
"""Runs report_page_test.py with a chromedriver or a Chromium that does not start.

The test must end soon, print one line and leave no process.

usage: report_page_start_test.py CHROMEDRIVER
"""

import pathlib
import subprocess
import sys
import tempfile
import time
import unittest

CHROMEDRIVER = sys.argv[1]
PAGE_TEST = pathlib.Path(__file__).with_name("report_page_test.py")
SECONDS = 2  # what each program may take to start


class StartTest(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.folder = pathlib.Path(self.scratch.name)

    def fake(self, commands):
        """A program that leaves its process number in a file, and then does this."""
        file = self.folder / "fake"
        file.write_text(f"#!/bin/sh\necho $$ >{self.folder}/pid\n{commands}\n")
        file.chmod(0o755)
        return file

    def expect_line(self, chromium, chromedriver, line):
        # The output is a pipe, as under ctest: run() waits until every process that could write to it has ended.
        start = time.monotonic()
        result = subprocess.run([sys.executable, PAGE_TEST, "no-beampipe", chromium, chromedriver, str(SECONDS)],
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=60)
        self.assertLess(time.monotonic() - start, SECONDS + 20)
        self.assertEqual(result.returncode, 1, result.stdout)
        self.assertRegex(result.stdout, rf"\Areport_page_test\.py: {line}.*\n\Z")

    def expect_no_process(self):
        process = pathlib.Path("/proc", (self.folder / "pid").read_text().strip())
        for _ in range(500):  # a killed process takes a moment to disappear
            if not process.exists():
                return
            time.sleep(0.01)
        self.fail(f"{process} still runs")

    def test_chromium_ends_at_once(self):
        self.expect_line(self.fake("exit 1"), CHROMEDRIVER, "Chromium does not start: ")

    def test_chromium_hangs(self):
        self.expect_line(self.fake("sleep 300"), CHROMEDRIVER, f"Chromium does not start: it gave no answer within {SECONDS} s")
        self.expect_no_process()

    def test_there_is_no_chromium(self):
        self.expect_line(self.folder / "nothing", CHROMEDRIVER, "Chromium does not start: ")

    def test_chromedriver_ends_at_once(self):
        self.expect_line("chromium", self.fake("echo no such library >&2; exit 127"),
                         r"chromedriver does not start: it ended with status 127 \(no such library\)")

    def test_chromedriver_hangs(self):
        self.expect_line("chromium", self.fake("sleep 300"), f"chromedriver does not start: it named no port within {SECONDS} s")
        self.expect_no_process()

    def test_there_is_no_chromedriver(self):
        self.expect_line("chromium", self.folder / "nothing", "chromedriver does not start: .*nothing")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
