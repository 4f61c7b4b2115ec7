#!/usr/bin/env python3
"""Tests of `beampipe figure`: figure_test.py PROGRAM PACKAGE_FOLDER"""
import contextlib
import io
import os
import re
import shutil
import subprocess
import sys
import unittest
from unittest import mock

sys.path.insert(0, sys.argv[2])

import numpy

import beampipe
from beampipe import figure_command, figures
from in_folder import InFolder


class Figure(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        for scene in ("fence", "bars"):
            cls.run_program("make", scene, "--triangles", "3000", "--width", "96", "--height", "54", "-o", f"{scene}.json")
            cls.run_program("compare", f"{scene}.json", "-t", "beam", "msaa:2,8", "--ladder", "1,2,4,8", "-o", scene)

    def figure(self, *words, fails=None):
        """What `beampipe figure` prints, in this process: Python and Matplotlib take longer to start than to draw."""
        out, errors, code = io.StringIO(), io.StringIO(), None
        with (contextlib.chdir(self.folder), contextlib.redirect_stdout(out), contextlib.redirect_stderr(errors),
              mock.patch.object(sys, "argv", ["figure", *words])):
            try:
                figure_command.main()
            except SystemExit as end:
                code = end.code
        self.assertEqual(code, fails, errors.getvalue())
        return (errors if fails else out).getvalue()

    def test_the_same_results_give_the_same_bytes(self):
        for ending in ("svg", "pdf", "png"):
            self.run_program("figure", "fence", "-o", f"a.{ending}")
            self.figure("fence", "-o", f"b.{ending}")
            first, second = ((self.folder / f"{name}.{ending}").read_bytes() for name in ("a", "b"))
            self.assertEqual(first, second)
        self.assertEqual([file.name for file in self.folder.glob(".*")], [])  # nothing unfinished

    def test_a_figure_has_two_scenes_in_columns_with_numbers_below(self):
        self.figure("fence", "bars", "-t", "msaa:8", "beam", "--crop", "10,5,12,8", "-o", "two.svg")
        text = (self.folder / "two.svg").read_text()
        comments = re.findall(r"<!-- (.*?) -->", text)  # Matplotlib writes every text as one, in the order of drawing
        self.assertEqual([each for each in comments if each in ("msaa:8", "beam", "reference", "fence", "bars")],
                         ["msaa:8", "beam", "reference", "fence"] + ["msaa:8", "beam", "reference", "bars"])
        report = beampipe.Report(self.folder / "fence")
        digits, exponent = f"{report['beam']['error']['rmse']:.2e}".split("e-")
        self.assertIn(f"RMSE {digits}e-{int(exponent)}", comments)
        self.assertIn("EMR 8", comments)
        # Two scenes of three pictures and two maps, each with a crop, and a scale each.
        self.assertEqual(text.count("<image "), 2 * (2 * 5 + 1))

    def test_it_says_what_it_wrote_and_its_crops(self):
        told = self.figure("fence", "bars", "--crop", "10,5,12,8", "--crop", "1,2,3,4", "-o", "told.svg", "--tex",
                                "told.tex")
        self.assertEqual(told, "figure: told.svg\nfence: --crop 10,5,12,8 --crop 1,2,3,4\n"
                               "bars: --crop 10,5,12,8 --crop 1,2,3,4\ntable: told.tex\n")
        told = self.figure("fence", "-o", "chosen.svg")
        crops = re.fullmatch(r"figure: chosen.svg\nfence: (--crop \d+,\d+,9,9) (--crop \d+,\d+,9,9)\n", told).groups()
        self.figure("fence", "-o", "named.svg", *" ".join(crops).split())
        self.assertEqual((self.folder / "named.svg").read_bytes(), (self.folder / "chosen.svg").read_bytes())

    def test_other_references_are_shown_if_they_are_named_and_msaa_has_lists(self):
        self.run_program("compare", "fence.json", "-t", "msaa:2,8", "--reference-error", "--ladder", "1,2,4,8", "-o", "two")
        for wanted, expected in (([], ["msaa:2", "msaa:8"]), (["-t", "reference:set=2", "msaa:8,2"],
                                                              ["reference:set=2", "msaa:8", "msaa:2"])):
            self.figure("two", *wanted, "-o", "two.svg", "--tex", "two.tex")
            self.assertEqual(re.findall(r"& (\S+:\S+) &", (self.folder / "two.tex").read_text()), expected)

    def test_the_table_is_that_of_the_report(self):
        self.figure("fence", "-o", "t.svg", "--tex", "t.tex")
        table, report = (self.folder / "t.tex").read_text(), beampipe.Report(self.folder / "fence")
        for name in ("beam", "msaa:2", "msaa:8"):
            rmse, = re.findall(rf"{name} & ([\d.]+) & .* \\\\", table)
            self.assertAlmostEqual(float(rmse), 1000 * report[name]["error"]["rmse"], delta=0.005 * float(rmse))
            self.assertEqual(len(rmse.replace(".", "").lstrip("0")), 3, rmse)  # digits
        self.assertIn(r"msaa:8 & ", table)
        self.assertIn("\\toprule", table)
        latex = shutil.which("pdflatex")
        if latex:
            page = "\\documentclass{article}\\usepackage{booktabs}\\begin{document}" + table + "\\end{document}"
            (self.folder / "page.tex").write_text(page)
            subprocess.run([latex, "-interaction=batchmode", "page.tex"], cwd=self.folder, check=True, capture_output=True)

    def test_rates_by_another_metric_say_so(self):
        self.run_program("compare", "fence.json", "-t", "beam", "--metric", "flip", "--ladder", "1,8", "-o", "by_flip")
        self.figure("by_flip", "-o", "by_flip.svg", "--tex", "by_flip.tex")
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
                (1, "figure: 3 techniques and the reference need 2.3 inches for their texts, found 2, where 2 techniques fit",
                 ["fence", "--inches", "2", "-o", "old.svg"]),
                (2, "--frame 1: a film shows all frames", ["fence", "--frame", "1", "-o", "old.mp4"]),
                (2, "expected a name that ends in .svg, .pdf, .png or .mp4", ["fence", "-o", "old.jpg"]),
                (2, "expected X,Y,WIDTH,HEIGHT in pixels", ["fence", "--crop", "1,2,3", "-o", "old.svg"]),
                (2, "required: DIR, -o/--output", [])):
            said = self.figure(*words, fails=code)
            self.assertIn(expected, said)
            self.assertEqual(said.count("\n"), 1)
        self.assertIn("found none\n", self.run_program("figure", "nothing", "-o", "old.svg", fails=1))
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
        self.figure("moving", "-o", "film.mp4")
        pictures = (self.folder / "film.mp4").read_bytes().split(b"\x89PNG\r\n\x1a\n")[1:]
        self.assertEqual(len(pictures), 3)
        self.assertEqual(len(set(pictures)), 3)
        self.assertEqual(len({picture[8:16] for picture in pictures}), 1)  # width and height

    def test_a_film_is_one_that_ffmpeg_can_read(self):
        if not shutil.which("ffprobe"):
            self.skipTest("needs the Debian package ffmpeg")
        self.figure("fence", "-o", "film.mp4")
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

    def test_crops_are_at_least_a_square_apart(self):
        errors = numpy.zeros((60, 90))
        errors[20:30, 20:30] = 9
        errors[20:30, 39:49] = 8
        errors[20:30, 70:80] = 1
        self.assertEqual(figures.where_techniques_differ(self.scene(errors)), [(20, 20, 10, 10), (40, 20, 10, 10)])


