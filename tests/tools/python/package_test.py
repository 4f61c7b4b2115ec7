#!/usr/bin/env python3
"""Tests of the Python package with the compiled module: package_test.py PROGRAM PACKAGE_FOLDER"""
import inspect
import json
import math
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

PACKAGES = sys.argv[2]
sys.path.insert(0, PACKAGES)

import numpy

import beampipe
from in_folder import InFolder

SIZE = 16  # px


def half_plane(edge, **options):
    """A white half-plane to the left of `edge`, in pixels, before a black background."""
    x = 2 * edge / SIZE - 1
    positions = [[-9, -9, 0], [x, -9, 0], [x, 9, 0], [-9, 9, 0]]
    return beampipe.trace_from_arrays(positions, [[0, 1, 2], [0, 2, 3]], [1, 1, 1], width=SIZE, height=SIZE, **options)


class Closed(unittest.TestCase):
    """Pictures that are known."""

    def test_a_half_plane_covers_half_of_the_pixels_on_its_edge(self):
        for technique in ("beam", "reference", "msaa:16"):
            found = beampipe.render(half_plane(5.5), technique)
            self.assertEqual(found.picture.shape, (SIZE, SIZE, 3))
            self.assertEqual(found.picture.dtype, numpy.float32)
            expected = numpy.clip(5.5 - numpy.arange(SIZE), 0, 1)
            numpy.testing.assert_array_equal(found.alpha, numpy.broadcast_to(expected, (SIZE, SIZE)), technique)
            numpy.testing.assert_array_equal(found.picture[..., 1], found.alpha, technique)

    def test_the_camera_sees_a_square_as_perspective_says(self):
        square = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
        trace = beampipe.trace_from_arrays(square, [[0, 1, 2], [0, 2, 3]], [0.25, 0.5, 1], width=SIZE, height=SIZE,
                                           background=(0, 0, 0.125), eye=(0, 0, 4), fovy=90)
        found = beampipe.reference(trace).picture  # at distance 4, the picture is 8 units high: 2 px for a unit
        inside = numpy.zeros((SIZE, SIZE), bool)
        inside[6:10, 6:10] = True
        numpy.testing.assert_array_equal(found[inside], numpy.broadcast_to(numpy.float32([0.25, 0.5, 1]), (16, 3)))
        numpy.testing.assert_array_equal(found[~inside], numpy.broadcast_to(numpy.float32([0, 0, 0.125]), (240, 3)))

    def test_matrices_multiply_column_vectors(self):
        view = numpy.eye(4)
        view[0, 3] = 2 * 3 / SIZE  # 3 px to the right
        moved = beampipe.render(half_plane(5.5, view=view), "beam")
        numpy.testing.assert_array_equal(moved.alpha, beampipe.render(half_plane(8.5), "beam").alpha)

    def test_measures_of_known_errors(self):
        truth = numpy.full((12, 12, 3), 0.25)
        image = truth + 0.5
        self.assertEqual(beampipe.measures.rmse(image, truth), 0.5)
        self.assertEqual(beampipe.measures.mae(image, truth), 0.5)
        self.assertEqual(beampipe.measures.bias(truth, image), -0.5)
        self.assertEqual(beampipe.measures.maximum(image, truth), 0.5)
        self.assertAlmostEqual(beampipe.measures.rel_mse(image, truth), 0.25 / (0.0625 + 0.01), places=12)
        encoded = [1.055 * value ** (1 / 2.4) - 0.055 for value in (0.75, 0.25)]
        self.assertAlmostEqual(beampipe.measures.srgb_rmse(image, truth), encoded[0] - encoded[1], places=6)
        self.assertAlmostEqual(beampipe.measures.psnr(image, truth), -20 * numpy.log10(encoded[0] - encoded[1]), places=5)
        self.assertEqual(beampipe.measures.psnr(truth, truth), float("inf"))
        self.assertEqual(beampipe.measures.ssim(truth, truth), 1)
        self.assertEqual(beampipe.measures.flip(truth, truth), 0)
        numpy.testing.assert_array_equal(beampipe.measures.error_map("rmse", image, truth), numpy.full((12, 12), 0.5))

    def test_every_measure_has_a_function_that_agrees_with_the_table(self):
        noise = numpy.random.default_rng(1)
        image, truth = noise.random((20, 30, 3)), noise.random((20, 30, 3))
        everything = beampipe.measures.measure_all(image, truth)
        self.assertEqual(list(everything), list(beampipe.measures.MEANINGS))
        for key, value in everything.items():
            function = getattr(beampipe.measures, "maximum" if key == "max" else key)
            self.assertEqual(function(image, truth), value, key)
            self.assertIn(beampipe.measures.MEANINGS[key][2], function.__doc__)

    def test_a_rate_between_two_rungs_of_a_straight_ladder(self):
        ladder = [(n, 1 / n) for n in (1, 2, 4, 8)]
        self.assertAlmostEqual(beampipe.equivalent_rate(1 / 3, ladder).samples, 3)
        self.assertTrue(beampipe.equivalent_rate(2, ladder).is_upper_bound)
        self.assertEqual(str(beampipe.equivalent_rate(2, ladder)), "< 1")

    def test_a_rate_is_told_with_its_range(self):
        for low, high, expected in ((None, None, "12.3"), (10.06, 150.4, "12.3 (10.1..150)"), (10, None, "12.3 (10..)")):
            self.assertEqual(str(beampipe.Rate(12.345, low=low, high=high)), expected)


