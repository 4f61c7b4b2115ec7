#!/usr/bin/env python3
"""Prints what frames captured from programs are made of, and how well they are drawn, for docs/accuracy.md.

usage: docs/captured_frames.py PROGRAM FOLDER

PROGRAM is for instance beampipe. FOLDER has traces that docs/capture_frames.sh made. Pixels count as equal where all
channels are within 2/255 of the program's picture, with the program's own number of samples. The worst draw is the one
that is in front where most other pixels are. Operations are those that an invocation of the fragment shaders executes,
the mean over all.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import measure


def answer(program, command, trace):
    """What a command prints as JSON; exits if it fails, which says why."""
    finished = subprocess.run([program, command, str(trace), "--json"], capture_output=True, text=True)
    if finished.returncode:
        sys.exit(finished.stderr.strip() or f"{command} {trace}: exit code {finished.returncode}")
    return json.loads(finished.stdout)


def worst(draws):
    if not draws:
        return ""
    most = max(draws, key=lambda draw: draw["differing_pixels"])
    name = "behind all" if most["draw"] is None else f"number {most['draw']}"
    return f"{name}: {most['differing_pixels']}, by up to {most['largest_difference']:.0f}"


def operations_of(stages):
    """Of an invocation. Shaders that discard run in the alpha test, and their colours need no second run."""
    none = {"ops": {"total": 0}, "items_in": 0, "items_out": 0}
    shade, test = stages.get("shade", none), stages.get("alpha_test", none)
    invocations = test["items_in"] + max(0, shade["items_in"] - test["items_out"])
    return (shade["ops"]["total"] + test["ops"]["total"]) / max(1, invocations)


def notes_of(checked, frame):
    """What is not drawn as the program draws it, and what the capture left out."""
    notes = [f"{note['draws']} draws {'left out' if note['left_out'] else 'in the nearest way'}: {note['reason']}"
             for note in checked.get("notes", [])]
    notes += [f"{one['draws']} draws left out: {one['reason']}" for one in frame.get("left_out", [])
              if one["reason"] != "two corners of the triangle are one point"]
    others = sum(not one["kept"] for one in frame.get("passes", []))
    if others:
        notes.append(f"{others} other pass{'es' if others > 1 else ''}")
    return "; ".join(notes)


def main(program, traces, folder):
    measure.print_head("frame", "samples", "pixels within 2/255, %", "worst draw: other pixels", "draws", "triangles",
                       "triangles per pixel", "operations per invocation", "notes")
    for path in traces:
        trace = json.loads(path.read_text(encoding="utf-8"))
        checked = answer(program, "check-capture", path)
        for number, (frame, found) in enumerate(zip(trace["frames"], checked["frames"])):
            samples = frame["captured"].get("samples", 1)
            technique = f"msaa:{samples}"
            result = measure.results(program, "run", str(path), [technique], folder, "--no-memory-model")[technique]
            operations = operations_of(measure.stages(result, number))
            triangles = sum(trace["meshes"][draw["mesh"]]["indices"]["count"] // 3 for draw in frame["draws"])
            colors = found.get("colors")
            measure.print_row(
                path.stem if len(trace["frames"]) == 1 else f"{path.stem} {number}", samples,
                f"{100 * colors['within_2_codes']:.3f}" if colors else "", worst(colors["draws"]) if colors else "",
                len(frame["draws"]), triangles, f"{triangles / (frame['width'] * frame['height']):.3g}",
                f"{operations:.0f}",
                notes_of(checked, frame))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__.strip())
    with tempfile.TemporaryDirectory() as temporary:
        main(sys.argv[1], sorted(pathlib.Path(sys.argv[2]).glob("*.json")), temporary)
