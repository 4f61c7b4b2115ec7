#!/usr/bin/env python3
"""Makes the table of modelled energy of docs/costs.md from finished runs.

usage: docs/energy.py PROGRAM DIR...

`beampipe run TRACE -t SPEC... --hardware PART -o DIR` wrote each folder, with the same techniques. Prints millijoules per
frame, the least and the most, by technique, part and implementation.
"""
import json
import subprocess
import sys

from measure import print_head, print_row


def main(program, *folders):
    text = subprocess.run([program, "model", *folders, "--energy", "--json"], check=True, capture_output=True,
                          text=True).stdout
    rows = {}
    for report in json.loads(text):
        for row in report["energy"]:
            low, high = row["energy_mj"]["total"]
            rows.setdefault(row["technique"], {})[f"`{row['hardware']}.{row['implementation']}`"] = f"{low:.2g} to {high:.2g}"
    print_head("technique", *next(iter(rows.values())))
    for technique, cells in rows.items():
        print_row(f"`{technique}`", *cells.values())


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
