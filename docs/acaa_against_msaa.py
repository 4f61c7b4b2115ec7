#!/usr/bin/env python3
"""ACAA against MSAA, scene by scene, as docs/techniques.md shows it.

usage: docs/acaa_against_msaa.py PROGRAM [TRACE...]

PROGRAM is for instance build/release/tools/beampipe. Measured are the nine procedural scenes, which it makes, and the
traces that are named.
"""
import pathlib
import sys
import tempfile

import measure

PICTURES = ["acaa:8", "acaa:8,double=stencil", "acaa:8,double=saturate", "acaa:8,color=unorm8"]
ONE, EIGHT, ACAA = "msaa:1,prepass", "msaa:8,prepass", "acaa:8"
DEPTH_BYTES = 4  # per sample


def surface_bytes(result):
    """Logical bytes that a frame moves to and from its depth and colour: what no fragment carries between stages."""
    stages = measure.stages(result)
    test, resolve = stages["depth_test"], stages["resolve"]
    moved = test["items_in"] * DEPTH_BYTES + test["bytes_written"] + resolve["bytes_read"] + resolve["bytes_written"]
    if "accumulate" in stages:  # what is added to was read before
        moved += 2 * stages["accumulate"]["bytes_written"]
    return moved


def all_bytes(result):
    return sum(stage["bytes_read"] + stage["bytes_written"] for stage in measure.stages(result).values())


def given_back(results, count):
    one, eight, acaa = (count(results[spec]) for spec in (ONE, EIGHT, ACAA))
    return (eight - acaa) / (eight - one)


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__.strip())
    program, shares = sys.argv[1], []
    measure.print_head("scene", *[f"`{spec}`" for spec in PICTURES],
                       *[f"MB moved: `{spec}`" for spec in (ONE, EIGHT, ACAA)], "given back", "of all counted bytes")
    with tempfile.TemporaryDirectory() as folder:
        traces = [(path, pathlib.Path(path).stem) for path in sys.argv[2:]]
        traces += [(measure.make(program, scene, f"{folder}/{scene}.json"), scene) for scene in measure.PROCEDURAL]
        for trace, name in traces:
            results = measure.results(program, "run", trace, [ONE, EIGHT, *PICTURES], folder)
            truth = f"{folder}/{results[EIGHT]['frames'][0]['image']}"
            differences = [measure.rmse(program, f"{folder}/{results[spec]['frames'][0]['image']}", truth)
                           for spec in PICTURES]
            shares.append([given_back(results, surface_bytes), given_back(results, all_bytes)])
            measure.print_row(name, *[f"{difference:.5f}" for difference in differences],
                              *[f"{surface_bytes(results[spec]) / 1e6:.2f}" for spec in (ONE, EIGHT, ACAA)],
                              *[f"{100 * share:.0f} %" for share in shares[-1]])
    means = [sum(column) / len(shares) for column in zip(*shares)]
    measure.print_row(f"mean of {len(shares)}", *[""] * 7, *[f"{100 * mean:.0f} %" for mean in means])


main()
