#!/usr/bin/env python3
"""Prints what techniques make of captured frames, for docs/accuracy.md: errors, operations, bytes and modelled times.

usage: docs/captured_errors.py PROGRAM FRAMES COMPARISONS

PROGRAM is for instance beampipe. `beampipe compare FRAMES/NAME.json -t beam msaa:8 msaa:32 -o COMPARISONS/NAME` wrote
the comparisons. Operations are those of all stages but vertex setup, alpha tests and shading. Bytes are those of DRAM.
Times are modelled with the fixed functions of a Titan V; shading is charged what the programs execute.
"""
import json
import pathlib
import sys
import tempfile

import measure
from errors import emr

SPECS = ("beam", "msaa:8", "msaa:32")
NOT_COUNTED = {"vertex_setup", "shade", "alpha_test", "alpha_mask"}


def listed(numbers, form):
    return " / ".join(format(number, form) for number in numbers)


def operations(result):
    return sum(stage["ops"]["total"] for name, stage in measure.stages(result).items() if name not in NOT_COUNTED)


def main(program, frames, comparisons, folder):
    measure.print_head("frame", *(f"`{spec}`, RMSE × 1000 (visibility)" for spec in SPECS), "`beam`, EMR (visibility)",
                       "operations, `beam` ÷ `msaa:8`", "bytes per pixel of " + ", ".join(f"`{s}`" for s in SPECS),
                       "modelled ms")
    for comparison in sorted(comparisons.iterdir()):
        report = comparison / "report.json"
        trace = frames / f"{comparison.name}.json"
        if not report.exists() or not trace.exists():
            continue
        compared = {one["technique"]: one for one in json.loads(report.read_text(encoding="utf-8"))["results"]}
        run = measure.results(program, "run", str(trace), SPECS, folder)
        frame = {spec: run[spec]["frames"][0] for spec in SPECS}
        shape = json.loads((pathlib.Path(folder) / "report.json").read_text(encoding="utf-8"))["frames"][0]
        measure.print_row(
            comparison.name,
            *(f"{1000 * compared[spec]['error']['rmse']:.3f} ({1000 * compared[spec]['visibility']['rmse']:.3f})"
              for spec in SPECS),
            f"{emr(compared['beam'])} ({emr(compared['beam']['visibility'])})",
            f"{operations(run['beam']) / operations(run['msaa:8']):.2f}",
            listed((frame[spec]["dram_bytes"] / (shape["width"] * shape["height"]) for spec in SPECS), ".3g"),
            listed((frame[spec]["modelled_ms"]["fixed_function"]["in_turn"] for spec in SPECS), ".3f"))


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__.strip())
    with tempfile.TemporaryDirectory() as temporary:
        main(sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3]), temporary)
