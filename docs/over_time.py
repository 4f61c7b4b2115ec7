#!/usr/bin/env python3
"""Compares the error and flicker of TAA and DVM with those of MSAA over time, for docs/techniques.md.

usage: docs/over_time.py PROGRAM WHAT...

PROGRAM is for instance beampipe. WHAT is a scene, which stands under a still camera for 60 frames, or a file of
traces/samples.
"""
import math
import pathlib
import sys
import tempfile

import measure

TECHNIQUES = ["msaa:8", "taa:8", "dvm", "dvm:clamp=camera", "dvm:clamp=variance"]
FRAMES = 60
SAMPLES = pathlib.Path(__file__).resolve().parent.parent / "traces/samples"


def flicker(frames):
    """Root mean square over frames."""
    return math.sqrt(sum(frame["flicker"] ** 2 for frame in frames) / len(frames))


def main(program, names, folder):
    measure.print_head("scene", "technique", "first frame", "after 8", "after all", "flicker, frames 2-8", "last 8")
    for name in names:
        if name.endswith(".json"):
            trace = str(SAMPLES / name)
        else:
            trace = measure.make(program, name, f"{folder}/trace.json", "--frames", str(FRAMES))
        results = measure.results(program, "compare", trace, TECHNIQUES, folder, "--ladder", "8")
        for spec in TECHNIQUES:
            frames = results[spec]["frames"]
            errors = [frames[i]["error"]["rmse"] for i in (0, 7, -1)]
            measure.print_row(pathlib.Path(name).stem, f"`{spec}`", *[f"{error:.4f}" for error in errors],
                              f"{flicker(frames[1:8]):.4f}", f"{flicker(frames[-8:]):.4f}")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__.strip())
    with tempfile.TemporaryDirectory() as scratch:
        main(sys.argv[1], sys.argv[2:], scratch)
