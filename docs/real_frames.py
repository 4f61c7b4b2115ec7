#!/usr/bin/env python3
"""Makes the table of docs/accuracy.md about frames of real programs.

usage: docs/real_frames.py PROGRAM FOLDER TRACE...

PROGRAM is for instance beampipe, and `beampipe capture` made the traces. The results of `compare` and `run` stay in
FOLDER, where another call finds what is finished. The first frame of each trace is measured.
"""
import pathlib
import sys

from measure import print_head, print_row, results, stages

SPECS = ["beam", "msaa:8"]


def rate_of(result):
    rate = result["equivalent_msaa"]
    return ("≥ " if result["equivalent_msaa_is_lower_bound"] else "") + f"{rate:.{0 if rate >= 10 else 1}f}"


def megabytes(result):
    return f"{result['frames'][0]['dram_bytes'] / 1e6:.2f}"


def print_frame(name, found, on_chip):
    beam, msaa = (found[spec] for spec in SPECS)
    frame = beam["frames"][0]
    times, times_of_msaa = frame["modelled_ms"], msaa["frames"][0]["modelled_ms"]
    triangles = stages(beam)["vertex_setup"]["items_out"] / (frame["width"] * frame["height"])
    print_row(name, f"{triangles:.2g}", rate_of(beam.get("visibility", beam)),  # flat frames have no other error
              *(f"{1000 * result['error']['rmse']:.3f}" for result in (beam, msaa)),
              megabytes(beam), megabytes(msaa), megabytes(on_chip["msaa:8"]),
              *(f"{ms['overlap']:.4f}" for ms in (times["fixed_function"], times["shaders"], times_of_msaa["shaders"])))


def main(program, folder, traces):
    print_head("frame", "triangles per pixel", "EMR of visibility, `beam`", "RMSE × 1000: `beam`", "`msaa:8`",
               "DRAM MB: `beam`", "`msaa:8`", "`msaa:8` on chip", "ms: `beam` fixed", "`beam` shaders", "`msaa:8`")
    for path in traces:
        name = pathlib.Path(path).stem
        found = results(program, "compare", path, SPECS, f"{folder}/{name}", "--frames", "0", "--resume")
        on_chip = results(program, "run", path, ["msaa:8"], f"{folder}/{name}_on_chip", "--frames", "0", "--resume",
                          "--framebuffer", "on-chip")
        print_frame(name, found, on_chip)


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__.strip())
    main(sys.argv[1], sys.argv[2], sys.argv[3:])
