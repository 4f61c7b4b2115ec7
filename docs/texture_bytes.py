#!/usr/bin/env python3
"""Makes the table of docs/accounting.md about the texels of a frame, by level of the memory system.

texture_bytes.py BEAMPIPE TRACE...   the first frame of each trace
"""
import pathlib
import sys
import tempfile

import measure

SPECS = ["beam", "beam:order=stream", "beam:order=sorted", "msaa:8", "msaa:8,prepass", "msaa:32", "acaa:8", "deferred",
         "visibility", "dvm"]
LEVELS = ["texture_bytes", "texture_sector_bytes", "texture_l2_bytes", "texture_dram_bytes"]


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__.strip())
    measure.print_head("scene", "technique", "invocations, millions", "texels, MB", "sectors", "L2", "DRAM",
                       "DRAM, all data")
    for trace in sys.argv[2:]:
        with tempfile.TemporaryDirectory() as folder:
            results = measure.results(sys.argv[1], "run", trace, SPECS, folder, "--frames", "0")
        for spec in SPECS:
            stages = measure.stages(results[spec])
            sums = [sum(stage[level] for stage in stages.values()) / 1e6 for level in LEVELS]
            measure.print_row(pathlib.Path(trace).stem, f"`{spec}`", f"{stages['shade']['lanes_issued'] / 1e6:.2f}",
                              *[f"{value:.1f}" for value in sums],
                              f"{results[spec]['frames'][0]['dram_bytes'] / 1e6:.1f}")


main()
