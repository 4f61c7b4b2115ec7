#!/usr/bin/env python3
"""Makes the table of errors and costs of docs/shading.md.

usage: docs/shading.py PROGRAM -o FOLDER

PROGRAM is for instance beampipe. Makes the scenes with materials at 320 x 180, measures each technique on them, and
prints the whole error, the errors of visibility and of shading, and how often each pixel was shaded and how many bytes
of texels it read. The results of `compare`, with the pictures, go to FOLDER.
"""
import pathlib
import sys

from measure import make, print_head, print_row, results, stages

SCENES = ["room", "rigging", "leaves", "bumps", "sheets", "tiles"]
SPECS = ["beam", "beam:at=covered,filter=sampler", "beam:at=sixteenths,filter=sampler", "msaa:8", "msaa:8,filter=16",
         "msaa:32", "msaa:256"]
PIXELS = 320 * 180


def errors(program, folder):
    folder.mkdir(parents=True, exist_ok=True)
    print_head("scene", "technique", "RMSE × 1000", "visibility", "shading", "shadings per pixel",
               "bytes of texels per pixel")
    for scene in SCENES:
        trace = make(program, scene, folder / f"{scene}.json", "--width", "320", "--height", "180")
        found = results(program, "compare", trace, SPECS, folder / scene, "--no-memory-model", "--ladder", "8")
        for spec in SPECS:
            result = found[spec]
            print_row(f"`{scene}`", f"`{spec}`", f"{1000 * result['error']['rmse']:.2f}",
                      f"{1000 * result['visibility']['rmse']:.2f}", f"{1000 * result['shading']['rmse']:.2f}",
                      f"{stages(result)['shade']['items_in'] / PIXELS:.1f}",
                      f"{sum(stage['texture_bytes'] for stage in stages(result).values()) / PIXELS:.0f}")


match sys.argv[1:]:
    case [program, "-o", folder]:
        errors(program, pathlib.Path(folder))
    case _:
        sys.exit(__doc__.strip())
