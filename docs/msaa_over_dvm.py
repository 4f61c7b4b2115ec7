#!/usr/bin/env python3
"""Modelled time of msaa:8 over that of DVM by what shading costs, beside the DVM article's, for docs/techniques.md.

usage: docs/msaa_over_dvm.py PROGRAM DIR...

DIR are the folders that the commands of `beampipe claims` for the densities low, medium and high make.
"""
import json
import subprocess
import sys

from measure import print_head, print_row

COSTS = [(0, 0), (1000, 650), (3000, 2000)]  # operations for material and light
DENSITIES = ["low", "medium", "high"]


def ratios(claims, key):
    """Of all passes, then of forward shading over what replaces it in DVM."""
    numbers = {claim["name"]: claim[key] for claim in claims}
    for density in DENSITIES:
        yield numbers[f"{density} density, Msaa 8x, all passes over DVM's"]
    for density in DENSITIES:
        dvm = f"{density} density, DVM, "
        yield numbers[f"{density} density, Msaa 8x, Material"] / (numbers[dvm + "Material"] + numbers[dvm + "Lighting"])


def main(program, *folders):
    print_head("operations for material and light", *[f"all passes, {density}" for density in DENSITIES],
               *[f"shading, {density}" for density in DENSITIES])
    for material, light in COSTS:
        command = [program, "claims", *folders, "--json", "--material-cost", str(material), "--light-cost", str(light)]
        claims = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)
        print_row(f"{material} and {light}", *[f"{ratio:.2f}" for ratio in ratios(claims, "ours")])
    print_row("article", *[f"{ratio:.2f}" for ratio in ratios(claims, "published_low")])


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__.strip())
    main(*sys.argv[1:])
