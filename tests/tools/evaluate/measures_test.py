#!/usr/bin/env python3
"""Holds the measures that the built program states to scikit-image and numpy: measures_test.py PROGRAM MODULE_FOLDER

Needs scikit-image (Debian: python3-skimage).
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM, MODULES = sys.argv[1:3]
sys.path.insert(0, MODULES)

import numpy
from skimage.metrics import structural_similarity

import beampipe


def encoded(linear):
    light = numpy.clip(linear, 0, 1)
    return numpy.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def expected(image, reference):
    a, b = encoded(image), encoded(reference)
    squares = numpy.mean((a - b) ** 2)
    return {"mae": numpy.mean(abs(image - reference)),
            "p999": numpy.sort(abs(image - reference).ravel())[-(image.size // 1000 + 1)],
            "rel_mse": numpy.mean((image - reference) ** 2 / (reference ** 2 + 0.01)),
            "srgb_rmse": numpy.sqrt(squares),
            "psnr": -10 * numpy.log10(squares),
            "ssim": structural_similarity(a, b, gaussian_weights=True, sigma=1.5, use_sample_covariance=False,
                                          data_range=1, channel_axis=2)}


class Measures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.folder = pathlib.Path(cls.scratch.name)
        # Taller than one band of rows, and frames that differ.
        cls.run_program("make", "fence", "--triangles", "3000", "--width", "61", "--height", "87", "--frames", "2",
                        "--pan", "0.3,0.1", "-o", "fence.json")
        cls.run_program("compare", "fence.json", "-t", "msaa:2", "beam", "--ladder", "1,2", "-o", "out")
        cls.report = beampipe.Report(cls.folder / "out")

    @classmethod
    def run_program(cls, *arguments):
        return subprocess.run([PROGRAM, *arguments], cwd=cls.folder, check=True, capture_output=True).stdout

    def pictures(self, technique, frame):
        return [self.report.picture(name, frame)[..., :3].astype(float) for name in (technique, "reference")]

    def assert_measures(self, stated, wanted):
        for key, value in wanted.items():
            self.assertAlmostEqual(stated[key], value, delta=1e-9 * max(1, abs(value)), msg=key)

    def test_frames(self):
        for technique in ("msaa:2", "beam"):
            for frame in range(2):
                self.assert_measures(self.report.frames(technique)[frame]["error"],
                                     expected(*self.pictures(technique, frame)))

    def test_frames_are_pooled_as_one_picture(self):
        frames = [expected(*self.pictures("msaa:2", frame)) for frame in range(2)]
        mean = lambda key: (frames[0][key] + frames[1][key]) / 2
        squares = (frames[0]["srgb_rmse"] ** 2 + frames[1]["srgb_rmse"] ** 2) / 2
        self.assert_measures(self.report["msaa:2"]["error"],
                             {"mae": mean("mae"), "rel_mse": mean("rel_mse"), "ssim": mean("ssim"),
                              "srgb_rmse": numpy.sqrt(squares), "psnr": -10 * numpy.log10(squares)})

    def test_diff_states_the_same_and_writes_maps(self):
        names = [f"out/{folder}/frame_0001.exr" for folder in ("beam", "reference")]
        for metric in ("rmse", "ssim", "flip", "hdr_flip"):
            stated = json.loads(self.run_program("diff", *names, "--json", "--map", "map.exr", "--metric", metric))
            self.assertEqual({key: stated[key] for key in self.report.frames("beam")[1]["error"]},
                             self.report.frames("beam")[1]["error"])
            layer = beampipe.read_exr(self.folder / "map.exr")[metric].astype(float)
            self.assertEqual(layer.shape, (87, 61))
            inside = layer[5:-5, 5:-5] if metric == "ssim" else layer
            mean = numpy.sqrt(numpy.mean(layer ** 2)) if metric == "rmse" else inside.mean()
            self.assertAlmostEqual(mean, stated[metric], places=6)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