class Program(InFolder):
    """What the program does, without files."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.trace = beampipe.make("fence", triangles=3000, width=61, height=37, frames=2, pan=(0.3, 0.1))
        cls.trace.save(cls.folder / "fence.json")
        cls.specs = ["beam:pool=60", "msaa:8", "taa:4"]
        cls.run_program("compare", "fence.json", "-t", *cls.specs, "--metric", "mae", "--ladder", "1,4,16", "-o", "out")
        cls.report = beampipe.Report(cls.folder / "out")

    def test_scenes_are_those_of_make(self):
        self.run_program("make", "fence", "--triangles", "3000", "--width", "61", "--height", "37", "--frames", "2", "--pan",
                         "0.3,0.1", "-o", "made.json")
        self.assertEqual((self.folder / "made.json").read_bytes(), (self.folder / "fence.json").read_bytes())
        self.assertIn("fence", beampipe.scenes())

    def test_pictures_and_counters_are_those_of_the_program_to_the_last_bit(self):
        trace = beampipe.open_trace(self.folder / "fence.json")
        self.assertEqual((trace.frames, trace.size(1)), (2, (61, 37)))
        for spec in self.specs:
            for frame, found in enumerate(beampipe.render(trace, spec, frames=None, threads=3)):
                written = self.report.picture(spec, frame)
                self.assertEqual(found.picture.tobytes(), written[..., :3].tobytes(), spec)
                self.assertEqual(found.alpha.tobytes(), written[..., 3].tobytes(), spec)
                layers = self.report.counters(spec, frame)
                self.assertEqual(sorted(found.counters), sorted(set(layers) - {"error"}))
                for name, layer in found.counters.items():
                    self.assertEqual(layer.tobytes(), layers[name].tobytes(), name)

    def test_stages_and_bytes_are_those_of_the_report(self):
        for spec in self.specs:
            of_program = self.report.frames(spec)[0]
            found, second = beampipe.render(self.trace, spec, frames=None)
            self.assertEqual(found.dram_bytes, of_program["dram_bytes"])
            for stage in of_program["stages"]:
                for name, value in found.stages[stage["stage"]].items():
                    key, _, kind = name.partition(".")
                    self.assertEqual(value, stage[key][kind] if kind else stage[key], name)
            for key in ("on_chip_bytes_per_pixel", "off_chip_bytes_per_pixel"):
                self.assertEqual(max(getattr(found, key), getattr(second, key)), self.report[spec][key])
            for way, times in of_program["modelled_ms"].items():
                self.assertEqual({key: found.times[way][key] for key in ("in_turn", "on_cores", "at_once")},
                                 {key: times[key] for key in ("in_turn", "on_cores", "at_once")})

    def test_hardware_is_a_name_or_a_file(self):
        mali = beampipe.render(self.trace, "beam", hardware="mali_g710")
        self.assertNotEqual(mali.times["shaders"]["in_turn"], beampipe.render(self.trace, "beam").times["shaders"]["in_turn"])
        self.assertEqual(beampipe.render(self.trace, "beam", memory_model=False).times, {})
        with self.assertRaisesRegex(beampipe.Error, "none.json: expected a readable file or one of titan_v"):
            beampipe.render(self.trace, "beam", hardware="none.json")
        with self.assertRaisesRegex(beampipe.Error, "none.json: expected a readable file or one of titan_v"):
            beampipe.render(self.trace, lambda trace, frame: numpy.zeros((37, 61, 3)), hardware="none.json")

    def test_compare_finds_what_the_program_finds(self):
        found = beampipe.compare(self.trace, self.specs, metric="mae", ladder=[1, 4, 16])
        self.assertEqual([each.name for each in found], self.specs)
        for each in found:
            result = self.report[each.name]
            self.assertEqual(each.errors, {key: result["error"][key] for key in each.errors})
            self.assertEqual(each.rate.samples, result["equivalent_msaa"])
        self.assertEqual(found.ladder, [(rung["samples"], rung["error"]) for rung in self.report.json["metric_msaa_ladder"]])
        self.assertIn("msaa:8", found.table())

    def test_the_first_frames_may_be_drawn_for_histories_only(self):
        self.run_program("compare", "fence.json", "-t", *self.specs, "--measure-from", "1", "--ladder", "1,4", "-o",
                         "late")
        report = beampipe.Report(self.folder / "late")
        found = beampipe.compare(self.trace, self.specs, measure_from=1, ladder=[1, 4])
        for each in found:
            self.assertEqual([rendering.frame for rendering in each.renderings], [1])
            self.assertEqual(each.error, report[each.name]["error"]["rmse"])
        for wrong in (-1, 2, 0.5):
            with self.assertRaisesRegex(beampipe.Error, f"measure_from: expected a number from 0 to 1, found {wrong}"):
                beampipe.compare(self.trace, self.specs, measure_from=wrong)

    def test_the_range_of_a_rate_by_rmse_is_that_of_the_program(self):
        self.run_program("compare", "fence.json", "-t", *self.specs, "--reference-error", "-o", "by_rmse")
        report = beampipe.Report(self.folder / "by_rmse")
        found = beampipe.compare(self.trace, self.specs, reference_error=True)
        self.assertEqual([each.name for each in found], [*self.specs, "reference:set=2"])
        self.assertEqual(found.reference_error, report.json["reference_error"])
        self.assertEqual([n for n, _ in found.ladder], [rung["samples"] for rung in report.json["msaa_ladder"]])
        for each in found:
            result = report[each.name]
            for end in ("low", "high"):
                self.assertAlmostEqual(getattr(each.rate, end) or 0, result.get(f"equivalent_msaa_{end}") or 0, places=12)
        self.assertRegex(found.table(), rf"beam:pool=60 .* {found['beam:pool=60'].rate.low:.3g}\.\.")

    def test_options_are_keywords(self):
        self.assertEqual(beampipe.spec("beam", pool=60), "beam:pool=60")
        self.assertEqual(beampipe.spec("msaa:8", prepass=True, motion=False, at="centroid"), "msaa:8,prepass,at=centroid")
        self.assertEqual(beampipe.render(self.trace, "beam", pool=60).technique, "beam:pool=60")

    def test_inspect_explains_a_pixel_as_the_program_does(self):
        found = beampipe.inspect(self.trace, "beam", 30, 18)
        printed = json.loads(self.run_program("inspect", "fence.json", "-t", "beam", "--pixel", "30,18", "--json"))
        self.assertEqual(found, printed["pixels"][0])
        self.assertIn("Fragments", str(found))

    def test_another_size(self):
        found = beampipe.render(beampipe.make("fence", triangles=3000, width=64, height=48), "beam", width=32)
        self.assertEqual(found.picture.shape, (24, 32, 3))

class Own(unittest.TestCase):
    """Techniques, metrics and patterns of the user's."""

    @classmethod
    def setUpClass(cls):
        cls.trace = beampipe.make("fence", triangles=3000, width=40, height=30)

    def test_a_technique_is_compared_as_any_other(self):
        def doubled(trace, frame):
            return 2 * beampipe.render(trace, "msaa:4", frames=frame).picture

        found = beampipe.compare(self.trace, ["msaa:4", doubled, lambda trace, frame: numpy.zeros((30, 40, 4))],
                                 ladder=[1, 4])
        self.assertEqual(list(found.results), ["msaa:4", "doubled", "<lambda>"])
        self.assertEqual(found["msaa:4"].rate.samples, 4)
        truth = found.reference[0].picture.astype(float)
        self.assertAlmostEqual(found["<lambda>"].error, numpy.sqrt(numpy.mean(truth ** 2)), places=12)
        self.assertTrue(found["doubled"].rate.is_upper_bound)

    def test_lists_of_msaa(self):
        found = beampipe.compare(self.trace, ["msaa:1,4", "msaa:2"], ladder=[1])
        self.assertEqual(list(found.results), ["msaa:1", "msaa:4", "msaa:2"])

    def test_a_metric_finds_rates(self):
        def worst(image, reference):
            return abs(image.astype(float) - reference).max()

        found = beampipe.compare(self.trace, ["beam"], metric=worst, ladder=[1, 4])
        self.assertEqual(found.metric, "worst")
        self.assertEqual(found["beam"].error, found["beam"].errors["max"])
        self.assertEqual([n for n, _ in found.ladder], [1, 4])
        self.assertGreater(found["beam"].rate.samples, 1)

    def test_the_heading_of_errors_says_what_they_are(self):
        def ssim(image, reference):
            return 0

        for metric, heading in (("psnr", "sRGB RMSE"), ("ssim", "1 - SSIM"), ("mae", "MAE"), (ssim, "ssim")):
            found = beampipe.compare(self.trace, ["msaa:1"], metric=metric, ladder=[1])
            self.assertRegex(found.table(), f"^technique +RMSE x 1000  {heading} +EMR")
            self.assertEqual(repr(found), found.table())

    def test_what_is_printed_has_no_arrays(self):
        found = beampipe.compare(self.trace, ["msaa:1"], ladder=[1])["msaa:1"]
        self.assertNotIn("array", repr(found) + repr(found.renderings[0]))

    def test_the_standard_pattern_is_msaa(self):
        four = [[6, 2], [14, 6], [2, 10], [10, 14]]  # sixteenths of a pixel
        pattern = beampipe.Pattern(numpy.array(four) / 16, name="four")
        found, expected = beampipe.render(self.trace, pattern), beampipe.render(self.trace, "msaa:4")
        self.assertEqual(found.picture.tobytes(), expected.picture.tobytes())
        self.assertEqual(found.stages, expected.stages)
        self.assertEqual(beampipe.compare(self.trace, [pattern], ladder=[1, 2])["four"].error,
                         beampipe.measures.rmse(expected.picture, beampipe.reference(self.trace).picture))

    def test_a_pattern_for_each_pixel_of_a_tile(self):
        columns = beampipe.Pattern(lambda x, y: [[(1 + 2 * x + y) / 8, 0.5]], tile=(2, 2))
        found = beampipe.render(half_plane(5.5), columns).alpha
        # Of column 5, which is covered up to 0.5: samples at 3/8 in even rows and 4/8 in odd ones, whose edge is not in.
        self.assertEqual(found[0::2, 5].tolist(), [1] * 8)
        self.assertEqual(found[1::2, 5].tolist(), [0] * 8)
        self.assertEqual(found[:, 4].tolist(), [1] * SIZE)

    def test_three_samples(self):
        pattern = beampipe.Pattern([[0.25, 0.5], [0.375, 0.5], [0.75, 0.5]])
        self.assertAlmostEqual(float(beampipe.render(half_plane(5.5), pattern).alpha[3, 5]), 2 / 3, places=3)


