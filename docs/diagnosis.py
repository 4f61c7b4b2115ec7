#!/usr/bin/env python3
"""Makes the tables of docs/accuracy.md about causes of error, order of triangles, and flicker.

usage: docs/diagnosis.py causes SPEC RESULTS...
       docs/diagnosis.py orders RESULTS...
       docs/diagnosis.py motion RESULTS...

RESULTS are folders of `beampipe compare`, one for each scene: with --causes, with --orders, or of several frames.
"""
import json
import pathlib
import sys

from measure import PROCEDURAL, print_head, print_row


def results(folders):
    """Results by technique, by scene: procedural ones first."""
    found = {}
    for folder in map(pathlib.Path, folders):
        report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
        found[folder.name] = {result["technique"]: result for result in report["results"]}
    names = [*(name for name in PROCEDURAL if name in found), *sorted(set(found) - set(PROCEDURAL))]
    return {name: found[name] for name in names}


def print_causes(spec, found):
    names = list(next(iter(found.values()))[spec]["error_causes"])
    print_head(f"`{spec}`", "RMSE × 1000", *names)
    for scene, by_spec in found.items():
        print_row(scene, f"{1000 * by_spec[spec]['error']['rmse']:.2f}",
                  *(f"{round(100 * by_spec[spec]['error_causes'][name])} %" for name in names))


def print_orders(found):
    names = ["given", "shuffled", "near_to_far", "far_to_near", "largest_difference"]
    print_head("scene", "RMSE × 1000", *(name.replace("_", " ") for name in names))
    for scene, by_spec in found.items():
        for spec, result in by_spec.items():
            if spec == "reference":
                continue
            values = [result["orders"][name] for name in names]
            print_row(scene, f"`{spec}`", *(f"{1000 * (v['rmse'] if isinstance(v, dict) else v):.3f}" for v in values))


def print_motion(found):
    specs = [spec for spec in next(iter(found.values())) if spec != "reference"]
    print_head("flicker × 1000", *(f"`{spec}`" for spec in specs))
    for scene, by_spec in found.items():
        print_row(scene, *(f"{1000 * by_spec[spec]['flicker']:.2f}" for spec in specs))


def main(arguments):
    match arguments:
        case ["causes", spec, *folders] if folders:
            print_causes(spec, results(folders))
        case ["orders", *folders] if folders:
            print_orders(results(folders))
        case ["motion", *folders] if folders:
            print_motion(results(folders))
        case _:
            sys.exit(__doc__.strip())


main(sys.argv[1:])