class Numbers(unittest.TestCase):
    def test_tables_have_three_digits_ranges_and_names_that_are_safe_for_latex(self):
        for rmse, rate, expected in ((0.00123456, beampipe.Rate(1024, is_lower_bound=True), r"1.23 & $\geq$\,1024 \\"),
                                     (0.0017, beampipe.Rate(50.84, low=41.07, high=62.8), r"1.70 & 50.8 (41.1--62.8) \\"),
                                     (0.00038, beampipe.Rate(150, low=99.6), r"0.380 & 150 (99.6--) \\"),
                                     (0.009996, beampipe.Rate(8), r"10.0 & 8 \\"), (0.5, None, r"500 & -- \\")):
            column = figures.Column("a_b%{", numpy.zeros((1, 1, 3)), numpy.zeros((1, 1)), rmse, rate)
            self.assertIn("s\\&t & a\\_b\\%\\{ & " + expected + "\n",
                          figures.booktabs([figures.Scene("s&t", [column])]))


class Pages(unittest.TestCase):
    def scene(self, picture, *names):
        return figures.Scene("s", [figures.Column(name, picture, picture[..., 0], 0.00123, beampipe.Rate(8))
                                   for name in names] + [figures.Column("reference", picture)])

    def drawn(self, *arguments, **how):
        figure = figures.draw(*arguments, **how)
        figure.set_dpi(figures.DOTS_PER_INCH)
        figure.canvas.draw()
        return figure, numpy.asarray(figure.canvas.buffer_rgba())

    def inside(self, figure, dots):
        """The first picture without its frame."""
        (x0, y0), (x1, y1) = dots.shape[1::-1] * figure.axes[0].get_position().get_points()
        return dots[round(dots.shape[0] - y1) + 4:round(dots.shape[0] - y0) - 4, round(x0) + 4:round(x1) - 4, :3]

    def test_pixels_below_dots_are_means_in_linear_light(self):
        stripes = numpy.zeros((900, 1600, 3))
        stripes[:, ::2] = 1
        figure, dots = self.drawn([self.scene(stripes, "a")], crops=[], width=2)
        inside = self.inside(figure, dots)
        self.assertGreater(inside.size, 3 * 200 * 100)
        # 0.5 is 187.52 in sRGB; a dot of 5.9 pixels has up to half a pixel more of one colour.
        half = [255 * (1.055 * (0.5 + side * 0.5 / 5.9) ** (1 / 2.4) - 0.055) for side in (-1, 1)]
        self.assertGreater(inside.min(), half[0] - 1)
        self.assertLess(inside.max(), half[1] + 1)
        self.assertAlmostEqual(inside.mean(), 187.5, delta=1)

    def test_pixels_above_dots_are_squares(self):
        board = numpy.indices((9, 16)).sum(0)[..., None] % 2 * numpy.ones(3)
        inside = self.inside(*self.drawn([self.scene(board, "a")], crops=[], width=2))
        self.assertEqual(numpy.unique(inside).tolist(), [0, 255])

    def test_texts_stay_in_their_columns(self):
        picture = numpy.ones((9, 16, 3))
        for width, names in ((7, ["beam", "casav:depths=positions,overlap=unbounded", "c", "d", "e", "f", "g"]),
                             (3.3, ["beam", "msaa:8", "msaa:32", "msaa:256"]), (1.5, ["msaa:256"])):
            figure, dots = self.drawn([self.scene(picture, *names)], crops=[(0, 0, 4, 4)], width=width)
            renderer = figure.canvas.get_renderer()
            texts = [text for text in figure.texts if text.get_text() and text.get_rotation() == 0]
            boxes = [text.get_window_extent(renderer) for text in texts]
            boxes += [axes.xaxis.get_tightbbox(renderer) for axes in figure.axes if axes.get_xlabel()]
            self.assertEqual(len(boxes), 2 * len(names) + 2)
            for i, box in enumerate(boxes):
                self.assertGreaterEqual(box.x0, 0)
                self.assertLessEqual(box.x1, dots.shape[1])
                for other in boxes[:i]:
                    self.assertFalse(box.overlaps(other), (width, i))
            self.assertGreaterEqual(min(text.get_fontsize() for text in texts), figures.SMALLEST)
            self.assertEqual("".join(texts[-1].get_text().split()), "reference")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
