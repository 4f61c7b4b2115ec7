#!/usr/bin/env python3
"""Tests of `beampipe figure`: figure_test.py PROGRAM PACKAGE_FOLDER"""
import os
import re
import shutil
import subprocess
import sys
import unittest

sys.path.insert(0, sys.argv[2])

import numpy

import beampipe
from beampipe import figures
from in_folder import InFolder


class Figure(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        for scene in ("fence", "bars"):
            cls.run_program("make", scene, "--triangles", "3000", "--width", "96", "--height", "54", "-o", f"{scene}.json")
            cls.run_program("compare", f"{scene}.json", "-t", "beam", "msaa:2,8", "--ladder", "1,2,4,8", "-o", scene)

    def test_the_same_results_give_the_same_bytes(self):
        for ending in ("svg", "pdf", "png"):
            for name in ("a", "b"):
                self.run_program("figure", "fence", "-o", f"{name}.{ending}")
            first, second = ((self.folder / f"{name}.{ending}").read_bytes() for name in ("a", "b"))
            self.assertEqual(first, second)
        self.assertEqual([file.name for file in self.folder.glob(".*")], [])  # nothing unfinished

    def test_a_figure_has_two_scenes_in_columns_with_numbers_below(self):
        self.run_program("figure", "fence", "bars", "-t", "msaa:8", "beam", "--crop", "10,5,12,8", "-o", "two.svg")
        text = (self.folder / "two.svg").read_text()
        comments = re.findall(r"<!-- (.*?) -->", text)  # Matplotlib writes every text as one, in the order of drawing
        self.assertEqual([each for each in comments if each in ("msaa:8", "beam", "reference", "fence", "bars")],
                         ["msaa:8", "beam", "reference", "fence"] + ["msaa:8", "beam", "reference", "bars"])
        report = beampipe.Report(self.folder / "fence")
        self.assertIn(f"RMSE {1000 * report['beam']['error']['rmse']:.3g} × 10⁻³", comments)
        self.assertIn("EMR 8", comments)
        # Two scenes of three pictures and two maps, each with a crop, and a scale each.
        self.assertEqual(text.count("<image "), 2 * (2 * 5 + 1))

    def test_the_table_is_that_of_the_report(self):
        self.run_program("figure", "fence", "-o", "t.svg", "--tex", "t.tex")
        table, report = (self.folder / "t.tex").read_text(), beampipe.Report(self.folder / "fence")
        for name in ("beam", "msaa:2", "msaa:8"):
            self.assertRegex(table, rf"{name} & {1000 * report[name]['error']['rmse']:.2f} & .* \\\\")
        self.assertIn(r"msaa:8 & ", table)
        self.assertIn("\\toprule", table)
        latex = shutil.which("pdflatex")
        if latex:
            page = "\\documentclass{article}\\usepackage{booktabs}\\begin{document}" + table + "\\end{document}"
            (self.folder / "page.tex").write_text(page)
            subprocess.run([latex, "-interaction=batchmode", "page.tex"], cwd=self.folder, check=True, capture_output=True)

    def test_rates_by_another_metric_say_so(self):
        self.run_program("compare", "fence.json", "-t", "beam", "--metric", "flip", "--ladder", "1,8", "-o", "by_flip")
        self.run_program("figure", "by_flip", "-o", "by_flip.svg", "--tex", "by_flip.tex")
        self.assertIn("EMR by flip ", (self.folder / "by_flip.svg").read_text())
        self.assertIn(r"& EMR by flip \\", (self.folder / "by_flip.tex").read_text())

    def test_errors_are_one_line_and_leave_the_old_figure(self):
        (self.folder / "old.svg").write_text("old")
        self.stand_in("import sys; sys.stdin.buffer.read(); sys.exit('no such codec')")
        self.run_program("run", "fence.json", "-t", "beam", "-o", "ran")
        for code, expected, words in (
                (1, "expected the report of a finished run, found none", ["nothing", "-o", "old.svg"]),
                (1, "expected results of `beampipe compare`, found no reference", ["ran", "-o", "old.svg"]),
                (1, "expected one of the techniques beam, msaa:2, msaa:8, found taa", ["fence", "-t", "taa", "-o", "old.svg"]),
                (1, "crop 90,0,12,8: expected a part of the 96 x 54 pixels of fence",
                 ["fence", "--crop", "90,0,12,8", "-o", "old.svg"]),
                (1, "expected a frame from 0 to 0, found 1", ["fence", "--frame", "1", "-o", "old.svg"]),
                (1, "no/old.svg: cannot be written: No such file or directory", ["fence", "-o", "no/old.svg"]),
                (1, "ffmpeg failed: no such codec", ["fence", "-o", "old.mp4"]),
                (2, "--frame 1: a film shows all frames", ["fence", "--frame", "1", "-o", "old.mp4"]),
                (2, "expected a name that ends in .svg, .pdf, .png or .mp4", ["fence", "-o", "old.jpg"]),
                (2, "expected X,Y,WIDTH,HEIGHT in pixels", ["fence", "--crop", "1,2,3", "-o", "old.svg"]),
                (2, "required: DIR, -o/--output", [])):
            said = self.run_program("figure", *words, fails=code)
            self.assertIn(expected, said)
            self.assertEqual(said.count("\n"), 1)
        self.assertEqual((self.folder / "old.svg").read_text(), "old")
        self.assertFalse((self.folder / "old.mp4").exists())

    def stand_in(self, script):
        """A program that is called in place of ffmpeg."""
        (self.folder / "bin").mkdir(exist_ok=True)
        program = self.folder / "bin/ffmpeg"
        program.write_text(f"#!{sys.executable}\n{script}\n")
        program.chmod(0o755)
        before = os.environ["PATH"]
        self.addCleanup(os.environ.__setitem__, "PATH", before)
        os.environ["PATH"] = f"{self.folder / 'bin'}:{before}"

    def test_a_film_has_a_figure_for_each_frame(self):
        self.run_program("make", "fence", "--frames", "3", "--orbit", "30", "--width", "48", "--height", "28", "-o", "moving.json")
        self.run_program("compare", "moving.json", "-t", "beam", "msaa:2", "--ladder", "1,2", "-o", "moving")
        self.stand_in("import sys; open(sys.argv[-1], 'wb').write(sys.stdin.buffer.read())")
        self.run_program("figure", "moving", "-o", "film.mp4")
        pictures = (self.folder / "film.mp4").read_bytes().split(b"\x89PNG\r\n\x1a\n")[1:]
        self.assertEqual(len(pictures), 3)
        self.assertEqual(len(set(pictures)), 3)
        self.assertEqual(len({picture[8:16] for picture in pictures}), 1)  # width and height

    def test_a_film_is_one_that_ffmpeg_can_read(self):
        if not shutil.which("ffprobe"):
            self.skipTest("needs the Debian package ffmpeg")
        self.run_program("figure", "fence", "-o", "film.mp4")
        found = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=nb_read_frames", "-of",
                                "csv=p=0", "film.mp4"], cwd=self.folder, capture_output=True, text=True, check=True)
        self.assertEqual(found.stdout.strip(), "1")

    def test_help_has_an_example(self):
        self.assertIn("beampipe figure out -o figure.pdf", self.run_program("figure", "--help"))


