#!/usr/bin/env python3
"""Compares the error and flicker of TAA and DVM with those of MSAA over 60 frames, for docs/techniques.md.

usage: docs/over_time.py PROGRAM SCENE...

PROGRAM is for instance beampipe. The scenes stand under a still camera.
"""
import math
import sys
import tempfile

import measure

TECHNIQUES = ["msaa:8", "taa:8", "dvm"]
FRAMES = 60


def flicker(frames, first, last):
    """Root mean square over frames, counted from 1."""
    values = [frame["flicker"] ** 2 for frame in frames[first - 1:last]]
    return math.sqrt(sum(values) / len(values))


def main(program, scenes, folder):
    measure.print_head("scene", "technique", "first frame", "after 8", f"after {FRAMES}", "flicker, frames 2-8",
                       f"{FRAMES - 7}-{FRAMES}")
    for scene in scenes:
        trace = measure.make(program, scene, f"{folder}/trace.json", "--frames", str(FRAMES))
        results = measure.results(program, "compare", trace, TECHNIQUES, folder, "--ladder", "8")
        for spec in TECHNIQUES:
            frames = results[spec]["frames"]
            errors = [frames[i - 1]["error"]["rmse"] for i in (1, 8, FRAMES)]
            measure.print_row(scene, f"`{spec}`", *[f"{error:.4f}" for error in errors],
                              f"{flicker(frames, 2, 8):.4f}", f"{flicker(frames, FRAMES - 7, FRAMES):.4f}")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__.strip())
    with tempfile.TemporaryDirectory() as scratch:
        main(sys.argv[1], sys.argv[2:], scratch)
