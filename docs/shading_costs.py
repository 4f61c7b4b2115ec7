#!/usr/bin/env python3
"""At which cost of shading does each published ratio of ACAA and DVM come out?  For docs/costs.md.

shading_costs.py PROGRAM DIR...   the folders that the commands of `beampipe claims` for ACAA and DVM write

Each invocation of a fragment shader costs X operations for its material and X / 2 for light, beside what it counts: the
article on DVM gives about twice as much time to materials as to lighting. Nothing is rendered again.
"""
import math
import re
import subprocess
import sys

STEPS = [0] + [round(10 * 10**(i / 6)) for i in range(25)]  # 10 to 100,000 operations


def claims(program, folders, operations):
    """Published and modelled numbers by name, of the rows that have both."""
    text = subprocess.run(
        [program, "claims", *folders, "--material-cost", str(operations), "--light-cost", str(operations / 2)],
        check=True, capture_output=True, text=True).stdout
    found = {}
    for line in text.split("\n## ")[0].splitlines():  # what was rendered; formats and constants follow
        if not line.startswith("|"):
            continue
        name, _, published, ours = [cell.strip() for cell in line.strip("|").split("|")][:4]
        if re.fullmatch(r"[-+.e\d]+", ours) and re.search(r"\d", ours):
            found[name] = ([float(part) for part in published.replace(" or more", "").split(" to ")], float(ours))
    return found


def ratios(found):
    """Yields name, the published range, and ours."""
    for name in ("ACAA, part of what MSAA adds to 1x in frame time that is saved",
                 "ACAA, part of MSAA's frame time that is saved"):
        if name in found:
            published, ours = found[name]
            yield name, published[0], published[-1], ours
    for density in ("low", "medium", "high"):
        totals = {}
        for name, (published, ours) in found.items():
            match = re.fullmatch(rf"{density} density, ([^,]+), (PrePass|Material|Lighting|VisUtil|Motion|Resolve/TAA)",
                                 name)
            if match:
                total = totals.setdefault(match[1], [0, 0])
                total[0] += published[0]
                total[1] += ours
        for technique, total in totals.items():
            if technique != "DVM" and "DVM" in totals:
                published = total[0] / totals["DVM"][0]
                yield f"{density} density, {technique} / DVM", published, published, total[1] / totals["DVM"][1]


def crossing(costs, ours, low, high):
    """The least cost at which the ratio is in the range, between two steps in proportion; None if it never is."""
    for i, value in enumerate(ours):
        if low <= value <= high:
            return costs[i]
        if i and (ours[i - 1] < low) != (value < low) or i and (ours[i - 1] > high) != (value > high):
            target = low if (ours[i - 1] < low) != (value < low) else high
            part = (target - ours[i - 1]) / (value - ours[i - 1])
            return costs[i - 1] + part * (costs[i] - costs[i - 1])
    return None


def main(program, folders):
    rows = {}
    for operations in STEPS:
        for name, low, high, ours in ratios(claims(program, folders, operations)):
            rows.setdefault(name, (low, high, []))[2].append(ours)
    shown = [0, 100, 1000, 10000, 100000]
    print("| ratio | published | " + " | ".join(f"{x} operations" for x in shown) + " | comes out at |")
    print("|---" * (3 + len(shown)) + "|")
    for name, (low, high, ours) in rows.items():
        cost = crossing(STEPS, ours, low, high)
        nearest = min(range(len(ours)), key=lambda i: abs(math.log(max(ours[i], 1e-9) / low)))
        where = f"{cost:.0f}" if cost is not None else f"never; nearest {ours[nearest]:.2f} at {STEPS[nearest]}"
        published = f"{low:.2f}" if low == high else f"{low:.2f} to {high:.2f}"
        cells = " | ".join(f"{ours[STEPS.index(x)]:.2f}" for x in shown)
        print(f"| {name} | {published} | {cells} | {where} |")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:])
