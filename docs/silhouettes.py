#!/usr/bin/env python3
"""Measures where a technique should shade a triangle that does not cover the whole pixel.

usage: docs/silhouettes.py PROGRAM -o FOLDER

PROGRAM is for instance beampipe. The scene is 60 slats, 4 pixels wide, that lie over each other at
all angles; across each, the colour rises from 0 to 1. The colour is linear over a slat, so that shading at the middle of
what is visible is exact, and every error of shading comes from a silhouette. Prints the error of shading of each
technique, as a multiple of that of the first. The trace and the results go to FOLDER.
"""
import json
import math
import pathlib
import random
import sys

from measure import print_head, print_row, results

WIDTH, HEIGHT, SLATS, LENGTH, THICKNESS = 320, 180, 60, 150, 4
SPECS = ["msaa:8", "msaa:8,at=centroid", "acaa:8", "beam", "beam:at=covered", "beam:at=quarters", "msaa:256"]


def slats(seed):
    source = random.Random(seed)
    positions, colors, indices = [], [], []
    for slat in range(SLATS):
        x, y, angle = source.uniform(0, WIDTH), source.uniform(0, HEIGHT), source.uniform(0, math.pi)
        along = (math.cos(angle) * LENGTH / 2, math.sin(angle) * LENGTH / 2)
        across = (-math.sin(angle) * THICKNESS / 2, math.cos(angle) * THICKNESS / 2)
        for side, end in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
            place = [x + side * across[0] + end * along[0], y + side * across[1] + end * along[1]]
            positions += [2 * place[0] / WIDTH - 1, 1 - 2 * place[1] / HEIGHT, slat / SLATS]
            colors += [max(side, 0), max(side, 0) * 0.5, 1 - max(side, 0), 1]
        first = 4 * slat
        indices += [first, first + 1, first + 2, first, first + 2, first + 3]
    return {"positions": positions, "indices": indices, "vertex_colors": colors, "materials": ["ramp"]}


def main():
    if len(sys.argv) != 4 or sys.argv[2] != "-o":
        sys.exit(__doc__.strip())
    program, folder = sys.argv[1], pathlib.Path(sys.argv[3])
    folder.mkdir(parents=True, exist_ok=True)
    trace = folder / "slats.json"
    trace.write_text(json.dumps({
        "beampipe_trace": 2,
        "materials": {"ramp": {"unlit": True, "double_sided": True}},
        "meshes": {"slats": slats(1)},
        "frames": [{"width": WIDTH, "height": HEIGHT, "draws": [{"mesh": "slats"}]}]}))
    found = results(program, "compare", trace, SPECS, folder / "results", "--no-memory-model")
    base = found[SPECS[0]]["shading"]["rmse"]
    print_head("technique", "RMSE of shading × 1000", "÷ that of `msaa:8`", "RMSE of visibility × 1000")
    for spec in SPECS:
        shading = found[spec]["shading"]["rmse"]
        print_row(f"`{spec}`", f"{1000 * shading:.2f}", f"{shading / base:.2f}",
                  f"{1000 * found[spec]['visibility']['rmse']:.2f}")


main()
