#!/usr/bin/env python3
"""Makes the tables of docs/accuracy.md about causes of error, order of triangles, and flicker.

usage: docs/diagnosis.py causes RESULTS...
       docs/diagnosis.py orders RESULTS...
       docs/diagnosis.py motion RESULTS...

RESULTS are folders of `beampipe compare`, one for each scene: with --causes, with --orders, or of several frames.
"""
import json
import pathlib
import statistics
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


def specs_of(found):
    return [spec for spec in next(iter(found.values())) if spec != "reference"]


def print_causes(found):
    """Of each cause, the median over the scenes of its share of the squared error, and the largest share."""
    names = list(next(iter(found.values()))["beam"]["error_causes"])
    print_head("technique", *names)
    for spec in specs_of(found):
        shares = {name: [100 * by_spec[spec]["error_causes"][name] for by_spec in found.values()] for name in names}
        print_row(f"`{spec}`", *(f"{round(statistics.median(each))} %, {round(max(each))} %" for each in shares.values()))


def print_orders(found):
    """RMS difference between the pictures of the two orders that differ most."""
    print_head("technique", *found)
    for spec in specs_of(found):
        print_row(f"`{spec}`", *(f"{1000 * by_spec[spec]['orders']['largest_difference']:.3f}"
                                 for by_spec in found.values()))


def print_motion(found):
    specs = specs_of(found)
    print_head("flicker × 1000", *(f"`{spec}`" for spec in specs))
    for scene, by_spec in found.items():
        print_row(scene, *(f"{1000 * by_spec[spec]['flicker']:.2f}" for spec in specs))


TABLES = {"causes": print_causes, "orders": print_orders, "motion": print_motion}


def main(arguments):
    match arguments:
        case [kind, *folders] if kind in TABLES and folders:
            TABLES[kind](results(folders))
        case _:
            sys.exit(__doc__.strip())


main(sys.argv[1:])
