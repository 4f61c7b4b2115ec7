#!/usr/bin/env python3
"""Tests of tools/reproduce with a program that only echoes: reproduce_test.py"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

REPRODUCE = pathlib.Path(__file__).resolve().parent.parent.parent / "tools/reproduce"

# Prints its arguments and counts its calls. `make VALUE -o FILE` writes the value; `show FILE` prints it.
PROGRAM = """#!/bin/sh
echo "$@" >> calls
case $1 in
  make) echo "$2" > "$4" ;;
  show) echo "| a |"; echo "|---|"; echo "| $(cat "$2") |" ;;
  fail) echo "no such scene" >&2; exit 1 ;;
esac
"""


def block(body, commands, kind="made"):
    return f"<!-- {kind} by: -->\n{body}<!-- end -->\n\n```\n{commands}\n```\n"


class Reproduce(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.scratch.name)
        self.program, self.page = self.folder / "program", self.folder / "page.md"
        self.program.write_text(PROGRAM)
        self.program.chmod(0o755)

    def tearDown(self):
        self.scratch.cleanup()

    def run_it(self, *options):
        return subprocess.run([sys.executable, REPRODUCE, "--program", self.program, "--work", self.folder / "work",
                               *options, self.page], capture_output=True, text=True)

    def calls(self):
        file = self.folder / "work/calls"
        return file.read_text().splitlines() if file.exists() else []

    def test_a_table_becomes_what_its_last_command_prints(self):
        self.page.write_text("Above.\n\n" + block("", "beampipe make 7 -o t.json\nbeampipe show t.json") + "\nBelow.\n")
        found = self.run_it()
        self.assertEqual(found.returncode, 0, found.stderr)
        self.assertIn("page.md:3: new", found.stdout)
        table = "| a |\n|---|\n| 7 |\n"
        self.assertEqual(self.page.read_text(),
                         "Above.\n\n" + block(table, "beampipe make 7 -o t.json\nbeampipe show t.json") + "\nBelow.\n")

    def test_continued_lines_are_one_command(self):
        self.page.write_text(block("", "beampipe make \\\n  7 \\\n  -o t.json\nbeampipe show t.json"))
        self.assertEqual(self.run_it().returncode, 0)
        self.assertEqual(len(self.calls()), 2)
        self.assertIn("| 7 |", self.page.read_text())

    def test_it_says_what_moved(self):
        table = "| a |\n|---|\n| 7 |\n"
        self.page.write_text(block(table, "beampipe make 8 -o t.json\nbeampipe show t.json"))
        self.assertIn("page.md:1: 1 of 1 numbers; the farthest from 7 to 8", self.run_it().stdout)
        self.assertIn("page.md:1: the same", self.run_it().stdout)

    def test_what_is_done_is_not_done_again_until_something_changes(self):
        commands = "beampipe make 7 -o t.json\nbeampipe show t.json"
        self.page.write_text(block("", commands))
        self.run_it()
        self.run_it()
        self.assertEqual(len(self.calls()), 2)
        (self.folder / "work/t.json").write_text("9\n")  # by something else
        self.run_it()
        self.assertEqual(self.calls()[2:], ["make 7 -o t.json"])
        self.program.write_text(PROGRAM + "# another version\n")
        self.run_it()
        self.assertEqual(len(self.calls()), 5)

    def test_pages_that_write_the_same_file_do_not_mix(self):
        self.page.write_text(block("", "beampipe make 1 -o t.json\nbeampipe show t.json") +
                             block("", "beampipe make 2 -o t.json\nbeampipe show t.json"))
        for _ in range(2):
            self.run_it()
            self.assertLess(self.page.read_text().index("| 1 |"), self.page.read_text().index("| 2 |"))

    def test_a_failing_command_leaves_its_table_and_says_so(self):
        before = block("| old |\n", "beampipe fail")
        self.page.write_text(before)
        found = self.run_it()
        self.assertEqual(found.returncode, 1)
        self.assertIn("exit 1: no such scene", found.stderr)
        self.assertEqual(self.page.read_text(), before)

    def test_check_fails_on_a_stale_table_and_writes_nothing(self):
        stale = block("| a |\n|---|\n| 6 |\n", "beampipe make 7 -o t.json\nbeampipe show t.json")
        self.page.write_text(stale)
        self.assertEqual(self.run_it("--check").returncode, 1)
        self.assertEqual(self.page.read_text(), stale)
        self.run_it()
        self.assertEqual(self.run_it("--check").returncode, 0)

    def test_check_does_not_measure(self):
        self.page.write_text(block("| 6 |\n", "beampipe show t.json", kind="measured"))
        self.assertEqual(self.run_it("--check").returncode, 0)
        self.assertEqual(self.calls(), [])

    def test_tables_that_need_models_wait_for_them(self):
        before = block("| old |\n", "beampipe show $MODELS/m")
        self.page.write_text(before)
        found = self.run_it()
        self.assertEqual(found.returncode, 0)
        self.assertIn("left as it is, because it needs --models", found.stdout)
        self.assertEqual(self.page.read_text(), before)
        (self.folder / "m").write_text("5\n")
        self.run_it("--models", self.folder)
        self.assertIn("| 5 |", self.page.read_text())


    def test_measured_tables_are_measured_again(self):
        self.page.write_text(block("", "beampipe make 7 -o t.json\nbeampipe show t.json", kind="measured"))
        self.run_it()
        self.run_it()
        self.assertEqual(self.calls(), ["make 7 -o t.json", "show t.json", "show t.json"])

    def test_other_models_make_another_table(self):
        self.page.write_text(block("", "beampipe show $MODELS/m"))
        for value in ("5", "6"):
            models = self.folder / f"models{value}"
            models.mkdir()
            (models / "m").write_text(f"{value}\n")
            self.run_it("--models", models)
            self.assertIn(f"| {value} |", self.page.read_text())

    def test_broken_markers_stop_the_page(self):
        good = block("| 1 |\n", "beampipe make 7 -o t.json\nbeampipe show t.json")
        for broken in (good.replace("<!-- end -->\n\n", "<!-- end -->\n\nProse.\n"), good.replace("<!-- end -->\n", ""),
                       "<!-- end -->\n" + good):
            text = broken + "\nImportant prose.\n\n" + good
            self.page.write_text(text)
            found = self.run_it()
            self.assertEqual(found.returncode, 1, broken)
            self.assertIn("expected each table between its two markers", found.stderr)
            self.assertEqual(self.page.read_text(), text)

    def test_edits_made_meanwhile_stay(self):
        commands = f"beampipe make 7 -o t.json\necho 'Edited.' >> {self.page}; beampipe show t.json"
        self.page.write_text(block("", commands))
        self.assertEqual(self.run_it().returncode, 0)
        self.assertIn("| 7 |", self.page.read_text())
        self.assertTrue(self.page.read_text().endswith("Edited.\n"))

    def test_a_command_without_output_does_not_empty_its_table(self):
        for command in ("true", "false | cat"):
            before = block("| old |\n", command)
            self.page.write_text(before)
            self.assertEqual(self.run_it().returncode, 1)
            self.assertEqual(self.page.read_text(), before)

    def test_a_page_without_tables_is_an_error_if_it_was_named(self):
        self.page.write_text("Prose.\n")
        self.assertEqual(self.run_it("--check").returncode, 1)

    def test_sessions_print_what_stands_below_their_commands(self):
        numbers = "$ printf 'a   b  c\\n1 2 3\\n\\n4 5 6\\n'\n"
        for shown, missing in [("a b c\n1 2 3\n4 5 6\n", None), ("a b ...\n1 2   3\n...\n", None),
                               ("...\n4 5 6\n", None), ("a b c\n1 2 7\n4 5 6\n", "1 2 7"), ("a b c\n...\n1 2\n", "1 2"),
                               ("a b c\n4 5 6\n", "4 5 6"), ("a b c\n1 2 3\n", "the end")]:
            self.page.write_text(f"```\n$ beampipe make 7 -o t.json\n\n{numbers}{shown}```\n")
            found = self.run_it("--check")
            self.assertEqual(found.returncode, 0 if missing is None else 1, found.stderr)
            self.assertIn("page.md: 1 session checked" if missing is None else f"does not print: {missing}\n",
                          found.stdout + found.stderr)
        self.page.write_text("```\n$ beampipe fail\nno such scene\n```\n")
        self.assertIn("no such scene", self.run_it().stderr)

    def test_the_programs_own_error_is_shown(self):
        self.page.write_text(block("", "echo 'beampipe: error: no such scene' >&2; seq 1000 >&2; exit 3"))
        self.assertIn("exit 3: beampipe: error: no such scene\n", self.run_it().stderr)

    def test_a_linked_page_stays_a_link(self):
        target = self.folder / "target.md"
        target.write_text(block("", "beampipe make 7 -o t.json\nbeampipe show t.json"))
        self.page.symlink_to(target)
        self.run_it()
        self.assertTrue(self.page.is_symlink())
        self.assertIn("| 7 |", target.read_text())

    def test_the_sources_are_no_working_folder(self):
        self.page.write_text(block("", "true"))
        found = subprocess.run([sys.executable, REPRODUCE, "--program", self.program, "--work", REPRODUCE.parent.parent,
                                self.page], capture_output=True, text=True)
        self.assertEqual(found.returncode, 2)
        self.assertIn("expected a folder for work, found that of the sources", found.stderr)


if __name__ == "__main__":
    unittest.main()