def over(fragments):
    """OVER, near to far"""
    color, left = numpy.zeros(3), 1.0
    for each in fragments:
        color += left * each["area"] * each["color"]
        left *= 1 - each["area"]
    return [*color, 1 - left]


class Merges(unittest.TestCase):
    """Rules of the user's that merge fragments."""

    def test_over_is_alpha(self):
        trace = beampipe.make("fence", triangles=3000, width=40, height=30)
        found, expected = beampipe.render(trace, beampipe.Merge(over), threads=3), beampipe.render(trace, "alpha")
        numpy.testing.assert_allclose(found.picture, expected.picture, atol=2e-3)  # alpha stores fp16
        for stage in ("conservative_raster", "shade"):
            self.assertEqual(found.stages[stage]["items_out"], expected.stages[stage]["items_out"], stage)
        self.assertEqual(found.stages["compose"]["items_in"], expected.stages["a_buffer"]["items_in"])
        self.assertEqual(found.stages["compose"]["ops.total"], 0)
        self.assertGreater(found.times["shaders"]["in_turn"], 0)

    def test_a_rule_is_given_what_a_fragment_is(self):
        """Two quads: the left half of each pixel in column 5 in front of all of it, at known depths."""
        x, near, far = 2 * 5.5 / SIZE - 1, -0.5, 0.5  # of clip space; depth is (z - 1) / 2, -0.75 and -0.25
        quad = lambda right, z: [[-9, -9, z], [right, -9, z], [right, 9, z], [-9, 9, z]]
        trace = beampipe.trace_from_arrays(quad(9, far) + quad(x, near), [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]],
                                           [[1, 0, 0]] * 2 + [[0, 0, 1]] * 2, width=SIZE, height=SIZE)
        seen = {}

        def rule(fragments):
            areas = tuple(fragments["area"])
            seen[areas] = fragments.copy()
            return [0, areas[0], 0, 1]

        merge = beampipe.Merge(rule, positions=64)
        found = beampipe.render(trace, merge)
        numpy.testing.assert_array_equal(found.picture[3, 4:8, 1], [1, 0.5, 1, 1])
        front, back = seen[0.5, 1.0]
        self.assertEqual((front["depth"], back["depth"]), (-0.75, -0.25))
        self.assertEqual((front["plane"].tolist(), front["color"].tolist()), ([-0.75, 0, 0], [0, 0, 1]))
        self.assertEqual(merge.places.shape, (64, 2))
        numpy.testing.assert_array_equal(front["mask"], merge.places[:, 0] < 0.5)
        self.assertTrue(back["mask"].all())

    def test_results_depend_on_no_threads(self):
        trace = beampipe.make("pickets", triangles=3000, width=80, height=45)
        one, many = (beampipe.render(trace, beampipe.Merge(over, positions=32), threads=n) for n in (1, 5))
        self.assertEqual(one.picture.tobytes(), many.picture.tobytes())
        self.assertEqual(one.stages, many.stages)

    def test_what_a_rule_does_wrong_is_said(self):
        trace = half_plane(5.5)
        with self.assertRaisesRegex(ZeroDivisionError, "division"):
            beampipe.render(trace, beampipe.Merge(lambda fragments: 1 / 0))
        for returned, expected in (([1, 1, 1], r"\(3,\)"), (None, "NoneType"), ("rgba", "str"),
                                   ([0, 0, 0, 2], r"\[0. 0. 0. 2.\]"), ([0, math.nan, 0, 1], r"\[ 0. nan  0.  1.\]"),
                                   ([-1, 0, 0, 1], r"\[-1.  0.  0.  1.\]"), ([1000, 0, 0, -0.9], r"\[.*-9.*e-01\]"),
                                   ([0, 0, 0, -0.5], r"\[ 0.   0.   0.  -0.5\]")):
            def rule(fragments):
                return returned if fragments["area"][0] < 1 else [0, 0, 0, 1]

            with self.assertRaisesRegex(beampipe.Error, r"^rule, frame 0, pixel \(5, 0\): expected 4 finite numbers "
                                                        "from the rule, R, G and B from 0 and A from 0 to 1, "
                                                        f"found {expected}$"):
                beampipe.render(trace, beampipe.Merge(rule), threads=1)
        beampipe.render(trace, beampipe.Merge(lambda fragments: [-1e-4, 0, 0, 1.0001]))  # rounded
        for rule in (lambda fragments: fragments["colour"][0], lambda fragments: fragments[0]["colour"]):
            with self.assertRaisesRegex(beampipe.Error, "mine: no field of name colour: expected area, depth, plane, front, "
                                                        "color, mask"):
                beampipe.render(trace, beampipe.Merge(rule, name="mine"))
        with self.assertRaisesRegex(ValueError, "^math domain error"):
            beampipe.render(trace, beampipe.Merge(lambda fragments: math.sqrt(-1)))
        with self.assertRaisesRegex(beampipe.Error, "positions: expected 32, 64, 128 or 256, found 8"):
            beampipe.Merge(over, positions=8)
        with self.assertRaisesRegex(beampipe.Error, "rule: expected a function, found str"):
            beampipe.Merge("over")


