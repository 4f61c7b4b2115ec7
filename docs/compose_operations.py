#!/usr/bin/env python3
"""Makes the table of docs/costs.md about the operations that it takes to compose a fragment, by kind.

usage: docs/compose_operations.py PROGRAM TRACE

The operations of the stage `compose` in the trace's first frame, over the fragments that enter it.
"""
import sys
import tempfile

from measure import print_head, print_row, results, stages

SPECS = ["beam", "beam:order=sorted", "beam:order=stream", "casav", "alpha", "z3"]
KINDS = ["mul_add", "add", "bit", "fetch", "special", "convert"]


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__.strip())
    program, trace = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        found = results(program, "run", trace, SPECS, f"{folder}/results", "--frames", "0", "--no-memory-model")
    print_head("technique", *KINDS, "all")
    for spec in SPECS:
        compose = stages(found[spec])["compose"]
        print_row(f"`{spec}`", *(f"{compose['ops'][kind] / compose['items_in']:.1f}" for kind in [*KINDS, "total"]))


main()
