#!/usr/bin/env python3
"""How many materials the quads of a frame have, for docs/techniques.md.

usage: docs/dvm_materials.py PROGRAM SCENE...   (PROGRAM is for instance beampipe)

Frames of 321 x 181 pixels, so that some quads lie partly outside.
"""
import sys
import tempfile

import measure

COUNTERS = [*(f"quads_of_{n}" for n in range(1, 5)), "quads_of_5_or_more", "partial_quads", "unknown"]

if len(sys.argv) < 3:
    sys.exit(__doc__.strip())
program = sys.argv[1]
measure.print_head("scene", "1 material", "2", "3", "4", "5 or more", "partial quads", "`unknown`")
for scene in sys.argv[2:]:
    with tempfile.TemporaryDirectory() as folder:
        trace = measure.make(program, scene, f"{folder}/trace.json", "--width", "321", "--height", "181")
        counters = measure.results(program, "run", trace, ["dvm"], f"{folder}/out")["dvm"]["frames"][0]["pixel_counters"]
        measure.print_row(scene, *(f"{100 * counters[name]['mean']:.1f} %" for name in COUNTERS))
