#!/usr/bin/env python3
"""Makes the table of docs/accuracy.md that compares techniques with exact arithmetic.

usage: docs/stress_tables.py STRESS_JSON

STRESS_JSON comes from `beampipe stress -o FOLDER`. Prints a row for each technique below: in how many cases it is exact
up to the rounding of its format, in how many its error is at most 2^-6, in how many it is larger, and the largest three
of these. An exclamation mark would be an error above the stated limit.
"""
import json
import math
import sys

FP16_ERROR = 2 ** -11  # of colours up to 1, rounded twice
SMALL = 2 ** -6  # four of 256 positions
SHOWN = ["beam", "beam:order=stream", "beam:order=sorted", "z3", "casav", "alpha", "msaa:8", "acaa:8",
         "acaa:8,double=stencil", "dvm", "reference"]


def text(result):
    error = math.nan if result["error"] is None else result["error"]
    value = "not finite" if math.isnan(error) else f"2^{math.log2(error):.1f}"
    return f"{result['case']} {value}" + ("" if result["passes"] else "!")


def main(file):
    with open(file, encoding="utf-8") as stream:
        results = json.load(stream)
    by_technique = {}
    for result in results:
        by_technique.setdefault(result["technique"], []).append(result)
    print("| technique | exact | up to 2^-6 | above | the largest |\n|---|---|---|---|---|")
    for technique in SHOWN:
        cases = by_technique[technique]
        error = {case["case"]: math.inf if case["error"] is None else case["error"] for case in cases}
        exact = [case for case in cases if error[case["case"]] <= (FP16_ERROR if case["reason"] else case["limit"])]
        large = sorted((case for case in cases if case not in exact and error[case["case"]] > SMALL),
                       key=lambda case: -error[case["case"]])
        small = len(cases) - len(exact) - len(large)
        print(f"| `{technique}` | {len(exact)} | {small} | {len(large)} | {', '.join(map(text, large[:3]))} |")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
