#!/usr/bin/env python3
"""Makes the tables of docs/real_frames.md about frames of real programs.

usage: docs/real_frames.py frames PROGRAM FOLDER TRACE...    what the first frame of each trace has
       docs/real_frames.py errors PROGRAM FOLDER TRACE...    what techniques make of it
       docs/real_frames.py depths PROGRAM TRACE...           depths of all frames, beside those of the captured program

PROGRAM is for instance beampipe, and `beampipe capture` made the traces. The results of `compare` stay in FOLDER, where
another call finds what is finished.
"""
import json
import pathlib
import subprocess
import sys

from measure import print_head, print_row, results, stages

SPECS = ["beam", "msaa:4", "msaa:8", "acaa:8", "dvm"]


def rate_of(result):
    rate = result["equivalent_msaa"]
    return ("≥ " if result["equivalent_msaa_is_lower_bound"] else "") + f"{rate:.{0 if rate >= 10 else 1}f}"


def notes_of(program, trace):
    """What the program notes about the frame's draws, as text."""
    answer = subprocess.run([program, "info", trace], check=True, capture_output=True, text=True)
    notes = [line.split("note: ", 1)[1] for line in answer.stderr.splitlines() if "note: " in line]
    return "; ".join(notes)


def frame_row(program, name, path, found):
    trace = json.loads(pathlib.Path(path).read_text())
    frame = trace["frames"][0]
    triangles = sum(trace["meshes"][draw["mesh"]]["indices"]["count"] // 3 for draw in frame["draws"])
    pixels = frame["width"] * frame["height"]
    beam = stages(found["beam"])
    drawn, pairs = beam["vertex_setup"]["items_out"], beam["conservative_raster"]["items_out"]
    fragments = beam["compose"]["items_in"]
    print_row(name, f"{frame['width']} × {frame['height']}", len(frame["draws"]), f"{triangles:,}", f"{drawn:,}",
              f"{drawn / pixels:.2g}", f"{pairs / pixels:.2f}", f"{fragments / pixels:.2f}",
              notes_of(program, path))


def technique_rows(name, found, on_chip):
    for spec in SPECS:
        frame, times = found[spec]["frames"][0], found[spec]["frames"][0]["modelled_ms"]
        errors = [f"{1000 * found[spec]['error']['rmse']:.3f}", rate_of(found[spec]),
                  rate_of(found[spec]["visibility"]) if "visibility" in found[spec] else ""]
        print_row(name, f"`{spec}`", *errors,
                  f"{frame['dram_bytes'] / 1e6:.2f}", f"{on_chip[spec]['frames'][0]['dram_bytes'] / 1e6:.2f}",
                  f"{times['shaders']['overlap']:.4f}", f"{times['fixed_function']['overlap']:.4f}")


def measure_all(program, folder, traces):
    """By name: the trace, its results, and those with all pixels on chip."""
    measured = {}
    for path in traces:
        name = pathlib.Path(path).stem
        found = results(program, "compare", path, SPECS, f"{folder}/{name}", "--frames", "0", "--resume")
        on_chip = results(program, "run", path, SPECS, f"{folder}/{name}_on_chip", "--frames", "0", "--resume",
                          "--framebuffer", "on-chip")
        measured[name] = path, found, on_chip
    return measured


def print_frames(program, measured):
    print_head("frame", "size", "draws", "triangles", "rasterized", "per pixel", "pairs per pixel",
               "fragments per pixel", "not drawn, or not exactly")
    for name, (path, found, _) in measured.items():
        frame_row(program, name, path, found)


def print_errors(measured):
    print_head("frame", "technique", "RMSE × 1000", "EMR", "EMR of visibility", "DRAM MB", "DRAM MB, all on chip",
               "ms, shaders", "ms, fixed function")
    for name, (_, found, on_chip) in measured.items():
        technique_rows(name, found, on_chip)


def print_depths(program, traces):
    print_head("trace", "frame", "covered pixels", "in both", "depth within 10⁻⁶", "within 10⁻⁴",
               "largest difference", "draws that differ: pixels")
    for path in traces:
        answer = subprocess.run([program, "check-capture", path, "--json"], check=True, stdout=subprocess.PIPE,
                                stderr=subprocess.DEVNULL)
        for frame in json.loads(answer.stdout)["frames"]:
            covered = frame["covered_here"] + frame["covered_in_program"] - frame["covered_in_both"]
            differing = ", ".join(f"{'none' if draw['draw'] is None else draw['draw']}: {draw['differing_pixels']}"
                                  for draw in frame["draws"][:5])
            print_row(pathlib.Path(path).stem, frame["index"], f"{covered:,}", f"{100 * frame['coverage']:.3f} %",
                      f"{100 * frame['depths_within_1e-6']:.2f} %", f"{100 * frame['depths_within_1e-4']:.3f} %",
                      f"{frame['largest_difference']:.1e}", differing)


def main(arguments):
    match arguments:
        case ["frames", program, folder, *traces] if traces:
            print_frames(program, measure_all(program, folder, traces))
        case ["errors", program, folder, *traces] if traces:
            print_errors(measure_all(program, folder, traces))
        case ["depths", program, *traces] if traces:
            print_depths(program, traces)
        case _:
            sys.exit(__doc__.strip())


main(sys.argv[1:])
