#!/usr/bin/env python3
"""Makes the table of docs/accuracy.md about frames of real programs.

usage: docs/real_frames.py PROGRAM FOLDER TRACE...

PROGRAM is for instance beampipe, and `beampipe capture` made the traces. The results of `compare` stay in FOLDER, where
another call finds what is finished. The first frame of each trace is measured.
"""
import json
import pathlib
import sys

from measure import print_head, print_row, results, stages

SPECS = ["beam", "msaa:8"]


def rate_of(result):
    rate = result["equivalent_msaa"]
    return ("≥ " if result["equivalent_msaa_is_lower_bound"] else "") + f"{rate:.{0 if rate >= 10 else 1}f}"


def main(program, folder, traces):
    print_head("frame", "triangles per pixel", "EMR of visibility, `beam`", "RMSE × 1000: `beam`", "`msaa:8`")
    for path in map(pathlib.Path, traces):
        frame = json.loads(path.read_text(encoding="utf-8"))["frames"][0]
        found = results(program, "compare", path, SPECS, f"{folder}/{path.stem}", "--frames", "0", "--resume")
        beam = found["beam"]
        triangles = stages(beam)["vertex_setup"]["items_out"] / (frame["width"] * frame["height"])
        print_row(path.stem, f"{triangles:.2g}", rate_of(beam.get("visibility", beam)),  # flat frames have no other error
                  *(f"{1000 * found[spec]['error']['rmse']:.3f}" for spec in SPECS))


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__.strip())
    main(sys.argv[1], sys.argv[2], sys.argv[3:])