OWN_PROGRAM = """
import sys
sys.path.insert(0, {packages!r})
import beampipe

def dim(trace, frame):
    \"\"\"half of msaa:4.\"\"\"
    return {factor} * beampipe.render(trace, "msaa:4", frames=frame).picture

def nearest(fragments):
    area = fragments[0]["area"]
    return [*area * fragments[0]["color"], area]

def broken(trace, frame):
    return 1 / 0

if __name__ == "__main__":
    centre = beampipe.Pattern([[0.5, 0.5]], name="centre")
    sys.exit(beampipe.program(sys.argv[1:], [dim, beampipe.Merge(nearest), centre, broken]))
"""


class OwnProgram(InFolder):
    """The program with techniques of the user's."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_program("make", "fence", "--triangles", "3000", "--width", "60", "--height", "40", "-o", "fence.json")
        cls.write(0.5)

    @classmethod
    def write(cls, factor):
        (cls.folder / "mine.py").write_text(OWN_PROGRAM.format(packages=PACKAGES, factor=factor))

    def start(self, *arguments):
        return subprocess.run([sys.executable, "mine.py", *arguments], cwd=self.folder, capture_output=True, text=True,
                              env={**os.environ, "XDG_CACHE_HOME": str(self.folder / "cache")})

    def run_own(self, *arguments):
        found = self.start(*arguments)
        self.assertEqual(found.returncode, 0, found.stderr)
        return found.stdout

    def test_commands_know_them(self):
        for name, what in (("dim", "half of msaa:4"), ("centre", "a technique of one's own")):
            self.assertRegex(self.run_own("run", "--help"), rf"{name}\s+{what} \(mine.py\)")
        compare = ("compare", "fence.json", "--ladder", "1,4", "-t", "dim", "nearest", "centre", "msaa:1", "-o", "out")
        self.run_own(*compare)
        report = beampipe.Report(self.folder / "out")
        self.assertEqual(report["centre"]["error"], report["msaa:1"]["error"])
        self.assertIn("modelled_ms", report.frames("nearest")[0])
        self.assertNotIn("modelled_ms", report.frames("dim")[0])
        four = beampipe.render(beampipe.open_trace(self.folder / "fence.json"), "msaa:4").picture
        numpy.testing.assert_array_equal(report.picture("dim")[..., :3], four / 2)
        for command in (["report", "out"], ["plot", "out", "-o", "plot.svg"], ["model", "out", "--over", "msaa:1"],
                        ["report", "out", "out", "-o", "both.html"]):
            self.run_own(*command)
        self.assertTrue((self.folder / "out/report.html").exists())

    def test_a_note_says_that_the_cost_of_rules_is_left_out(self):
        note = "beampipe: note: nearest: what the rule itself computes is in no counter and no modelled time\n"
        for technique, expected in (("nearest", note), ("dim", "")):
            self.assertEqual(self.start("run", "fence.json", "-t", technique, "-o", "noted").stderr, expected)

    def test_a_sweep_keeps_results_until_the_script_changes(self):
        plan = {"beampipe_sweep": 1, "traces": ["fence.json"], "techniques": ["dim", "nearest"], "errors": True}
        (self.folder / "plan.json").write_text(json.dumps(plan))
        sweep = ("sweep", "plan.json", "-o", "sweep")
        self.assertIn("3 rendered", self.run_own(*sweep))
        self.assertIn("0 rendered", self.run_own(*sweep))
        before = beampipe.read_table(self.folder / "sweep/table.csv")
        self.write(0.25)
        try:
            self.assertIn("3 rendered", self.run_own(*sweep))
        finally:
            self.write(0.5)
        after = beampipe.read_table(self.folder / "sweep/table.csv")
        self.assertNotEqual(before["rmse"][0], after["rmse"][0])
        self.assertEqual(before["rmse"][-1], after["rmse"][-1])  # of nearest

    def test_tasks_of_a_cluster_start_the_script(self):
        plan = {"beampipe_sweep": 1, "traces": ["fence.json"], "techniques": ["dim"]}
        (self.folder / "cluster.json").write_text(json.dumps(plan))
        self.run_own("sweep", "cluster.json", "-o", "cluster", "--slurm", "--dry-run")
        self.assertIn(f"exec '{sys.executable}' '{self.folder.resolve() / 'mine.py'}' 'sweep'",
                      (self.folder / "cluster/slurm/array.sh").read_text())

    def test_errors_are_one_line(self):
        found = self.start("run", "fence.json", "-t", "broken", "-o", "failed")
        self.assertEqual(found.returncode, 1)
        self.assertRegex(found.stderr, r"\Abeampipe: error: ZeroDivisionError: division by zero.*mine.py\(\d+\): broken.*\n\Z")
        self.assertEqual(self.start("run", "fence.json", "-t", "dimm", "-o", "failed").returncode, 2)
        for name, wrong in [("small letters", "Dim"), ("there is one of this name already", "beam")]:
            with self.assertRaisesRegex(beampipe.Error, f"technique {wrong}: .*{name}"):
                beampipe.program(["--version"], [beampipe.Pattern([[0.5, 0.5]], name=wrong)])
        with self.assertRaisesRegex(beampipe.Error, "found the spec beam"):
            beampipe.program(["--version"], ["beam"])
        with self.assertRaisesRegex(beampipe.Error, r"over: expected a function of \(trace, frame\)"):
            beampipe.program(["--version"], [over])


class Errors(unittest.TestCase):
    def check(self, pattern, work):
        with self.assertRaisesRegex(beampipe.Error, pattern) as caught:
            work()
        self.assertNotIn("\n", str(caught.exception))

    def test_wrong_arguments_are_one_line(self):
        trace, image = half_plane(5.5), numpy.zeros((4, 4, 3))
        make = beampipe.trace_from_arrays
        points, size = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], {"width": 8, "height": 8}
        self.check("technique 'bea'", lambda: beampipe.render(trace, "bea"))
        self.check("pool=", lambda: beampipe.render(trace, "beam", pool=61))
        self.check("expected a spec, a Pattern, a Merge or a function, found int", lambda: beampipe.render(trace, 8))
        self.check("expected no options, found pool", lambda: beampipe.render(trace, lambda t, f: image, pool=60))
        for found, expected in ((image, r"\(4, 4, 3\)"), (None, "NoneType"), ("white", "str")):
            self.check(f"picture of 16 x 16 x 3 or 4 numbers, found {expected}",
                       lambda: beampipe.render(trace, lambda t, f: found))
        for wrong in (1, -1, "a", 0.5, [0, 1]):
            self.check("expected frames from 0 to 0, found", lambda: beampipe.render(trace, "beam", frames=wrong))
        for work in (beampipe.render, lambda trace, rule: beampipe.compare(trace, [rule])):
            self.check(r"over: expected a function of \(trace, frame\), or Merge\(f\) for a merge rule",
                       lambda: work(trace, over))
            self.check("found the class Pattern", lambda: work(trace, beampipe.Pattern))
            self.check("found Comparison", lambda: work(trace, beampipe.Comparison("rmse", "RMSE", {}, [], [])))
            self.check("trace: expected a Trace, as open_trace.* returns it, found str", lambda: work("a.json", "beam"))
        whole = "width and height: expected whole numbers from 0"
        self.check(whole, lambda: beampipe.render(trace, "beam", width=-1))
        self.check(whole, lambda: beampipe.compare(trace, ["beam"], height=0.5))
        self.check("make: expected whole numbers from 0", lambda: beampipe.make("fence", width=-1))
        self.check("threads: expected 1 to 1024", lambda: beampipe.render(trace, "beam", threads=-1))
        self.check("cannot be 8 x 4 pixels", lambda: beampipe.render(trace, "beam", width=8, height=4))
        self.check("no/trace.json", lambda: beampipe.open_trace("no/trace.json"))
        self.check("fenc", lambda: beampipe.make("fenc"))
        self.check("a model: expected a scene; `beampipe make a/b.obj -o b.json`", lambda: beampipe.make("a/b.obj"))
        self.check("indices from 0 to 2", lambda: make(points, [[0, 1, 3]], **size))
        self.check("indices from 0 to 2", lambda: make(points, [[0, 1, -1]], **size))
        self.check("triangles: expected an array of integers", lambda: make(points, [[0, 1, 1.5]], **size))
        self.check("positions: expected finite numbers", lambda: make([[0, 0, numpy.nan]] * 3, [[0, 1, 2]], **size))
        self.check("positions: expected an array of N x 3", lambda: make([[0, 0]] * 3, [[0, 1, 2]], **size))
        self.check("colors: expected one for each of 1 triangles", lambda: make(points, [[0, 1, 2]], [[1, 1, 1]] * 2, **size))
        self.check("colors: expected linear RGB", lambda: make(points, [[0, 1, 2]], [-1, 0, 0], **size))
        self.check("0 < near < far", lambda: make(points, [[0, 1, 2]], eye=(0, 0, 1), near=2, far=1, **size))
        self.check("not the line of sight", lambda: make(points, [[0, 1, 2]], eye=(0, 1, 0), **size))
        self.check("found both", lambda: make(points, [[0, 1, 2]], eye=(0, 0, 1), view=numpy.eye(4), **size))
        self.check("width and height", lambda: make(points, [[0, 1, 2]], width=0, height=8))
        self.check("pixel 16,3", lambda: beampipe.inspect(trace, "beam", 16, 3))
        self.check("trace: expected a Trace", lambda: beampipe.inspect("a.json", "beam", 1, 3))
        self.check("pixel -1,3, frame 0: expected whole numbers from 0", lambda: beampipe.inspect(trace, "beam", -1, 3))
        self.check("cannot be inspected", lambda: beampipe.inspect(trace, "taa:4", 3, 3))
        self.check("metric: expected one of rmse", lambda: beampipe.compare(trace, ["beam"], metric="rms"))
        self.check("metric: expected one of rmse.* found 5", lambda: beampipe.compare(trace, ["beam"], metric=5))
        rate = beampipe.equivalent_rate
        self.check("ladder: expected .N, error. for rising N, found none", lambda: rate(0.01, []))
        self.check("ladder: expected .N, error. for rising N, found 4, 2", lambda: rate(0.01, [(4, 0.1), (2, 0.2)]))
        self.check("error: expected a number that is at least 0, found -1", lambda: rate(-1, [(1, 0.1), (2, 0.05)]))
        self.check("error of msaa:2: expected a number that is at least 0, found nan",
                   lambda: rate(1, [(1, 1), (2, math.nan)]))
        self.check("at least 0, found nan", lambda: beampipe.compare(trace, ["beam"], metric=lambda a, b: numpy.nan, ladder=[1]))
        self.check("given twice", lambda: beampipe.compare(trace, ["beam", "beam"]))
        self.check("technique 'msaa:3'", lambda: beampipe.compare(trace, ["beam"], ladder=[3]))
        self.check("inside the pixel, found sample 1", lambda: beampipe.Pattern([[0.5, 0.5], [1, 0.5]]))
        self.check("1 to 32 samples, found 33", lambda: beampipe.Pattern([[0.5, 0.5]] * 33))
        self.check("tile=.* beside a function", lambda: beampipe.Pattern(lambda x, y: [[0.5, 0.5]]))
        self.check("N x 2 positions", lambda: beampipe.Pattern([0.5, 0.5]))
        self.check(r"image: expected an array of height x width x 3 or 4 numbers, found \(4, 4\)",
                   lambda: beampipe.measures.rmse(image[..., 0], image))
        self.check("", lambda: beampipe.measures.rmse(image[:3], image))
        self.check("pixels_per_degree", lambda: beampipe.measures.flip(image, image, 0))
        self.check("p99 has no map", lambda: beampipe.measures.error_map("p99", image, image))

    def test_pictures_with_values_that_are_not_finite_are_refused(self):
        def hot(trace, frame):
            picture = numpy.ones((SIZE, SIZE, 3))
            picture[3, 5, 1] = numpy.nan
            return picture

        self.check(r"^hot, frame 0, pixel \(5, 3\): expected finite numbers, found \[ 1. nan  1.\]$",
                   lambda: beampipe.compare(half_plane(5.5), [hot]))

    def test_an_error_in_the_users_own_code_goes_through(self):
        with self.assertRaisesRegex(ZeroDivisionError, "division"):
            beampipe.render(half_plane(5.5), lambda trace, frame: 1 / 0)


INTERRUPTED = """
import time, sys
sys.path.insert(0, {packages!r})
import beampipe
trace = beampipe.make("hairball", triangles=20000, width=1280, height=720)
print("now", flush=True)
try:
    beampipe.reference(trace, threads=1)
