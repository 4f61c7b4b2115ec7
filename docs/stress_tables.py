#!/usr/bin/env python3
"""Makes the tables of docs/stability.md that compare techniques with exact arithmetic.

usage: docs/stress_tables.py STRESS_JSON SPEC...

STRESS_JSON comes from `beampipe stress -o FOLDER`. Prints a row for each case in which one of the techniques has an error
above the rounding of its format, and then how many cases have no row. A star marks such an error, an exclamation mark one
above the stated limit.
"""
import json
import math
import sys

FP16_ERROR = 2 ** -11  # of colours up to 1, rounded twice


def cell(result):
    error = result["error"]
    if error is None:
        return "nan!"
    text = f"2^{math.log2(error):.1f}" if error > 0 else "exact"
    rounding = FP16_ERROR if result["reason"] else result["limit"]
    return text + ("!" if not result["passes"] else "*" if error > rounding else "")


def main(file, *specs):
    with open(file, encoding="utf-8") as stream:
        results = json.load(stream)
    cases = {}
    for result in results:
        cases.setdefault(result["case"], {})[result["technique"]] = result
    rows = {case: [cell(of_case[spec]) for spec in specs] for case, of_case in cases.items()}
    starred = {case: cells for case, cells in rows.items() if any(text[-1] in "*!" for text in cells)}
    print("| case |" + "".join(f" `{spec}` |" for spec in specs))
    print("|---" * (len(specs) + 1) + "|")
    for case, cells in starred.items():
        print(f"| {case} |" + "".join(f" {text} |" for text in cells))
    print(f"\nThe other {len(rows) - len(starred)} of {len(rows)} cases are exact up to the rounding of the formats.")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
