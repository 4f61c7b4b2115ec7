#!/usr/bin/env python3
"""Which rates move the published ratios of times, and how far: a table and a tornado plot.

tornado.py PROGRAM DIR -o FILE.svg   DIR: of `beampipe run TRACE -t casav msaa:32,128,256 -o DIR`

Each number of the description titan_v is halved and doubled, one at a time, and the times of the finished run are
modelled again. The table has the rates that move the ratios most.
"""
import copy
import json
import math
import pathlib
import subprocess
import sys
import tempfile

BASE = "casav"
PUBLISHED = {"msaa:32": 24.0 / 30.2, "msaa:128": 78.0 / 30.2, "msaa:256": 198.0 / 30.2}
DESCRIPTION = pathlib.Path(__file__).resolve().parent.parent / "tools/evaluate/hardware/titan_v.json"
ROWS = 5  # of the table


def ratios(program, folder, variants):
    """Per variant of the description, by implementation and technique: time, one stage after the other, over BASE's."""
    with tempfile.TemporaryDirectory() as scratch:
        all_found = []
        for first in range(0, len(variants), 400):
            files = []
            for i, variant in enumerate(variants[first:first + 400]):
                files.append(pathlib.Path(scratch) / f"v{i}.json")
                files[-1].write_text(json.dumps(variant))
            text = subprocess.run([program, "model", folder, "--json", "--hardware", ",".join(map(str, files))],
                                  check=True, capture_output=True, text=True).stdout
            sums = {}
            for time in json.loads(text)[0]["times"]:
                variant, implementation = time["implementation"].split(".")
                sums[int(variant[1:]), implementation, time["technique"]] = time["sum"]
            for i in range(len(files)):
                found = {}
                for (variant, implementation, technique), ms in sums.items():
                    if variant == i and technique in PUBLISHED:
                        found[implementation, technique] = ms / sums[variant, implementation, BASE]
                all_found.append(found)
        return all_found


def scaled(description, factors):
    variant = copy.deepcopy(description)
    for rate, factor in factors.items():
        variant["rates"][rate] *= factor
    return variant


def svg(effects, base, file):
    """effects: by implementation and technique, a list of (rate, ratio when halved, ratio when doubled)."""
    panel, row, rows, left = 250, 17, 8, 190
    implementations = list(effects)
    width, height = left + 3 * panel + 20, 20 + len(implementations) * (rows * row + 62)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif" '
           f'font-size="11"><rect width="{width}" height="{height}" fill="white"/>']

    def text(x, y, words, anchor="start", color="#222", weight="normal"):
        out.append(f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{color}" '
                   f'font-weight="{weight}">{words}</text>')

    for k, implementation in enumerate(implementations):
        top = 20 + k * (rows * row + 62)
        moved = {}
        for technique in PUBLISHED:
            for rate, halved, doubled in effects[implementation][technique]:
                moved[rate] = moved.get(rate, 0) + abs(math.log(halved / doubled))
        order = sorted(moved, key=lambda rate: -moved[rate])[:rows]
        text(8, top + 4, implementation, weight="bold")
        for i, rate in enumerate(order):
            text(left - 6, top + 32 + i * row, rate, "end")
        for j, technique in enumerate(PUBLISHED):
            found = {rate: ends for rate, *ends in effects[implementation][technique]}
            middle, published = base[implementation, technique], PUBLISHED[technique]
            values = [middle, published] + [value for rate in order for value in found[rate]]
            low, high = math.log(min(values) / 1.05), math.log(max(values) * 1.05)
            x = lambda value: left + j * panel + 10 + (math.log(value) - low) / (high - low) * (panel - 30)
            text(left + j * panel + 10, top + 4, f"{technique}: model {middle:.2f}, paper {published:.2f}")
            for i, rate in enumerate(order):
                for value, color in zip(found[rate], ("#2f6fab", "#d98a2b")):
                    a, b = sorted((x(middle), x(value)))
                    out.append(f'<rect x="{a:.1f}" y="{top + 22 + i * row}" width="{b - a:.1f}" height="12" '
                               f'fill="{color}"/>')
            for value, color in ((middle, "#222"), (published, "#c03030")):
                out.append(f'<line x1="{x(value):.1f}" x2="{x(value):.1f}" y1="{top + 14}" '
                           f'y2="{top + 24 + rows * row}" stroke="{color}"/>')
            for value, color, other in ((middle, "#222", published), (published, "#c03030", middle)):
                text(x(value), top + 36 + rows * row, f"{value:.2f}", "end" if value < other else "start", color)
    text(left, height - 6, f"time over that of {BASE}; blue: the rate halved; orange: doubled; black: the model; red: the paper")
    out.append("</svg>")
    pathlib.Path(file).write_text("\n".join(out) + "\n")


def main(program, folder, file):
    description = json.loads(DESCRIPTION.read_text())
    rates = list(description["rates"])
    variants = [description] + [scaled(description, {rate: f}) for rate in rates for f in (0.5, 2)]
    found = ratios(program, folder, variants)
    base = found[0]
    implementations = list(dict.fromkeys(implementation for implementation, _ in base))
    effects = {i: {t: [(rate, found[1 + 2 * r][i, t], found[2 + 2 * r][i, t]) for r, rate in enumerate(rates)]
                   for t in PUBLISHED} for i in implementations}
    svg(effects, base, file)
    for implementation in implementations:
        print(f"\n{implementation}: ratios to `{BASE}` when a rate is halved / doubled\n\n| rate | " +
              " | ".join(f"`{t}`: {base[implementation, t]:.2f} (paper {p:.2f})" for t, p in PUBLISHED.items()) + " |")
        print("|---" * (1 + len(PUBLISHED)) + "|")
        moved = {rate: sum(abs(math.log(effects[implementation][t][r][1] / effects[implementation][t][r][2]))
                           for t in PUBLISHED) for r, rate in enumerate(rates)}
        for rate in sorted(moved, key=lambda rate: -moved[rate])[:ROWS]:
            r = rates.index(rate)
            cells = [f"{effects[implementation][t][r][1]:.2f} / {effects[implementation][t][r][2]:.2f}"
                     for t in PUBLISHED]
            print(f"| {rate} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    if len(sys.argv) != 5 or sys.argv[3] != "-o":
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2], sys.argv[4])
