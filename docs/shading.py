#!/usr/bin/env python3
"""Makes the tables of errors and costs of docs/shading.md.

usage: docs/shading.py errors PROGRAM -o FOLDER
       docs/shading.py cutouts PROGRAM -o FOLDER

PROGRAM is for instance beampipe. Makes the scenes with materials at 320 x 180, measures each technique on them, and
prints the whole error, the errors of visibility and of shading, and how often each pixel was shaded and how many bytes
of texels it read; or on `leaves` what it costs to look cutouts up at more places. The results of `compare`, with the
pictures, go to FOLDER.
"""
import pathlib
import sys

from measure import make, print_head, print_row, results, stages

SCENES = ["room", "rigging", "leaves", "bumps", "sheets", "tiles"]
SPECS = ["beam", "beam:at=covered,filter=sampler", "beam:at=sixteenths,filter=sampler", "msaa:8", "msaa:8,filter=16",
         "msaa:32", "msaa:256"]
PIXELS = 320 * 180


def scene_results(program, folder, scene, specs, *options):
    folder.mkdir(parents=True, exist_ok=True)
    trace = make(program, scene, folder / f"{scene}.json", "--width", "320", "--height", "180")
    return results(program, "compare", trace, specs, folder / scene, "--ladder", "8", *options)


def thousandths(error):
    return f"{1000 * error['rmse']:.2f}"


def texel_bytes(result):
    return f"{sum(stage['texture_bytes'] for stage in stages(result).values()) / PIXELS:.0f}"


def errors(program, folder):
    print_head("scene", "technique", "RMSE × 1000", "visibility", "shading", "shadings per pixel",
               "bytes of texels per pixel")
    for scene in SCENES:
        found = scene_results(program, folder, scene, SPECS, "--no-memory-model")
        for spec in SPECS:
            result = found[spec]
            print_row(f"`{scene}`", f"`{spec}`", thousandths(result["error"]), thousandths(result["visibility"]),
                      thousandths(result["shading"]), f"{stages(result)['shade']['items_in'] / PIXELS:.1f}",
                      texel_bytes(result))


def cutouts(program, folder):
    print_head("technique", "RMSE × 1000", "visibility", "bytes of texels per pixel",
               "modelled ms, fixed functions", "as shaders")
    specs = ["beam:alpha=1", "beam:alpha=4", "beam", "beam:alpha=256", "msaa:8", "msaa:32"]
    found = scene_results(program, folder, "leaves", specs)
    for spec in specs:
        result = found[spec]
        times = result["frames"][0]["modelled_ms"]
        print_row(f"`{spec}`", thousandths(result["error"]), thousandths(result["visibility"]), texel_bytes(result),
                  *(f"{times[how]['in_turn']:.3f}" for how in ("fixed_function", "shaders")))


match sys.argv[1:]:
    case ["errors", program, "-o", folder]:
        errors(program, pathlib.Path(folder))
    case ["cutouts", program, "-o", folder]:
        cutouts(program, pathlib.Path(folder))
    case _:
        sys.exit(__doc__.strip())
