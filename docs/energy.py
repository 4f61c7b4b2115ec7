#!/usr/bin/env python3
"""Makes the table of modelled energy of docs/costs.md from finished runs.

usage: docs/energy.py PROGRAM DIR...

`beampipe run TRACE -t SPEC... --hardware PART -o DIR` wrote each folder, with the same techniques, of which the first
two are compared. Prints millijoules per frame, the least and the most, by part and implementation.
"""
import json
import subprocess
import sys

from measure import print_head, print_row


def text_of(interval):
    return f"{interval[0]:.2g}–{interval[1]:.2g}"


def main(program, *folders):
    with open(f"{folders[0]}/report.json", encoding="utf-8") as file:
        first, second = (result["technique"] for result in json.load(file)["results"][:2])
    text = subprocess.run([program, "model", *folders, "--energy", "--over", second, "--json"], check=True,
                          stdout=subprocess.PIPE, text=True).stdout
    parts = {}
    for report in json.loads(text):
        for row in report["energy"]:
            parts.setdefault(f"`{row['hardware']}.{row['implementation']}`", []).append(row)
    rows = next(iter(parts.values()))
    print_head("part", *(f"`{row['technique']}`" for row in rows), f"`{first}` / `{second}`")
    for part, rows in parts.items():
        print_row(part, *(text_of(row["energy_mj"]["total"]) for row in rows), text_of(rows[0]["ratio_interval"]))


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
