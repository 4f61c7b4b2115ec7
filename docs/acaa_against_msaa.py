#!/usr/bin/env python3
"""Compares ACAA with MSAA, scene by scene, for docs/techniques.md.

usage: docs/acaa_against_msaa.py scenes    PROGRAM TRACE...
       docs/acaa_against_msaa.py precision PROGRAM TRACE

PROGRAM is for instance beampipe. `scenes` compares pictures and bytes, `precision` the formats of the accumulator.
"""
import pathlib
import sys
import tempfile

import measure

PICTURES = ["acaa:8", "acaa:8,double=stencil", "acaa:8,double=saturate", "acaa:8,color=unorm8"]
ONE, EIGHT, ACAA = "msaa:1,prepass", "msaa:8,prepass", "acaa:8"
DEPTH_BYTES = 4  # per sample
SAMPLES, FORMATS = [8, 64, 256], ["unorm8", "fp16", "fp32"]  # for precision()


def surface_bytes(result):
    """Logical bytes that a frame moves to and from its depth and colour surfaces, without fragments between stages."""
    stages = measure.stages(result)
    resolve = stages["resolve"]
    moved = resolve["bytes_read"] + resolve["bytes_written"]
    for test in (stages["prepass_depth_test"], stages["depth_test"]):
        moved += test["items_in"] * DEPTH_BYTES + test["bytes_written"]
    if "accumulate" in stages:  # adding reads the accumulator first
        moved += 2 * stages["accumulate"]["bytes_written"]
    return moved


def all_bytes(result):
    return sum(stage["bytes_read"] + stage["bytes_written"] for stage in measure.stages(result).values())


def dram_bytes(result):
    return sum(stage["dram_bytes"] for stage in measure.stages(result).values())


def given_back(results, count):
    one, eight, acaa = (count(results[spec]) for spec in (ONE, EIGHT, ACAA))
    return (eight - acaa) / (eight - one)


COUNTS = {"surface bytes": surface_bytes, "all counted bytes": all_bytes, "DRAM bytes": dram_bytes}


def precision(program, trace, folder):
    """The accumulator's formats: RMSE and bias between ACAA's pictures and MSAA's, at several numbers of samples."""
    measure.print_head("`color=`", *[f"N = {samples}: RMSE, bias" for samples in SAMPLES])
    specs = [f"acaa:{samples},color={color}" for samples in SAMPLES for color in FORMATS]
    results = measure.results(program, "run", trace, [f"msaa:{samples}" for samples in SAMPLES] + specs, folder)
    picture = {spec: f"{folder}/{result['frames'][0]['image']}" for spec, result in results.items()}
    for color in FORMATS:
        found = [measure.difference(program, picture[f"acaa:{samples},color={color}"], picture[f"msaa:{samples}"])
                 for samples in SAMPLES]
        measure.print_row(f"`{color}`", *[f"{difference['rmse']:.5f}, {difference['bias']:+.5f}" for difference in found])


def scenes(program, traces, folder):
    shares = []
    measure.print_head("scene", *[f"`{spec}`" for spec in PICTURES],
                       *[f"MB per frame: `{spec}`" for spec in (ONE, EIGHT, ACAA)], *[f"given back of {what}" for what in COUNTS])
    for trace in traces:
        results = measure.results(program, "run", trace, [ONE, EIGHT, *PICTURES], folder)
        truth = f"{folder}/{results[EIGHT]['frames'][0]['image']}"
        differences = [measure.difference(program, f"{folder}/{results[spec]['frames'][0]['image']}", truth)["rmse"]
                       for spec in PICTURES]
        shares.append([given_back(results, count) for count in COUNTS.values()])
        measure.print_row(pathlib.Path(trace).stem, *[f"{difference:.5f}" for difference in differences],
                          *[f"{surface_bytes(results[spec]) / 1e6:.2f}" for spec in (ONE, EIGHT, ACAA)],
                          *[f"{100 * share:.0f} %" for share in shares[-1]])
    means = [sum(column) / len(shares) for column in zip(*shares)]
    measure.print_row(f"mean of {len(shares)}", *[""] * 7, *[f"{100 * mean:.0f} %" for mean in means])


def main():
    if len(sys.argv) < 4 or sys.argv[1] not in ("scenes", "precision"):
        sys.exit(__doc__.strip())
    with tempfile.TemporaryDirectory() as folder:
        if sys.argv[1] == "scenes":
            scenes(sys.argv[2], sys.argv[3:], folder)
        else:
            precision(sys.argv[2], sys.argv[3], folder)


main()
