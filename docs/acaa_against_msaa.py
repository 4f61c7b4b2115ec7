#!/usr/bin/env python3
"""Compares ACAA with MSAA, scene by scene, for docs/techniques.md.

usage: docs/acaa_against_msaa.py PROGRAM TRACE...

PROGRAM is for instance beampipe. Prints the RMSE between the picture of each ACAA and that of msaa:8, and which part of
the DRAM bytes that seven more samples cost MSAA are saved by ACAA.
"""
import pathlib
import sys
import tempfile

import measure

PICTURES = ["acaa:8", "acaa:8,double=stencil", "acaa:8,double=saturate", "acaa:8,color=unorm8"]
ONE, EIGHT, ACAA = "msaa:1,prepass", "msaa:8,prepass", "acaa:8"


def dram_bytes(result):
    return sum(stage["dram_bytes"] for stage in measure.stages(result).values())


def main(program, traces, folder):
    measure.print_head("scene", *[f"`{spec}`" for spec in PICTURES], "DRAM bytes saved")
    for trace in traces:
        results = measure.results(program, "run", trace, [ONE, EIGHT, *PICTURES], folder)
        picture = {spec: f"{folder}/{result['frames'][0]['image']}" for spec, result in results.items()}
        differences = [measure.difference(program, picture[spec], picture[EIGHT])["rmse"] for spec in PICTURES]
        one, eight, acaa = (dram_bytes(results[spec]) for spec in (ONE, EIGHT, ACAA))
        measure.print_row(pathlib.Path(trace).stem, *[f"{difference:.5f}" for difference in differences],
                          f"{100 * (eight - acaa) / (eight - one):.0f} %")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__.strip())
    with tempfile.TemporaryDirectory() as scratch:
        main(sys.argv[1], sys.argv[2:], scratch)
