#!/usr/bin/env python3
"""Makes the tables of docs/accuracy.md about causes of error, order of triangles, and flicker.

usage: docs/diagnosis.py causes PROGRAM [TRACE...]
       docs/diagnosis.py orders PROGRAM [SCENE or TRACE...]
       docs/diagnosis.py motion PROGRAM [SCENE...]

PROGRAM is for instance build/release/tools/beampipe. `causes` measures the nine procedural scenes, which it makes, and
the given traces. `orders` and `motion` measure the given scenes and traces, or all procedural scenes if none is given.
`motion` renders eight frames whose pictures move by 0.19 and 0.07 pixels per frame.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

SCENES = ["hairball", "classroom", "boat", "pickets", "terrain", "sphere", "fence", "soup", "foliage"]
EXPLAINED = ["beam", "beam:order=sorted", "beam:rules=paper"]
ORDERED = ["beam:order=sorted", "beam:rules=paper", "beam:order=stream,passes=0", "z3", "msaa:8", "reference"]
MOVED = ["beam:order=sorted", "beam:rules=paper", "beam:order=stream,passes=0", "msaa:8", "msaa:32", "msaa:256"]


def compare(program, trace, folder, *arguments):
    """Results by technique."""
    subprocess.run([program, "compare", trace, *arguments, "--ladder", "8", "-o", folder], check=True,
                   stdout=subprocess.DEVNULL)
    with open(f"{folder}/report.json", encoding="utf-8") as file:
        return {result["technique"]: result for result in json.load(file)["results"]}


def make(program, scene, folder, *arguments):
    trace = f"{folder}/{scene}.json"
    subprocess.run([program, "make", scene, *arguments, "-o", trace], check=True, stdout=subprocess.DEVNULL)
    return trace


def print_table(titles, rows):
    print("| " + " | ".join(titles) + " |")
    print("|---" * len(titles) + "|")
    for row in rows:
        print("| " + " | ".join(row) + " |", flush=True)
    print()


def causes(program, traces, folder):
    found = {}
    for trace in [*(make(program, scene, folder) for scene in SCENES), *traces]:
        found[pathlib.Path(trace).stem] = compare(program, trace, f"{folder}/out", "-t", *EXPLAINED, "msaa:8", "--causes")
    for spec in EXPLAINED:
        names = list(next(iter(found.values()))[spec]["error_causes"])
        print_table([f"`{spec}`", "RMSE × 1000", *names],
                    [[scene, f"{1000 * results[spec]['error']['rmse']:.2f}",
                      *(f"{100 * results[spec]['error_causes'][name]:.0f} %" for name in names)]
                     for scene, results in found.items()])


def orders(program, what, folder):
    """`what`: procedural scenes or traces."""
    names = ["given", "shuffled", "near_to_far", "far_to_near", "largest_difference"]
    rows = []
    for scene in what or SCENES:
        trace = make(program, scene, folder) if scene in SCENES else scene
        results = compare(program, trace, f"{folder}/out", "-t", *ORDERED[:-1], "--orders")
        for spec in ORDERED:
            values = [results[spec]["orders"][name] for name in names]
            rows.append([pathlib.Path(scene).stem, f"`{spec}`",
                         *(f"{1000 * (v['rmse'] if isinstance(v, dict) else v):.3f}" for v in values)])
    print_table(["scene", "RMSE × 1000", *(name.replace("_", " ") for name in names)], rows)


def motion(program, scenes, folder):
    rows = []
    for scene in scenes or SCENES:
        trace = make(program, scene, folder, "--frames", "8", "--pan", "0.19,0.07")
        results = compare(program, trace, f"{folder}/out", "-t", *MOVED)
        rows.append([scene, *(f"{1000 * results[spec]['flicker']:.2f}" for spec in MOVED)])
    print_table(["flicker × 1000", *(f"`{spec}`" for spec in MOVED)], rows)


def main():
    if len(sys.argv) < 3 or sys.argv[1] not in ("causes", "orders", "motion"):
        sys.exit(__doc__.strip())
    with tempfile.TemporaryDirectory() as folder:
        {"causes": causes, "orders": orders, "motion": motion}[sys.argv[1]](sys.argv[2], sys.argv[3:], folder)


main()