except KeyboardInterrupt:
    print("interrupted", flush=True)
print(float(beampipe.render(trace, "msaa:1", width=16).alpha.max()))  # it works on
"""


class Interrupts(unittest.TestCase):
    def test_ctrl_c_ends_rendering_within_a_second(self):
        with subprocess.Popen([sys.executable, "-c", INTERRUPTED.format(packages=PACKAGES)], stdout=subprocess.PIPE,
                              text=True) as process:
            self.assertEqual(process.stdout.readline(), "now\n")
            time.sleep(0.5)
            start = time.monotonic()
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.stdout.readline(), "interrupted\n")
            self.assertLess(time.monotonic() - start, 1)
            self.assertEqual(process.stdout.readline(), "1.0\n")
            self.assertEqual(process.wait(), 0)

    def test_other_threads_run_meanwhile(self):
        trace, counted, done = beampipe.make("hairball", triangles=20000, width=160, height=90), [0], threading.Event()

        def count():
            while not done.is_set():
                counted[0] += 1
                time.sleep(0.001)

        thread = threading.Thread(target=count)
        thread.start()
        before, start = counted[0], time.monotonic()
        beampipe.reference(trace, threads=1)
        during, took = counted[0] - before, time.monotonic() - start
        done.set()
        thread.join()
        self.assertGreater(during, 50 * took)


class Documented(unittest.TestCase):
    def test_all_that_is_public_is_explained(self):
        for name in beampipe.__all__:
            self.assertTrue(inspect.getdoc(getattr(beampipe, name)), name)
        self.assertTrue((pathlib.Path(PACKAGES) / "beampipe/py.typed").exists())

    def test_stubs_name_what_the_compiled_module_has(self):
        stub = (pathlib.Path(PACKAGES) / "beampipe/_native.pyi").read_text()
        for name in dir(beampipe._native):
            if not name.startswith("__"):
                self.assertRegex(stub, rf"(?m)^(class |def )?{name}\b")

    def test_without_the_compiled_module_the_package_reads_results(self):
        with tempfile.TemporaryDirectory() as folder:
            package = pathlib.Path(folder) / "beampipe"
            package.mkdir()
            for file in (pathlib.Path(PACKAGES) / "beampipe").glob("*.py"):
                (package / file.name).write_bytes(file.read_bytes())
            code = "import beampipe; print(beampipe.Report.__name__); beampipe.render"
            found = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True,
                                   env={**os.environ, "PYTHONPATH": folder})
            self.assertEqual(found.stdout, "Report\n")
            self.assertIn("AttributeError: beampipe.render: there is no such name, or it needs", found.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
