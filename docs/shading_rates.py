#!/usr/bin/env python3
"""Shading rates by technique and triangle density, as docs/techniques.md shows them.

usage: docs/shading_rates.py PROGRAM   (for instance build/release/tools/beampipe)
"""
import json
import subprocess
import sys
import tempfile

WIDTH, HEIGHT = 640, 360
DENSITIES = [("low", 1000), ("medium", 10), ("high", 0.5)]  # pixels per triangle
# Spec, and the times in ms of the article's shading passes: Material (with light for forward), or Material + Lighting.
PATHS = [
    ("msaa:1,prepass", "forward 1x", (1.600, 3.881, 8.987)),
    ("msaa:2,prepass", "forward 2x", (1.615, 4.705, 15.262)),
    ("msaa:4,prepass", "forward 4x", (1.648, 5.649, 23.261)),
    ("msaa:8,prepass", "forward 8x", (1.686, 6.382, 27.211)),
    ("deferred", "deferred, material", (1.06, 2.942, 4.640)),
    ("visibility", "visibility, material", (1.239, 1.614, 1.696)),
    ("dvm", "DVM, material", (1.250, 1.618, 1.745)),
]


def invocations(program, folder, pixels_per_triangle):
    """Shader lanes issued per pixel, and the part of them that were not helpers, by spec."""
    trace = f"{folder}/density.json"
    triangles = round(WIDTH * HEIGHT / pixels_per_triangle)
    subprocess.run([program, "make", "density", "--triangles", str(triangles), "--width", str(WIDTH),
                    "--height", str(HEIGHT), "-o", trace], check=True, stdout=subprocess.DEVNULL)
    specs = [spec for spec, _, _ in PATHS]
    subprocess.run([program, "run", trace, "-t", *specs, "-o", folder], check=True, stdout=subprocess.DEVNULL)
    with open(f"{folder}/report.json", encoding="utf-8") as file:
        report = json.load(file)
    found = {}
    for result in report["results"]:
        shade = next(s for s in result["frames"][0]["stages"] if s["stage"] == "shade")
        found[result["technique"]] = (shade["lanes_issued"] / (WIDTH * HEIGHT), shade["lanes_used"] / shade["lanes_issued"])
    return found


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__.strip())
    with tempfile.TemporaryDirectory() as folder:
        counted = [invocations(sys.argv[1], folder, pixels) for _, pixels in DENSITIES]
    names = " | ".join(f"{name}, {pixels} px" for name, pixels in DENSITIES)
    print(f"| invocations per pixel (lanes with work) | {names} | counted ratio | timed ratio |")
    print("|---" * (len(DENSITIES) + 3) + "|")
    for spec, name, times in PATHS:
        cells = " | ".join(f"{counts[spec][0]:.2f} ({100 * counts[spec][1]:.0f} %)" for counts in counted)
        ratios = " : ".join(f"{counts[spec][0] / counted[0][spec][0]:.2f}" for counts in counted)
        timed = " : ".join(f"{time / times[0]:.2f}" for time in times)
        print(f"| {name} | {cells} | {ratios} | {timed} |")
    print("\n| over forward 1x at the same density |" + "".join(f" {name}, counted | timed |" for name, _ in DENSITIES))
    print("|---" * (2 * len(DENSITIES) + 1) + "|")
    for spec, name, times in PATHS[1:4]:
        cells = "".join(f" {counts[spec][0] / counts[PATHS[0][0]][0]:.2f} | {time / first:.2f} |"
                        for counts, time, first in zip(counted, times, PATHS[0][2]))
        print(f"| {name} |{cells}")


main()
