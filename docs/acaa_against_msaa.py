#!/usr/bin/env python3
"""Compares ACAA with MSAA, for docs/techniques.md.

usage: docs/acaa_against_msaa.py pictures|saved|tiles PROGRAM TRACE...

PROGRAM is for instance beampipe. `pictures` prints, trace by trace, the RMSE between the picture of each ACAA and that
of msaa:8, and which part of the DRAM bytes that seven more samples cost MSAA are saved by ACAA. `saved` prints,
for pictures of several widths, which part of the DRAM bytes of MSAA is geometry, and what ACAA saves. `tiles` prints
what a GPU with tile memory moves, with tiles that fit.
"""
import json
import pathlib
import sys
import tempfile

import measure

PICTURES = ["acaa:8", "acaa:8,double=stencil", "acaa:8,double=saturate", "acaa:8,color=unorm8"]
ONE, EIGHT, ACAA = "msaa:1,prepass", "msaa:8,prepass", "acaa:8"
SAME_FORMAT = "msaa:8,color=rgba16f,prepass"  # as the accumulator's, and as in the talk
GEOMETRY = {"vertex_setup", "sample_raster", "shade"}
WIDTHS = [320, 1280, 1920, 3840]
MALI = pathlib.Path(__file__).resolve().parent.parent / "tools/evaluate/hardware/mali_g710.json"
TILES = [("msaa:8", 8), ("msaa:8,prepass", 8), ("acaa:8", 8), ("acaa:8", 16)]  # two tiles of msaa:8 do not fit at 16


def dram_bytes(result, stages=None):
    return sum(stage["dram_bytes"] for name, stage in measure.stages(result).items()
               if stages is None or name.removeprefix("prepass_") in stages)


def times(result):
    """Of the frame. The implementations differ in stages that these techniques do not have."""
    return result["frames"][0]["modelled_ms"]["shaders"]


def name(trace):
    return pathlib.Path(trace).stem


def pictures(program, traces, folder):
    measure.print_head("scene", *[f"`{spec}`" for spec in PICTURES], "DRAM bytes saved")
    for trace in traces:
        results = measure.results(program, "run", trace, [ONE, EIGHT, *PICTURES], folder)
        picture = {spec: f"{folder}/{result['frames'][0]['image']}" for spec, result in results.items()}
        differences = [measure.difference(program, picture[spec], picture[EIGHT])["rmse"] for spec in PICTURES]
        one, eight, acaa = (dram_bytes(results[spec]) for spec in (ONE, EIGHT, ACAA))
        measure.print_row(name(trace), *[f"{difference:.5f}" for difference in differences],
                          f"{100 * (eight - acaa) / (eight - one):.0f} %")


def saved(program, traces, folder):
    measure.print_head("scene", "width", "geometry, of DRAM bytes", "saved: DRAM bytes", "ms, all stages at once",
                       "ms, one stage after the other")
    for trace in traces:
        for width in WIDTHS:
            results = measure.results(program, "run", trace, [SAME_FORMAT, ACAA], folder, "--width", str(width))
            msaa, acaa = results[SAME_FORMAT], results[ACAA]
            shares = [dram_bytes(msaa, GEOMETRY) / dram_bytes(msaa), 1 - dram_bytes(acaa) / dram_bytes(msaa),
                      *(1 - times(acaa)[how] / times(msaa)[how] for how in ("at_once", "in_turn"))]
            measure.print_row(name(trace), width, *(f"{100 * share:.0f} %" for share in shares))


def tiles(program, traces, folder):
    measure.print_head("scene", "technique", "tile", "KiB", "bin pairs", "DRAM MB", "ms")
    for trace in traces:
        for spec, side in TILES:
            part = json.loads(MALI.read_text())
            part["memory_system"]["parameters"]["bin_pixels"] = side
            part["memory_system"]["sources"]["bin_pixels"] = "choice"
            file = pathlib.Path(folder) / "part.json"
            file.write_text(json.dumps(part))
            result = measure.results(program, "run", trace, [spec], folder, "--hardware", file)[spec]
            frame = result["frames"][0]
            pairs = sum(buffer["peak_bytes"] for buffer in frame["buffers"] if buffer["name"] == "bin_lists") // 4
            kib = sum(buffer["peak_bytes"] for buffer in frame["buffers"] if buffer["name"] == "open_pixels") / 1024
            measure.print_row(name(trace), f"`{spec}`", f"{side} x {side}", f"{kib:g}", pairs,
                              f"{dram_bytes(result) / 1e6:.1f}", f"{times(result)['in_turn']:.3f}")


TABLES = {table.__name__: table for table in (pictures, saved, tiles)}

if __name__ == "__main__":
    if len(sys.argv) < 4 or sys.argv[1] not in TABLES:
        sys.exit(__doc__.strip())
    with tempfile.TemporaryDirectory() as scratch:
        TABLES[sys.argv[1]](sys.argv[2], sys.argv[3:], scratch)
