#!/usr/bin/env python3
"""Measures techniques on the scenes that are only measured, for docs/accuracy.md.

usage: docs/held_out.py sweep PROGRAM -o DIR          every spec below on these scenes, at 320 x 180
       docs/held_out.py unlit PROGRAM MODELS -o DIR   some specs on models in the plain colours of their materials
       docs/held_out.py table TABLE                   EMRs by scene

DIR is then a folder of `beampipe sweep`, and TABLE is its table.csv. Means are those of docs/accuracy.py.
"""
import pathlib
import sys

import accuracy
import scene_traces
from measure import HELD_OUT, make, print_head, print_row

SPECS = ["beam", "beam:bits=128,pool=30", "beam:order=stream", "casav", "z3:shape=128x3", "msaa:256"]
UNLIT = ["truck", "breakfast_room", "lattice_site", "wire_fans"]
UNLIT_SPECS = ["beam", "beam:bin=16", "beam:bits=128,pool=30", "beam:order=stream", "beam:order=stream,bits=256", "casav",
               "msaa:256"]


def print_table(table):
    """A row for each spec: its EMR on each scene, with its range where it has one."""
    def cell(row):
        found = accuracy.rate_of(row)
        ends = [accuracy.rate(float(row[end])) if row[end] else "" for end in ("emr_low", "emr_high")]
        return accuracy.rate_text(found) + (f" ({'..'.join(ends)})" if any(ends) else "")
    print_head("technique", *table.scenes, *accuracy.SUMMARIES, "RMSE ÷ that of `msaa:256`")
    for spec in dict.fromkeys(SPECS + UNLIT_SPECS):
        if (table.scenes[0], spec, table.size) not in table.rows:
            continue
        rates = table.rates(spec)
        print_row(f"`{spec}`", *(cell(table.row(scene, spec)) for scene in table.scenes),
                  *(summary(rates) for summary in accuracy.SUMMARIES.values()), f"{accuracy.rmse_ratio(table, spec):.2f}")


def main(arguments):
    match arguments:
        case ["sweep", program, "-o", folder]:
            (pathlib.Path(folder) / "scenes").mkdir(parents=True, exist_ok=True)
            for scene in HELD_OUT:
                make(program, scene, f"{folder}/scenes/{scene}.json")
            accuracy.run_sweep(program, folder, [f"scenes/{scene}.json" for scene in HELD_OUT], {"techniques": SPECS})
        case ["unlit", program, models, "-o", folder]:
            (pathlib.Path(folder) / "scenes").mkdir(parents=True, exist_ok=True)
            for scene in UNLIT:
                scene_traces.make_model(program, pathlib.Path(models), scene, f"{folder}/scenes/{scene}.json",
                                        "--width", "320", "--height", "180", "--unlit")
            accuracy.run_sweep(program, folder, [f"scenes/{scene}.json" for scene in UNLIT], {"techniques": UNLIT_SPECS})
        case ["table", table]:
            print_table(accuracy.Table(table))
        case _:
            sys.exit(__doc__.strip())


if __name__ == "__main__":
    main(sys.argv[1:])
