#!/usr/bin/env python3
"""Makes the tables and the plot of docs/accuracy.md that compare memory with accuracy.

usage: docs/frontier.py PROGRAM FOLDER [TRACE...]

PROGRAM is for instance build/release/tools/beampipe. The script makes the nine procedural scenes, and measures them and
the given traces. The results of `compare` go to FOLDER/<scene> and, of techniques that the plot leaves out, to
FOLDER/others/<scene>. It prints EMR, RMSE and bias of each technique on each
scene, then EMR by all memory, on chip and off chip, also for other capacities of `beam`. It draws the geometric means
over all scenes as FOLDER/frontier.svg and .png.
"""
import math
import pathlib
import subprocess
import sys

from measure import PROCEDURAL, make, print_head, print_row, results, stages

SPECS = ["alpha", "beam:rules=paper", "beam:order=sorted", "z3:shape=32x2", "z3", "z3:shape=128x3",
         "z3:shape=128x3,merge=color", "beam:order=stream,bits=32,passes=0,layers=1",
         "beam:order=stream,bits=64,passes=0,layers=1", "beam:order=stream,bits=128,passes=0,layers=1",
         "beam:order=stream,passes=0", "beam:order=stream,bits=256,passes=0,layers=1", "msaa:8", "msaa:32", "msaa:256"]
CAPACITIES = [f"beam:{bits}slots={slots}" for bits in ["bits=32,", "bits=64,", "bits=128,", ""]
              for slots in [2, 4, 8, 16, 32]]
STORAGE = (CAPACITIES + ["beam", "beam:order=stream", "beam:order=sorted", "beam:rules=paper", "z3", "z3:shape=128x3",
                         "msaa:8", "msaa:32", "msaa:256"])


def rate(value):
    return f"{value:.0f}" if value >= 1000 else f"{value:.3g}"


def emr(result):
    bound = "≥ " if result.get("equivalent_msaa_is_lower_bound") else (
        "< " if result.get("equivalent_msaa_is_upper_bound") else "")
    return bound + rate(result["equivalent_msaa"])


def stage_items(result, name):
    return stages(result)[name]["items_in"]


def print_table(title, found, cell, summary=None):
    print(f"{title}:\n")
    print_head("technique", "bytes", *found, *(["geometric mean", "least"] if summary else []))
    for spec in SPECS:
        row = [scene[spec] for scene in found.values()]
        ends = summary(row) if summary else []
        print_row(f"`{spec}`", row[0]["framebuffer_bytes_per_pixel"], *map(cell, row), *ends)
    print()


def mean_and_least(row):
    rates = [result["equivalent_msaa"] for result in row]
    return [rate(geometric_mean(rates)), rate(min(rates))]


def geometric_mean(values):
    return math.exp(sum(map(math.log, values)) / len(values))


def print_storage(found):
    print("All memory, in bytes per pixel (geometric means over the scenes), and EMR:\n")
    print_head("technique", "on chip", "off chip", "together", "EMR: geometric mean", "least")
    for spec in STORAGE:
        row = [scene[spec] for scene in found.values()]
        places = [[result[f"{place}_chip_bytes_per_pixel"] for result in row] for place in ["on", "off"]]
        together = [sum(bytes) for bytes in zip(*places)]
        print_row(f"`{spec}`", *(f"{geometric_mean(bytes):.0f}" for bytes in [*places, together]), *mean_and_least(row))
    print()


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__.strip())
    program, folder, found = sys.argv[1], sys.argv[2], {}
    pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
    for scene in PROCEDURAL + sys.argv[3:]:
        trace = make(program, scene, f"{folder}/{scene}.json") if scene in PROCEDURAL else scene
        name = pathlib.Path(scene).stem
        found[name] = results(program, "compare", trace, STORAGE, f"{folder}/{name}")
        others = [spec for spec in SPECS if spec not in STORAGE]
        found[name] |= results(program, "compare", trace, others, f"{folder}/others/{name}")
    print_table("EMR", found, emr, mean_and_least)
    print_table("RMSE × 1000", found, lambda result: f"{1000 * result['error']['rmse']:.2f}")
    print_table("Bias × 1000", found, lambda result: f"{1000 * result['error']['bias']:+.2f}")
    print_storage(found)
    print("Fragments merged in all passes, for each of sorted order:\n")
    print_head("technique", *found)
    for spec in SPECS:
        if "order=stream" in spec:
            print_row(f"`{spec}`",
                      *(f"{stage_items(scene[spec], 'claim') / stage_items(scene['beam:order=sorted'], 'a_buffer'):.2f}"
                        for scene in found.values()))
    for kind in ["svg", "png"]:
        subprocess.run([program, "plot", *(f"{folder}/{name}" for name in found), "-o", f"{folder}/frontier.{kind}",
                        "--kind", "storage"], check=True)


main()
