#!/usr/bin/env python3
"""Tests of the package's reading of results: results_test.py PROGRAM PACKAGE_FOLDER"""
import os
import sys
import unittest

MODULES = sys.argv[2]
sys.path.insert(0, MODULES)

import numpy

import beampipe
from in_folder import InFolder


class Module(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_program("make", "fence", "--triangles", "3000", "--width", "61", "--height", "37", "--frames", "2", "--pan",
                        "0.3,0.1", "-o", "fence.json")
        cls.run_program("compare", "fence.json", "-t", "beam", "msaa:8", "-o", "out")
        cls.report = beampipe.Report(cls.folder / "out")

    def test_techniques_in_the_order_of_the_report(self):
        self.assertEqual(self.report.techniques, ["beam", "msaa:8", "reference"])
        self.assertEqual([result["technique"] for result in self.report], self.report.techniques)
        self.assertEqual(len(self.report), 3)

    def test_pictures_have_the_errors_that_the_report_states(self):
        for technique in ("beam", "msaa:8"):
            for frame in range(2):
                difference = (self.report.picture(technique, frame).astype(float) -
                              self.report.picture("reference", frame))[..., :3]
                rmse = numpy.sqrt(numpy.mean(difference ** 2))
                stated = self.report.frames(technique)[frame]["error"]["rmse"]
                self.assertAlmostEqual(rmse, stated, delta=1e-9 + 1e-6 * stated)
                self.assertGreater(rmse, 0)

    def test_counters_have_the_means_that_the_report_states(self):
        counters, frame = self.report.counters("beam"), self.report.frames("beam")[0]
        self.assertGreater(len(counters), 2)
        for name, layer in counters.items():
            self.assertEqual(layer.shape, (37, 61))
            self.assertAlmostEqual(layer.mean(dtype=float), frame["pixel_counters"][name]["mean"], places=5)

    def test_stages_are_summed_over_frames(self):
        stages = self.report.stages("msaa:8")
        frames = self.report.frames("msaa:8")
        self.assertEqual(sum(stage["dram_bytes"] for stage in stages.values()), sum(f["dram_bytes"] for f in frames))
        self.assertGreater(stages["depth_test"]["ops.add"], 0)

    def test_headers_name_what_the_picture_is(self):
        attributes = beampipe.read_exr(self.folder / "out/msaa_8/frame_0001.exr").attributes
        self.assertEqual(attributes["beampipe.technique"], "msaa:8")
        self.assertEqual(attributes["beampipe.trace"], "fence.json")
        self.assertEqual(attributes["beampipe.frame"], "1")
        self.assertRegex(attributes["beampipe.trace_digest"], "^[0-9a-f]{16}$")
        self.assertEqual(attributes["beampipe.version"], self.report.json["version"])

    def test_tables_of_the_report(self):
        self.run_program("report", "out")
        table = beampipe.read_table(self.folder / "out/tables/techniques.csv")
        rows = table["technique"] == "beam"
        self.assertEqual(rows.sum(), 1)
        self.assertAlmostEqual(table["rmse"][rows][0], self.report["beam"]["error"]["rmse"])

    def test_columns_of_a_table_are_integers_numbers_or_texts(self):
        file = self.folder / "some.csv"
        file.write_text("width,gap,error,name\n320,1,2,a\n40,,0.5,b\n")
        table = beampipe.read_table(file)
        self.assertEqual([values.dtype.kind for values in table.values()], ["i", "f", "f", "U"])
        self.assertEqual(table["width"].tolist(), [320, 40])

    def test_a_report_says_what_it_is_of(self):
        self.assertEqual(repr(self.report), f"Report({str(self.folder / 'out')!r}) of beam, msaa:8, reference")

    def test_broken_files_are_one_line(self):
        good = (self.folder / "out/beam/frame_0000.exr").read_bytes()
        for name, data in (("empty", b""), ("short", good[:200]), ("half", good[:len(good) // 2]), ("text", b"x" * 500)):
            file = self.folder / f"{name}.exr"
            file.write_bytes(data)
            with self.assertRaises(beampipe.Error) as error:
                beampipe.read_exr(file)
            self.assertIn(f"{name}.exr: expected an EXR file", str(error.exception))
            self.assertNotIn("\n", str(error.exception))

    def test_what_is_missing_is_named(self):
        with self.assertRaisesRegex(beampipe.Error, "expected the report of a finished run, found none"):
            beampipe.Report(self.folder / "nothing")
        with self.assertRaisesRegex(beampipe.Error, "expected one of the techniques .*msaa:8.*, found msaa:9"):
            self.report["msaa:9"]
        for read in (beampipe.Report.picture, beampipe.Report.counters):
            for frame in (2, -1):
                with self.assertRaisesRegex(beampipe.Error, f"out: expected a frame from 0 to 1, found {frame}$"):
                    read(self.report, "beam", frame)
        with self.assertRaisesRegex(beampipe.Error, "no.exr: expected an EXR file, found none"):
            beampipe.read_exr(self.folder / "no.exr")
        with self.assertRaisesRegex(beampipe.Error, "found no file"):
            beampipe.read_table(self.folder / "no.csv")

    def test_what_is_no_table_is_refused(self):
        for name, data in (("empty.csv", b""), ("short.csv", b"a,b\n1\n"), ("line.json", b'{"a": 1}'),
                           ("not.sqlite", b"a,b\n1,2\n"), ("empty.sqlite", b""), ("picture.csv", b"\x00\xff")):
            (self.folder / name).write_bytes(data)
        for name in ("out/report.json", "empty.csv", "short.csv", "line.json", "not.sqlite", "empty.sqlite",
                     "picture.csv"):
            with self.assertRaisesRegex(beampipe.Error, f"{name}: expected a table, CSV or SQLite"):
                beampipe.read_table(self.folder / name)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
