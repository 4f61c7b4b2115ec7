#!/usr/bin/env python3
"""Makes the tables of docs/shading.md.

usage: docs/shading.py errors    PROGRAM -o FOLDER
       docs/shading.py precision PROGRAM FOLDER
       docs/shading.py moving    PROGRAM

PROGRAM is for instance beampipe. `errors` makes the scenes with materials at 320 x 180, measures each technique on them,
and prints for each scene the whole error, the errors of visibility and of shading, and the equivalent MSAA rates; the
results of `compare`, with the pictures, go to FOLDER. From there `precision` prints what the G-buffer's precision
changes: the difference of the pictures of `deferred` and `msaa:1`, which shade the same samples. `moving` prints the mean
error of the second half of 16 frames at 160 x 90, in which the picture moves from frame to frame, for techniques that
need time.
"""
import json
import pathlib
import sys
import tempfile

from measure import difference, make, print_head, print_row, results

SCENES = ["room", "rigging", "leaves", "bumps", "sheets", "tiles"]
SPECS = ["beam", "beam:at=visible", "beam:at=quarters", "beam:at=sixteenths", "beam:order=stream", "msaa:8",
         "msaa:8,at=centroid", "msaa:8,alpha=coverage", "msaa:32", "msaa:256", "acaa:8", "msaa:1", "deferred",
         "visibility"]
MOVING = ["visibility", "taa:8", "dvm"]
FRAMES = 16
MOTIONS = [("tiles", "1,0"), ("tiles", "0.31,0.17"), ("room", "0.31,0.17")]  # pixels per frame


def rate(result):
    samples = result["equivalent_msaa"]
    bound = "≥ " if result.get("equivalent_msaa_is_lower_bound") else (
        "< " if result.get("equivalent_msaa_is_upper_bound") else "")
    return f"{bound}{samples:.3g}" if samples < 1000 else f"{bound}{samples:.0f}"


def errors(program, folder):
    folder.mkdir(parents=True, exist_ok=True)
    for scene in SCENES:
        trace = make(program, scene, folder / f"{scene}.json", "--width", "320", "--height", "180")
        found = results(program, "compare", trace, SPECS, folder / scene, "--no-memory-model")
        print(f"\n`{scene}`:\n")
        print_head("technique", "RMSE × 1000", "visibility", "shading", "EMR", "EMR of visibility")
        for spec in SPECS:
            result = found[spec]
            print_row(f"`{spec}`", f"{1000 * result['error']['rmse']:.2f}",
                      f"{1000 * result['visibility']['rmse']:.2f}", f"{1000 * result['shading']['rmse']:.2f}",
                      rate(result), rate(result["visibility"]))


def precision(program, folder):
    print_head("scene", "RMSE × 1000 of `deferred` against `msaa:1`")
    for scene in SCENES:
        found = json.loads((folder / scene / "report.json").read_text())["results"]
        image = {result["technique"]: folder / scene / result["frames"][0]["image"] for result in found}
        print_row(f"`{scene}`", f"{1000 * difference(program, image['deferred'], image['msaa:1'])['rmse']:.2f}")


def moving(program):
    print_head("scene", "pixels per frame", "technique", "RMSE × 1000", "visibility", "shading")
    for scene, motion in MOTIONS:
        with tempfile.TemporaryDirectory() as folder:
            trace = make(program, scene, f"{folder}/moving.json", "--width", "160", "--height", "90", "--frames",
                         str(FRAMES), "--pan", motion)
            found = results(program, "compare", trace, MOVING, f"{folder}/out", "--no-memory-model", "--ladder", "8")
        for spec in MOVING:
            frames = found[spec]["frames"][FRAMES // 2:]
            mean = lambda part: 1000 * sum(frame[part]["rmse"] for frame in frames) / len(frames)
            print_row(f"`{scene}`", f"({motion.replace(',', ', ')})", f"`{spec}`",
                      *(f"{mean(part):.2f}" for part in ("error", "visibility", "shading")))


match sys.argv[1:]:
    case ["errors", program, "-o", folder]:
        errors(program, pathlib.Path(folder))
    case ["precision", program, folder]:
        precision(program, pathlib.Path(folder))
    case ["moving", program]:
        moving(program)
    case _:
        sys.exit(__doc__.strip())
