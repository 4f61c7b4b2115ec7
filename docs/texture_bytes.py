#!/usr/bin/env python3
"""Makes the table of docs/costs.md about the texels of a frame, by level of the memory system.

usage: docs/texture_bytes.py PROGRAM

PROGRAM is for instance build/release/tools/beampipe. The scenes have materials; pictures are 640 x 360.
"""
import pathlib
import sys
import tempfile

import measure

SCENES = ["room", "leaves", "tiles"]
SPECS = ["beam", "msaa:8"]
LEVELS = ["texture_bytes", "texture_sector_bytes", "texture_l2_bytes", "texture_dram_bytes"]


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__.strip())
    program = sys.argv[1]
    measure.print_head("scene", "technique", "invocations, millions", "texels, MB", "sectors", "L2", "DRAM",
                       "DRAM, all data")
    for scene in SCENES:
        with tempfile.TemporaryDirectory() as folder:
            trace = measure.make(program, scene, pathlib.Path(folder) / "trace.json", "--width", "640", "--height",
                                 "360")
            results = measure.results(program, "run", trace, SPECS, pathlib.Path(folder) / "results")
        for spec in SPECS:
            stages = measure.stages(results[spec])
            sums = [sum(stage[level] for stage in stages.values()) / 1e6 for level in LEVELS]
            measure.print_row(f"`{scene}`", f"`{spec}`", f"{stages['shade']['lanes_issued'] / 1e6:.2f}",
                              *[f"{value:.1f}" for value in sums],
                              f"{results[spec]['frames'][0]['dram_bytes'] / 1e6:.1f}")


main()
