#!/usr/bin/env python3
"""Runs the notebook of the docs: notebook_test.py NOTEBOOK PACKAGE_FOLDER"""
import os
import pathlib
import sys
import tempfile
import unittest

NOTEBOOK, PACKAGES = sys.argv[1:3]
os.environ["PYTHONPATH"] = PACKAGES

import nbformat
from nbconvert.preprocessors import ExecutePreprocessor


class Notebook(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as folder:
            os.environ["HOME"] = folder  # where Jupyter and Matplotlib keep what they remember
            cls.notebook = nbformat.read(NOTEBOOK, as_version=4)
            ExecutePreprocessor(timeout=60, kernel_name="python3").preprocess(cls.notebook, {"metadata": {"path": folder}})

    def outputs(self, number):
        return [cell for cell in self.notebook.cells if cell.cell_type == "code"][number].outputs

    def test_the_table_says_that_beam_is_more_accurate(self):
        lines = self.outputs(0)[0].text.splitlines()
        rmse = {line.split()[0]: float(line.split()[1]) for line in lines[1:]}
        self.assertLess(rmse["beam"], rmse["msaa:32"])
        self.assertLess(rmse["msaa:32"], rmse["msaa:8"])

    def test_the_figure_is_shown(self):
        self.assertIn("image/png", self.outputs(1)[0].data)

    def test_the_stored_notebook_has_no_outputs(self):
        for cell in nbformat.read(pathlib.Path(NOTEBOOK), as_version=4).cells:
            self.assertFalse(cell.get("outputs"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
