#!/usr/bin/env python3
"""Counts the triangles that are shaded in several 2 x 2 quads, by their size, for docs/techniques.md.

usage: docs/quad_spans.py PROGRAM

PROGRAM is for instance beampipe. Right-angled triangles, turned four ways, are dropped at random, each far from others.
"""
import json
import math
import random
import subprocess
import sys
import tempfile

from detail import rows_of
from measure import print_head, print_row

SIZES = [0.5, 1, 2]  # the legs, in pixels
CELL = 6  # pixels; a triangle that begins in the second quad of its cell stays away from the cells around it
COLUMNS, ROWS = 150, 150
EYE = 1000  # distance at which a unit is a pixel


def write_trace(size, path):
    dice = random.Random(1)
    width, height = COLUMNS * CELL, ROWS * CELL
    positions = []
    for cell in range(COLUMNS * ROWS):
        x = cell % COLUMNS * CELL + 2 + dice.uniform(0, 2) - width / 2
        y = cell // COLUMNS * CELL + 2 + dice.uniform(0, 2) - height / 2
        corners = [(x, y), (x + size, y), (x + size, y + size), (x, y + size)]
        del corners[dice.randrange(4)]
        positions += [coordinate for corner in corners for coordinate in (*corner, 0)]
    fovy = 2 * math.degrees(math.atan(height / 2 / EYE))
    frame = {"width": width, "height": height, "background": [0, 0, 0],
             "camera": {"eye": [0, 0, EYE], "target": [0, 0, 0], "up": [0, 1, 0], "fovy_deg": fovy, "near": EYE / 2,
                        "far": 2 * EYE},
             "draws": [{"mesh": "triangles", "kd": [1, 1, 1]}]}
    mesh = {"positions": positions, "indices": list(range(3 * COLUMNS * ROWS))}
    with open(path, "w", encoding="utf-8") as file:
        json.dump({"beampipe_trace": 1, "meshes": {"triangles": mesh}, "frames": [frame]}, file)


def quads_by_triangle(picture):
    """The number of quads that each triangle covers samples of, for those that cover any."""
    quads = {}
    for y, row in enumerate(rows_of(picture)):
        for x, color in enumerate(row):
            if any(color):
                quads.setdefault((x // CELL, y // CELL), set()).add((x // 2, y // 2))
    return [len(touched) for touched in quads.values()]


def main(program, folder):
    print_head("legs, px", "touch a boundary", "`msaa:1`: cover a sample", "of these, in several quads",
               "`msaa:8`: cover a sample", "of these, in several quads")
    for size in SIZES:
        write_trace(size, f"{folder}/trace.json")
        subprocess.run([program, "run", f"{folder}/trace.json", "-t", "msaa:1", "msaa:8", "--no-memory-model",
                        "--force", "-o", f"{folder}/out"], check=True, stdout=subprocess.DEVNULL)
        cells = [f"{1 - (1 - size / 2) ** 2:.3f}"]
        for technique in "msaa_1", "msaa_8":
            quads = quads_by_triangle(f"{folder}/out/{technique}/frame_0000.png")
            cells += [f"{len(quads) / (COLUMNS * ROWS):.3f}", f"{sum(q > 1 for q in quads) / len(quads):.3f}"]
        print_row(size, *cells)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__.strip())
    with tempfile.TemporaryDirectory() as scratch:
        main(sys.argv[1], scratch)
