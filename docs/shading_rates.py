#!/usr/bin/env python3
"""Measures shading rates by technique and triangle density, for docs/techniques.md.

usage: docs/shading_rates.py PROGRAM   (for instance build/release/tools/beampipe)
"""
import sys
import tempfile

import measure

WIDTH, HEIGHT = 640, 360
DENSITIES = [("low", 1000), ("medium", 10), ("high", 1), ("high", 0.5)]  # pixels per triangle
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


def count(program, folder, pixels_per_triangle):
    """The material pass's lanes per pixel, by spec: issued, and with work."""
    triangles = round(WIDTH * HEIGHT / pixels_per_triangle)
    trace = measure.make(program, "density", f"{folder}/density.json", "--triangles", str(triangles), "--width",
                         str(WIDTH), "--height", str(HEIGHT))
    results = measure.results(program, "run", trace, [spec for spec, _, _ in PATHS], folder)
    shading = {spec: measure.stages(result)["shade"] for spec, result in results.items()}
    pixels = WIDTH * HEIGHT
    return {spec: (stage["lanes_issued"] / pixels, stage["lanes_used"] / pixels) for spec, stage in shading.items()}


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__.strip())
    with tempfile.TemporaryDirectory() as folder:
        counted = [count(sys.argv[1], folder, pixels) for _, pixels in DENSITIES]
    densities = [f"{name}, {pixels} px" for name, pixels in DENSITIES]

    measure.print_head("invocations per pixel = quads x 4 (of them helpers)", *densities)
    for spec, name, _ in PATHS:
        cells = [counts[spec] for counts in counted]
        in_quads = spec not in ("visibility", "dvm")
        measure.print_row(name, *[f"{issued:.2f} = {issued / 4:.2f} x 4 ({issued - used:.2f})" if in_quads else
                                  f"{issued:.2f}, no quads" for issued, used in cells])
    print()
    measure.print_head("over the low density", *densities[1:], "timed: medium, high")
    for spec, name, times in PATHS:
        low = counted[0][spec][0]
        measure.print_row(name, *[f"{counts[spec][0] / low:.2f}" for counts in counted[1:]],
                          ", ".join(f"{time / times[0]:.2f}" for time in times[1:]))
    print()
    measure.print_head("over forward 1x at the same density", *densities, "timed: low, medium, high")
    forward, _, first = PATHS[0]
    for spec, name, times in PATHS[1:4]:
        measure.print_row(name, *[f"{counts[spec][0] / counts[forward][0]:.2f}" for counts in counted],
                          ", ".join(f"{time / one:.2f}" for time, one in zip(times, first)))


main()
