#!/usr/bin/env python3
"""Prints the measures of error of finished comparisons side by side, for docs/accuracy.md.

usage: docs/perception.py DIR...

`beampipe compare TRACE -t SPEC... --metric flip -o DIR` wrote each folder, with the same techniques.
"""
import json
import pathlib
import sys

from measure import print_head, print_row

MEASURES = {"RMSE × 10³": ("rmse", lambda value: f"{1e3 * value:.2f}"), "SSIM": ("ssim", lambda value: f"{value:.5f}"),
            "FLIP × 10³": ("flip", lambda value: f"{1e3 * value:.2f}")}


def rate_of(result):
    if result.get("equivalent_msaa_does_not_converge"):
        return "none"
    return f"{'≥ ' if result['equivalent_msaa_is_lower_bound'] else ''}{result['equivalent_msaa']:.3g}"


def main(folders):
    reports = {}
    for folder in folders:
        results = json.loads((pathlib.Path(folder) / "report.json").read_text())["results"]
        reports[pathlib.Path(folder).name] = {result["technique"]: result for result in results}
    print_head("technique", *(f"{scene}: {title}" if i == 0 else title for scene in reports
                              for i, title in enumerate([*MEASURES, "EMR by FLIP"])))
    for technique in next(iter(reports.values())):
        if technique != "reference":
            print_row(f"`{technique}`", *(cell for results in reports.values() for cell in (
                *(text(results[technique]["error"][key]) for key, text in MEASURES.values()), rate_of(results[technique]))))


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1:])
