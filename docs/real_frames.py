#!/usr/bin/env python3
"""Makes the tables of docs/real_frames.md about frames of real programs.

real_frames.py BEAMPIPE FOLDER TRACE...   the first frame of each trace that `beampipe capture` has made: what it has,
                                          and what techniques make of it; results stay in FOLDER,
                                          where a second call finds what is finished
real_frames.py BEAMPIPE --run FOLDER TRACE...   the same without errors, which take most of the time
real_frames.py BEAMPIPE --check TRACE...  all frames: their depths compared with the program's own
"""
import json
import pathlib
import subprocess
import sys

from measure import print_head, print_row, results, stages

SPECS = ["beam", "msaa:4", "msaa:8", "acaa:8", "dvm"]


def rate_of(result):
    return ("≥ " if result["equivalent_msaa_is_lower_bound"] else "") + f"{result['equivalent_msaa']:.{0 if result['equivalent_msaa'] >= 10 else 1}f}"


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
        errors = ["", "", ""]
        if "error" in found[spec]:
            errors = [f"{1000 * found[spec]['error']['rmse']:.3f}", rate_of(found[spec]),
                      rate_of(found[spec]["visibility"]) if "visibility" in found[spec] else ""]
        print_row(name, f"`{spec}`", *errors,
                  f"{frame['dram_bytes'] / 1e6:.2f}", f"{on_chip[spec]['frames'][0]['dram_bytes'] / 1e6:.2f}",
                  f"{times['shaders']['overlap']:.4f}", f"{times['fixed_function']['overlap']:.4f}")


def measure_all(program, command, folder, traces):
    measured = {}
    for path in traces:
        name = pathlib.Path(path).stem
        found = results(program, command, path, SPECS, f"{folder}/{name}", "--frames", "0", "--resume")
        on_chip = results(program, "run", path, SPECS, f"{folder}/{name}_on_chip", "--frames", "0", "--resume",
                          "--framebuffer", "on-chip")
        measured[name] = path, found, on_chip
    print_head("frame", "size", "draws", "triangles", "rasterized", "per pixel", "pairs per pixel",
               "fragments per pixel", "not drawn, or not exactly")
    for name, (path, found, _) in measured.items():
        frame_row(program, name, path, found)
    print()
    print_head("frame", "technique", "RMSE × 1000", "EMR", "EMR of visibility", "DRAM MB", "DRAM MB, all on chip",
               "ms, shaders", "ms, fixed function")
    for name, (_, found, on_chip) in measured.items():
        technique_rows(name, found, on_chip)


def check_all(program, traces):
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


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    if sys.argv[2] == "--check":
        check_all(sys.argv[1], sys.argv[3:])
    elif sys.argv[2] == "--run":
        measure_all(sys.argv[1], "run", sys.argv[3], sys.argv[4:])
    else:
        measure_all(sys.argv[1], "compare", sys.argv[2], sys.argv[3:])
