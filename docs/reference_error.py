#!/usr/bin/env python3
"""Prints how far the reference errs, for docs/accuracy.md.

usage: docs/reference_error.py measure PROGRAM -o DIR SCENE...   compares at 160 x 90
       docs/reference_error.py table DIR

Errors are RMSE × 1000. That between two independent sets of samples is the root of 2 times the error of one. The error of
shading is not independent between sets, which shade the same cells: against 16,384 samples, it is measured on its own.
The last column has the larger of the two errors as a part of the mean square error of the last rung of the ladder.
"""
import json
import math
import pathlib
import sys

from measure import make, print_head, print_row, results

SECOND, MORE = "reference:set=2", "reference:samples=16384"


def measure(program, folder, scenes):
    pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
    for scene in scenes:
        trace = make(program, scene, f"{folder}/{scene}.json", "--width", "160", "--height", "90")
        results(program, "compare", trace, [SECOND, MORE, "beam"], f"{folder}/{scene}", "--no-memory-model")


def print_table(folder):
    print_head("scene", "RMSE, by two sets", "against 16,384 samples", "visibility, by two sets",
               "shading, against 16,384 samples", "`beam`", "its part at the last rung")
    for report in sorted(pathlib.Path(folder).glob("*/report.json")):
        report = json.loads(report.read_text(encoding="utf-8"))
        by_spec = {result["technique"]: result for result in report["results"]}
        second, more = by_spec[SECOND], by_spec[MORE]

        def cell(rmse, factor=1.0):
            return f"{1000 * rmse * factor:.3f}"
        varies = "visibility" in second
        own, last = second["error"]["rmse"] / math.sqrt(2), report["msaa_ladder"][-1]
        part = max(own, more["error"]["rmse"]) ** 2 / last["rmse"] ** 2
        print_row(pathlib.Path(report["trace"]).stem, cell(own), cell(more["error"]["rmse"]),
                  cell(second["visibility"]["rmse"], 1 / math.sqrt(2)) if varies else "",
                  cell(more["shading"]["rmse"]) if varies else "", cell(by_spec["beam"]["error"]["rmse"]),
                  f"{100 * part:.2g} % of `msaa:{last['samples']}`")


def main(arguments):
    match arguments:
        case ["measure", program, "-o", folder, *scenes] if scenes:
            measure(program, folder, scenes)
        case ["table", folder]:
            print_table(folder)
        case _:
            sys.exit(__doc__.strip())


main(sys.argv[1:])
