#!/usr/bin/env python3
"""Makes the tables of docs/shading.md.

usage: docs/shading.py PROGRAM FOLDER [SCENE...]

PROGRAM is for instance build/release/tools/beampipe. The script makes the scenes with materials (or only those that are
named) at 320 x 180, measures each technique on them, and prints for each scene the whole error, the errors of visibility
and of shading, and the equivalent MSAA rates. The results of `compare`, with the pictures, go to FOLDER/<scene>.
"""
import pathlib
import sys

from measure import make, print_head, print_row, results

SCENES = ["room", "rigging", "leaves", "bumps", "sheets", "tiles"]
SPECS = ["beam", "beam:at=visible", "beam:at=quarters", "beam:at=sixteenths", "beam:order=stream", "msaa:8",
         "msaa:8,at=centroid", "msaa:8,alpha=coverage", "msaa:32", "msaa:256", "deferred"]


def rate(result):
    samples = result["equivalent_msaa"]
    bound = "≥ " if result.get("equivalent_msaa_is_lower_bound") else (
        "< " if result.get("equivalent_msaa_is_upper_bound") else "")
    return f"{bound}{samples:.3g}" if samples < 1000 else f"{bound}{samples:.0f}"


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__.strip())
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    for scene in sys.argv[3:] or SCENES:
        trace = make(program, scene, folder / f"{scene}.json", "--width", "320", "--height", "180")
        found = results(program, "compare", trace, SPECS, folder / scene, "--no-memory-model")
        print(f"`{scene}`:\n")
        print_head("technique", "RMSE × 1000", "visibility", "shading", "EMR", "EMR of visibility")
        for spec in SPECS:
            result = found[spec]
            print_row(f"`{spec}`", f"{1000 * result['error']['rmse']:.2f}",
                      f"{1000 * result['visibility']['rmse']:.2f}", f"{1000 * result['shading']['rmse']:.2f}",
                      rate(result), rate(result["visibility"]))
        print(flush=True)


main()
