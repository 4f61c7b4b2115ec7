#!/usr/bin/env python3
"""Which rates move the published ratios of times, and how far: a table and a tornado plot.

tornado.py PROGRAM DIR -o FILE.svg   DIR: of `beampipe run TRACE -t casav msaa:32,128,256 -o DIR`

Each rate goes to the ends of the range that the description of the hardware states for it, one at a time. The table has
the rates that move the ratios most.
"""
import json
import math
import pathlib
import subprocess
import sys

BASE = "casav"
PUBLISHED = {"msaa:32": 24.0 / 30.2, "msaa:128": 78.0 / 30.2, "msaa:256": 198.0 / 30.2}
ROWS = 5  # of the table


def ratios(program, folder):
    """By implementation and technique: its time over BASE's, and what that is with each rate at its ends."""
    text = subprocess.run([program, "model", folder, "--json", "--over", BASE, "--sensitivity"], check=True,
                          stdout=subprocess.PIPE, text=True).stdout
    base, effects = {}, {}
    for time in json.loads(text)[0]["times"]:
        if time["technique"] in PUBLISHED:
            base[time["implementation"], time["technique"]] = time["ratio"]
            effects.setdefault(time["implementation"], {})[time["technique"]] = [
                (rate, *ends) for rate, ends in time["ratio_at_ends"].items()]
    return base, effects


def moved_by(effects):
    """By rate: how far it moves the ratios of all techniques."""
    moved = {}
    for of_technique in effects.values():
        for rate, low, high in of_technique:
            moved[rate] = moved.get(rate, 0) + abs(math.log(low / high))
    return moved


def svg(effects, base, file):
    """effects: by implementation and technique, a list of (rate, ratio at its lowest, ratio at its highest)."""
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
        moved = moved_by(effects[implementation])
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
    text(left, height - 6, f"time over that of {BASE}; blue: the rate at its lowest; orange: at its highest; black: the model; red: the paper")
    out.append("</svg>")
    pathlib.Path(file).write_text("\n".join(out) + "\n")


def main(program, folder, file):
    base, effects = ratios(program, folder)
    svg(effects, base, file)
    for implementation, of_techniques in effects.items():
        print(f"\n{implementation}: ratios to `{BASE}` with a rate at its lowest / highest\n\n| rate | " +
              " | ".join(f"`{t}`: {base[implementation, t]:.2f} (paper {p:.2f})" for t, p in PUBLISHED.items()) + " |")
        print("|---" * (1 + len(PUBLISHED)) + "|")
        moved = moved_by(of_techniques)
        for rate in sorted(moved, key=lambda rate: -moved[rate])[:ROWS]:
            cells = [f"{low:.2f} / {high:.2f}" for t in PUBLISHED for name, low, high in of_techniques[t] if name == rate]
            print(f"| {rate} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    if len(sys.argv) != 5 or sys.argv[3] != "-o":
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2], sys.argv[4])
