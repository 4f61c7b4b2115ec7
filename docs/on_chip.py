#!/usr/bin/env python3
"""Prints the table of docs/costs.md about what a bin has on chip.

usage: docs/on_chip.py PROGRAM TRACE

KiB of each buffer of a bin, at its peak in the bin of the trace's first frame that needs the most, for bins of 8, 16
and 32 pixels on each side. MSAA keeps its samples on chip, as in tile-based rendering. Its bins have one size in the
program, so for the others its buffers are taken in proportion to the pixels.
"""
import sys
import tempfile

from measure import print_head, print_row, results

SIDES = [8, 16, 32]
BEAM = ["beam", "beam:bits=128,pool=30", "beam:bits=64,pool=24"]
MSAA = ["msaa:8"]
PARTS = {"words": ["pixel_words"], "records": ["record_pool"], "samples": ["depth", "color"]}


def with_bin(spec, side):
    return f"{spec}{',' if ':' in spec else ':'}bin={side}"


def parts_of(surfaces, pixels):
    """The bytes of a bin's pixels by part of their state."""
    bytes_of = {surface["name"]: surface["bytes_per_pixel"] for surface in surfaces}
    return [sum(bytes_of.get(name, 0) for name in names) * pixels for names in PARTS.values()]


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__.strip())
    program, trace = sys.argv[1:]
    specs = [with_bin(spec, side) for spec in BEAM for side in SIDES] + MSAA
    with tempfile.TemporaryDirectory() as folder:
        options = ["--frames", "0", "--no-memory-model", "--on-chip-memory", "1GB", "--framebuffer"]
        on_chip = results(program, "run", trace, specs, f"{folder}/on_chip", *options, "on-chip")
        in_memory = results(program, "run", trace, specs, f"{folder}/in_memory", *options, "in-memory")
    print_head("technique", "bin", *PARTS, "closed depths", "queues", "KiB", "bytes/pixel")
    for spec in BEAM + MSAA:
        for side in SIDES:
            name = with_bin(spec, side) if spec in BEAM else spec
            frame = on_chip[name]["frames"][0]
            held = {buffer["name"]: buffer["peak_bytes"] for buffer in frame["buffers"] if buffer["held"] == "bin"}
            pixels = side * side
            queues = sum(bytes for buffer, bytes in held.items() if buffer.endswith("_queue"))
            columns = [*parts_of(in_memory[name]["framebuffer"], pixels),
                       held["closed_depth"] * pixels / frame["bin_pixels"], queues]
            cells = [f"{column / 1024:.1f}" if column > 0 else "" for column in columns]
            print_row(f"`{spec}`", side, *cells, f"{sum(columns) / 1024:.1f}", f"{sum(columns) / pixels:.0f}")


main()
