#!/usr/bin/env python3
"""Makes the tables of docs/shading.md.

usage: docs/shading.py measure PROGRAM -o FOLDER [MODEL...]
       docs/shading.py errors|costs FOLDER
       docs/shading.py cutouts|translucency PROGRAM -o FOLDER

PROGRAM is for instance beampipe. `measure` makes the scenes with materials and the models at 320 x 180 and compares
techniques on them; the results, with the pictures, go to FOLDER. `errors` prints their errors, and `costs` how often
they shade, what they read of textures, and modelled times. `cutouts` compares ways to test alpha on `leaves`, and
`translucency` ways to blend on `sheets`.
"""
import json
import pathlib
import sys

from measure import make, print_head, print_row, results, stages

SCENES = ["room", "rigging", "leaves", "bumps", "sheets", "tiles", "stairs", "study"]
SPECS = ["beam", "beam:filter=sampler", "beam:at=sixteenths,filter=sampler", "msaa:8", "msaa:8,filter=anisotropic",
         "msaa:32", "msaa:32,filter=anisotropic", "msaa:32,filter=16", "msaa:256", "msaa:256,filter=anisotropic"]
ONCE = "beam:at=visible"
TIMED = ["beam", "msaa:8", "msaa:32", "msaa:32,filter=anisotropic", "msaa:256"]
PIXELS = 320 * 180


def compared(program, what, specs, folder):
    folder.mkdir(parents=True, exist_ok=True)
    name = pathlib.Path(what).stem
    trace = make(program, what, folder / f"{name}.json", "--width", "320", "--height", "180")
    return results(program, "compare", trace, specs, folder / name, "--ladder", "8")


def thousandths(error):
    return f"{1000 * error['rmse']:.2f}"


def texel_bytes(result):
    return sum(stage["texture_bytes"] for stage in stages(result).values()) / PIXELS


def shadings(result):
    return stages(result)["shade"]["items_in"] / PIXELS


def modelled(result):
    times = result["frames"][0]["modelled_ms"]
    return [f"{times[how]['in_turn']:.3f}" for how in ("fixed_function", "shaders")]


def measured(folder):
    """The results by scene and technique, in the order in which they were made."""
    for report in sorted(folder.glob("*/report.json"), key=lambda path: path.stat().st_mtime):
        yield report.parent.name, {found["technique"]: found for found in json.loads(report.read_text())["results"]}


def errors(folder):
    print_head("scene", *(f"`{spec}`" for spec in SPECS))
    for scene, found in measured(folder):
        print_row(f"`{scene}`", *(f"{thousandths(found[spec]['error'])} ({thousandths(found[spec]['visibility'])})"
                                  for spec in SPECS))


def costs(folder):
    print_head("scene", "shadings per pixel", "÷ `at=visible`", "bytes of texels per pixel", "÷ `msaa:32`",
               "÷ `msaa:32,filter=anisotropic`",
               *(f"`{spec}`, ms" for spec in TIMED))
    for scene, found in measured(folder):
        beam, once = found["beam"], found[ONCE]
        print_row(f"`{scene}`", f"{shadings(beam):.1f}", f"{shadings(beam) / shadings(once):.2f}",
                  f"{texel_bytes(beam):.0f}",
                  *(f"{texel_bytes(beam) / texel_bytes(found[spec]):.2f}" for spec in TIMED[2:4]),
                  *(" / ".join(dict.fromkeys(modelled(found[spec]))) for spec in TIMED))


def choices(program, folder, scene, specs):
    print_head("technique", "RMSE × 1000", "visibility", "bytes of texels per pixel", "modelled ms, fixed functions",
               "as shaders")
    found = compared(program, scene, specs, folder)
    for spec in specs:
        result = found[spec]
        print_row(f"`{spec}`", thousandths(result["error"]), thousandths(result["visibility"]),
                  f"{texel_bytes(result):.0f}", *modelled(result))


match sys.argv[1:]:
    case ["measure", program, "-o", folder, *models]:
        for what in SCENES + models:
            compared(program, what, SPECS + [ONCE], pathlib.Path(folder))
    case ["errors", folder]:
        errors(pathlib.Path(folder))
    case ["costs", folder]:
        costs(pathlib.Path(folder))
    case ["cutouts", program, "-o", folder]:
        choices(program, pathlib.Path(folder), "leaves",
                ["beam:alpha=1", "beam:alpha=4", "beam", "beam:alpha=256"] +
                [f"msaa:{samples}{alpha}" for samples in (8, 32)
                 for alpha in ("", ",alpha=sample", ",alpha=hashed", ",alpha=coverage")])
    case ["translucency", program, "-o", folder]:
        choices(program, pathlib.Path(folder), "sheets",
                ["beam"] + [f"msaa:{samples}{blend}" for samples in (8, 32, 256) for blend in ("", ",blend=sorted")])
    case _:
        sys.exit(__doc__.strip())
