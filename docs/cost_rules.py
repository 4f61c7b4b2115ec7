#!/usr/bin/env python3
"""Which rule of the model of costs changes the published ratios, and how far, for docs/costs.md.

cost_rules.py PROGRAM DIR   DIR: of `beampipe run TRACE -t casav msaa:32,128,256 -o DIR`

A rule is off when its rate has no limit. Prints the ratios with all rules off, then with one after the other on.
"""
import copy
import json
import sys

import tornado

RULES = [
    ("64-bit integers", ["wide_per_clk"]),
    ("pixels by bytes of their formats, in ROPs", ["rop_bytes_per_clk"]),
    ("bytes of pixels on chip, in shaders too", ["on_chip_bytes_per_clk"]),
    ("masks by positions and edges", ["mask_positions_per_clk"]),
    ("sorting by comparisons", ["sort_operations_per_clk"]),
    ("composition by contested positions", ["compose_positions_per_clk"]),
    ("room for bins on chip", ["on_chip_bytes_per_core"]),
]


def main(program, folder):
    description = json.loads(tornado.DESCRIPTION.read_text())
    variant = copy.deepcopy(description)
    for _, rates in RULES:
        for rate in rates:
            variant["rates"][rate] = 1e12
    names, variants = ["counts with early-outs, none of the rules below"], [copy.deepcopy(variant)]
    for name, rates in RULES:
        for rate in rates:
            variant["rates"][rate] = description["rates"][rate]
        names.append(name)
        variants.append(copy.deepcopy(variant))
    found = tornado.ratios(program, folder, variants)
    columns = [(i, t) for i in dict.fromkeys(i for i, _ in found[0]) for t in tornado.PUBLISHED]
    print("| rules | " + " | ".join(f"{i}, `{t}`" for i, t in columns) + " |\n" + "|---" * (1 + len(columns)) + "|")
    for k, (name, of) in enumerate(zip(names, found)):
        print(f"| {'and ' if k else ''}{name} | " + " | ".join(f"{of[c]:.2f}" for c in columns) + " |")
    print("| the paper | " + " | ".join(f"{tornado.PUBLISHED[t]:.2f}" for _, t in columns) + " |")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