class Crops(unittest.TestCase):
    def scene(self, *errors):
        picture = numpy.zeros((*errors[0].shape, 3), numpy.float32)
        return figures.Scene("s", [figures.Column(str(i), picture, each) for i, each in enumerate(errors)] +
                             [figures.Column("reference", picture)])

    def test_crops_are_where_techniques_differ_and_do_not_overlap(self):
        same, one = numpy.zeros((60, 90)), numpy.zeros((60, 90))
        same[5:15, 5:15] = 9  # large errors that both techniques have
        one[:] = same
        one[30:40, 50:60] = 1
        one[45:55, 20:30] = 0.5
        found = figures.where_techniques_differ(self.scene(same, one))
        self.assertEqual(found, [(50, 30, 10, 10), (20, 45, 10, 10)])

    def test_a_picture_of_one_crop(self):
        self.assertEqual(figures.where_techniques_differ(self.scene(numpy.ones((6, 6)))), [(0, 0, 6, 6)])

    def test_names_are_made_safe_for_latex(self):
        column = figures.Column("a_b%{", numpy.zeros((1, 1, 3)), numpy.zeros((1, 1)), 0.00123456,
                                beampipe.Rate(1024, is_lower_bound=True))
        table = figures.booktabs([figures.Scene("s&t", [column])])
        self.assertIn("s\\&t & a\\_b\\%\\{ & 1.23 & $\\geq$\\,1024 \\\\", table)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
