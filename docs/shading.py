#!/usr/bin/env python3
"""Makes the tables of docs/shading.md.

usage: docs/shading.py PROGRAM FOLDER [SCENE...]

PROGRAM is for instance build/release/tools/beampipe. The script makes the scenes with materials (or only those that are
named) at 320 x 180, measures each technique on them, and prints for each scene the whole error, the errors of visibility
and of shading, and the equivalent MSAA rates. Then it prints what the G-buffer's precision changes: the difference of
the pictures of `deferred` and `msaa:1`, which shade the same samples. Last come the techniques that need time: the mean
error of the second half of 16 frames at 160 x 90, in which the picture moves by (0.31, 0.17) pixels per frame.
The results of `compare`, with the pictures, go to FOLDER.
"""
import pathlib
import sys

from measure import difference, make, print_head, print_row, results

SCENES = ["room", "rigging", "leaves", "bumps", "sheets", "tiles"]
SPECS = ["beam", "beam:at=visible", "beam:at=quarters", "beam:at=sixteenths", "beam:order=stream", "msaa:8",
         "msaa:8,at=centroid", "msaa:8,alpha=coverage", "msaa:32", "msaa:256", "acaa:8", "msaa:1", "deferred",
         "visibility"]
MOVING = ["visibility", "taa:8", "dvm"]
FRAMES = 16


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
    scenes = sys.argv[3:] or SCENES
    precision = {}
    for scene in scenes:
        trace = make(program, scene, folder / f"{scene}.json", "--width", "320", "--height", "180")
        found = results(program, "compare", trace, SPECS, folder / scene, "--no-memory-model")
        print(f"`{scene}`:\n")
        print_head("technique", "RMSE × 1000", "visibility", "shading", "EMR", "EMR of visibility")
        for spec in SPECS:
            result = found[spec]
            print_row(f"`{spec}`", f"{1000 * result['error']['rmse']:.2f}",
                      f"{1000 * result['visibility']['rmse']:.2f}", f"{1000 * result['shading']['rmse']:.2f}",
                      rate(result), rate(result["visibility"]))
        precision[scene] = difference(program, folder / scene / found["deferred"]["frames"][0]["image"],
                                      folder / scene / found["msaa:1"]["frames"][0]["image"])["rmse"]
        print(flush=True)
    print("Precision of the G-buffer:\n")
    print_head("scene", "RMSE × 1000 of `deferred` against `msaa:1`")
    for scene, rmse in precision.items():
        print_row(f"`{scene}`", f"{1000 * rmse:.2f}")
    print("\nTechniques that need time:\n")
    print_head("scene", "technique", "RMSE × 1000", "visibility", "shading")
    for scene in scenes:
        trace = make(program, scene, folder / f"{scene}_moving.json", "--width", "160", "--height", "90", "--frames",
                     str(FRAMES), "--pan", "0.31,0.17")
        found = results(program, "compare", trace, MOVING, folder / f"{scene}_moving", "--no-memory-model")
        for spec in MOVING:
            frames = found[spec]["frames"][FRAMES // 2:]
            mean = lambda part: 1000 * sum(frame[part]["rmse"] for frame in frames) / len(frames)
            print_row(f"`{scene}`", f"`{spec}`", *(f"{mean(part):.2f}" for part in ("error", "visibility", "shading")))


main()
