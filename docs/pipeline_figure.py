#!/usr/bin/env python3
"""Draws the figure of the pipeline: docs/pipeline_figure.py BEAMPIPE docs/pictures/pipeline.svg"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

from measure import make

WIDTH, HEIGHT = 828, 760
MONO = "DejaVu Sans Mono, Menlo, Consolas, monospace"

# Groups of stages, with the colours of their boxes: fill, border.
COLORS = {
    "geometry": ("#e8e3f4", "#6f5aa8"),
    "raster": ("#dcebf9", "#2f6fab"),
    "fragments": ("#fde8cd", "#b8690f"),
    "visibility": ("#dff1de", "#3b823a"),
    "shading": ("#f9f3c9", "#94800f"),
    "picture": ("#f9dde5", "#a83a5c"),
    "reference": ("#ececec", "#666666"),
}

# The stages of `beam`: what each hands on, what it uses off chip, and whether it reads that, writes it, or both.
BEAM = [
    ("bin_sort", "sorted list", "bin list", "both"),
    ("conservative_raster", "pairs", "setup triangles", "read"),
    ("beam_fragment", "fragments", "", ""),
    ("compose", "retired surfaces", "depth planes|of surfaces", "read"),
    ("shade", "colours", "attributes", "read"),
    ("resolve", "", "picture", "write"),
]


def groups(program):
    """The group of each stage."""
    printed = subprocess.run([program, "counters", "--json"], check=True, stdout=subprocess.PIPE).stdout
    return {stage["stage"]: stage["group"] for stage in json.loads(printed)["stages"]}


def other_techniques(program):
    """The techniques of docs/techniques.md but `beam`, with their stages in order, as the program counts them."""
    page = (pathlib.Path(__file__).parent / "techniques.md").read_text(encoding="utf-8")
    titles = re.findall(r"^\| `([^`]*)` \|", page[page.index("begin -->"):].split("\n\n")[0], re.MULTILINE)
    specs = [title.replace(":N", ":8") for title in titles]
    with tempfile.TemporaryDirectory() as folder:
        trace = pathlib.Path(folder) / "stack.json"
        make(program, "stack", trace, "--width", "32", "--height", "32")
        subprocess.run([program, "run", trace, "-o", folder + "/out", "-t", *specs], check=True, stdout=subprocess.DEVNULL)
        report = json.loads((pathlib.Path(folder) / "out/report.json").read_text())
    rows = {}  # titles by stages
    for title, result in zip(titles, report["results"]):
        stages = [stage["stage"] for stage in result["frames"][0]["stages"]]
        drawn = tuple(stage for stage in stages if stage != "vertex_setup" and not stage.startswith("prepass_"))
        rows.setdefault(drawn, []).append(title)
    return [(", ".join(names), stages) for stages, names in rows.items() if names[0] != "beam"]


parts = []


def text(x, y, string, size=11, anchor="middle", family=None, weight=None, fill="#222"):
    extra = f' font-family="{family}"' if family else ""
    extra += f' font-weight="{weight}"' if weight else ""
    parts.append(f'<text x="{x}" y="{y}" font-size="{size}" text-anchor="{anchor}" fill="{fill}"{extra}>{string}</text>')


def box(x, y, width, height, fill, border, dashed=False):
    dash = ' stroke-dasharray="5 4"' if dashed else ""
    parts.append(f'<rect x="{x}" y="{y}" width="{width}" height="{height}" rx="5" fill="{fill}" stroke="{border}"{dash}/>')


def arrow(path, dashed=False, both=False):
    dash = ' stroke-dasharray="4 3"' if dashed else ""
    start = ' marker-start="url(#head)"' if both else ""
    parts.append(f'<path d="{path}" fill="none" stroke="#444" stroke-width="1.2"{dash}{start} marker-end="url(#head)"/>')


def stage(x, y, width, height, name, lines, size):
    box(x, y, width, height, *COLORS[group_of[name]])
    for i, line in enumerate(lines):
        text(x + width / 2, y + height / 2 + 4 + (i - (len(lines) - 1) / 2) * (size + 2), line, size, family=MONO)


def frame_part():
    """From the trace to the bins, once per frame."""
    text(20, 30, "Once per frame", 13, "start", weight="bold")
    box(20, 44, 130, 46, "#ffffff", "#666666")
    text(85, 64, "trace")
    text(85, 80, "meshes, camera, draws", 10, fill="#555")
    arrow("M150 67 H196")
    stage(200, 44, 130, 46, "vertex_setup", ["vertex_setup"], 11)
    text(265, 103, "transform, clip, snap to 1/256 px", 10, fill="#555")
    text(398, 60, "setup triangles", 10)
    arrow("M330 67 H466")
    box(470, 44, 130, 46, "#ffffff", "#666666")
    text(535, 64, "bins")
    text(535, 80, "triangles per tile", 10, fill="#555")
    text(632, 60, "bin list", 10)
    arrow("M600 67 H666")
    box(670, 44, 110, 46, "#ffffff", "#666666")
    text(725, 64, "threads")
    text(725, 80, "a bin each", 10, fill="#555")


def beam_part():
    """The stages of `beam` in one bin, and the memory under them."""
    top, left, pitch, width, height = 206, 26, 130, 98, 46
    text(20, 144, "In each bin: beam", 13, "start", weight="bold")
    box(12, 154, 776, 220, "none", "#999999", dashed=True)
    for i, (name, out, memory, use) in enumerate(BEAM):
        x = left + i * pitch
        lines = {"conservative_raster": ["conservative", "_raster"], "beam_fragment": ["beam", "_fragment"]}.get(name, [name])
        stage(x, top, width, height, name, lines, 11)
        if out:
            arrow(f"M{x + width} {top + 23} H{x + pitch - 4}")
            text(x + width + 8, top - 8, out, 10)
        if not use:
            continue
        start, end = (50, 4) if use == "read" else (4, 50)
        arrow(f"M{x + width / 2} {top + height + start} V{top + height + end}", both=use == "both")
        for row, line in enumerate(memory.split("|")):
            text(x + width / 2, top + height + 72 + 14 * row, line, 10)
    # Closed pixels: from compose back to the raster.
    x_from, x_to = left + 3 * pitch + width / 2, left + pitch + width / 2
    y = top - 26
    arrow(f"M{x_from} {top} V{y} H{x_to} V{top - 4}", dashed=True)
    text((x_from + x_to) / 2, y - 6, "closed pixels hide what lies behind them", 10)
    # Memory.
    box(left - 4, top + height + 54, 752, 42, "none", "#b5b5b5")
    text(left - 4, top + height + 112, "off chip: L2 and DRAM, through modelled caches", 10, "start", fill="#555")
    text(776, top + height + 112, "on chip: open pixels and closed depths of the bin, queues of pairs and fragments", 10, "end", fill="#555")


def other_part(techniques):
    """The other techniques, one row each."""
    text(20, 402, "In each bin: the other techniques", 13, "start", weight="bold")
    note = ("sorted order repeats windows to compose; acaa and deferred draw twice (prepass_...); "
            "dilate and temporal work on whole frames.")
    text(20, 420, note, 9.5, "start", fill="#555")
    y, height, row = 434, 20, 27
    for name, stages in techniques:
        text(20, y + 14, name, 10, "start", family=MONO)
        x = 172
        for i, item in enumerate(stages):
            width = 5.6 * len(item) + 10
            stage(x, y, width, height, item, [item], 9)
            if i + 1 < len(stages):
                arrow(f"M{x + width} {y + 10} H{x + width + 10}")
            x += width + 14
        y += row
    y += 14
    text(20, y, "Groups of stages:", 10, "start", fill="#555")
    x = 172
    for group, (fill, border) in COLORS.items():
        box(x, y - 10, 12, 12, fill, border)
        text(x + 18, y, group, 10, "start", family=MONO)
        x += 18 + 6.1 * len(group) + 18


group_of = groups(sys.argv[1])
frame_part()
beam_part()
other_part(other_techniques(sys.argv[1]))
with open(sys.argv[2], "w") as file:
    file.write(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" '
               'font-family="DejaVu Sans, Helvetica, Arial, sans-serif">\n'
               '<title>The beam pipeline and the other techniques, stage by stage</title>\n'
               '<defs><marker id="head" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" '
               'orient="auto-start-reverse"><path d="M0 0 L8 4 L0 8 z" fill="#444"/></marker></defs>\n'
               f'<rect width="{WIDTH}" height="{HEIGHT}" rx="8" fill="#ffffff"/>\n' + "\n".join(parts) + "\n</svg>\n")
