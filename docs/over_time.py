#!/usr/bin/env python3
"""Compares the error and flicker of TAA and DVM with those of MSAA over 60 frames, for docs/techniques.md.

usage: docs/over_time.py [--degrees N] PROGRAM SCENE... MODEL.obj...

PROGRAM is for instance beampipe. Scenes are measured under a still camera, and models under one that goes around them by
N degrees (default: 3). A model may be compressed with xz.
"""
import argparse
import math
import pathlib
import tempfile

import measure

TECHNIQUES = ["msaa:8", "taa:8", "dvm", "dvm:material=draw"]
FRAMES = 60
EYE = "26.6493,29.5936,50.1809"  # of models: shows all of the schooner from the front right


def flicker(frames, first, last):
    """Root mean square over frames, counted from 1."""
    values = [frame["flicker"] ** 2 for frame in frames[first - 1:last]]
    return math.sqrt(sum(values) / len(values))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--degrees", type=float, default=3)
    parser.add_argument("program")
    parser.add_argument("scenes", nargs="+")
    options = parser.parse_args()
    program = options.program
    measure.print_head("trace, 320 x 180", "technique", "first frame", "after 8", f"after {FRAMES}", "flicker, frames 2-8",
                       f"{FRAMES - 7}-{FRAMES}")
    with tempfile.TemporaryDirectory() as folder:
        trace = f"{folder}/trace.json"
        for what in options.scenes:
            orbit = ["--orbit", f"{options.degrees:g}", f"--eye={EYE}"] if what.endswith(".obj") else []
            with measure.unpacked(what) as source:
                measure.make(program, source, trace, "--frames", str(FRAMES), *orbit)
            results = measure.results(program, "compare", trace, TECHNIQUES, folder, "--ladder", "8")
            for spec in TECHNIQUES:
                frames = results[spec]["frames"]
                errors = [frames[i - 1]["error"]["rmse"] for i in (1, 8, FRAMES)]
                measure.print_row(pathlib.Path(what).stem, f"`{spec}`", *[f"{error:.4f}" for error in errors],
                                  f"{flicker(frames, 2, 8):.4f}", f"{flicker(frames, FRAMES - 7, FRAMES):.4f}")


main()
