#!/usr/bin/env python3
"""Makes the tables and the plot of docs/accuracy.md from the table of a sweep.

usage: docs/accuracy.py sweep PROGRAM MODELS -o DIR    every spec below, on the 17 scenes of docs/scene_traces.py
       docs/accuracy.py sizes PROGRAM MODELS -o DIR    two specs in four sizes
       docs/accuracy.py scenes|density|results|steps|bins|storage|order|unsorted|policies|formats TABLE
       docs/accuracy.py overview PROGRAM DIR TABLE SIZES_TABLE
       docs/accuracy.py frontier TABLE -o SVG          needs gnuplot

DIR is then a folder of `beampipe sweep`, with the plan and the traces. TABLE is its table.csv. Means over scenes are
geometric; bounds of an EMR are taken for the EMR.
"""
import csv
import json
import math
import pathlib
import subprocess
import sys

import scene_traces
from measure import PROCEDURAL, print_head, print_row

SCENES = ["beam", "beam:bits=64,slots=4", "beam:bits=32,slots=2", "beam:order=stream", "beam:order=sorted",
          "casav", "z3:shape=128x3", "alpha"]
SIZES = ["1280x720", "320x180", "96x54", "32x18"]
DENSITY = ["beam", "beam:order=sorted"]
POSITIONS = {32: "bits=32,", 64: "bits=64,", 128: "bits=128,", 256: ""}
CAPACITIES = {bits: [f"beam:{text}slots={slots}" for slots in (2, 4, 8, 16, 32)] for bits, text in POSITIONS.items()}
OTHERS = ["beam", "beam:order=stream", "beam:order=sorted", "casav", "z3", "z3:shape=128x3", "acaa:8",
          "dvm", "msaa:8", "msaa:32", "msaa:256"]
STORAGE = sum(CAPACITIES.values(), []) + OTHERS
BEST_READING = "casav:mask=exact,local=keep,fuzzy=mix,slab=visible,plane=visible"
STEPS = {"1. our reading of the published rules": "casav", "2. the best reading": BEST_READING,
         "3. without an A-buffer, from sorted bins": "casav:order=near-first,layers=8",
         "4a. areas conserved, with an A-buffer, 32 positions": "beam:order=sorted,bits=32",
         "4b. the same, 256 positions": "beam:order=sorted", "5a. one pass, 32 positions, 2 slots": "beam:bits=32,slots=2",
         "5b. 64 positions, 4 slots": "beam:bits=64,slots=4", "5c. 256 positions, 5 slots": "beam",
         "5d. 256 positions, 16 slots": "beam:slots=16"}
RESULTS = ["beam", "beam:bin=16", "beam:bits=64,slots=4", "beam:order=stream", "beam:order=sorted", "casav",
           "z3:shape=128x3", "z3", "acaa:8", "alpha", "msaa:8", "msaa:32", "msaa:256"]
ORDER = ["casav", *(f"casav:order={order},layers={layers}" for order in ("near-first", "stream")
                               for layers in (1, 3, 8))]
UNSORTED = ["beam", "beam:order=sorted", "beam:order=stream", "z3:shape=32x2", "z3", "z3:shape=128x3"]
POLICIES = ["casav", *(f"casav:{policy}" for policy in (
    "mask=exact", "sort=nearest", "tiny=3", "overlap=over", "overlap=add", "overlap=transition", "regional=area",
    "local=keep", "fuzzy=mix", "extents=slab", "slab=visible", "plane=visible", "thickness=containing",
    "tiny=3,overlap=transition")), BEST_READING]
BINS = {spec: [spec, *(f"{spec}{',' if ':' in spec else ':'}bin={bin}" for bin in (16, 8))]
        for spec in ("beam", "beam:bits=64,slots=4", "beam:bits=32,slots=2")}
FORMATS = ["beam:order=sorted", "beam:order=sorted,storage=float32", "casav", "casav:storage=text",
           "casav:storage=float32"]
ALL = list(dict.fromkeys(SCENES + list(STEPS.values()) + RESULTS + STORAGE + ORDER + UNSORTED + POLICIES + FORMATS +
                         sum(BINS.values(), [])))


def sweep(program, models, folder, plan):
    """Makes the scenes and the plan in the folder, and sweeps. What is finished there is not done again."""
    folder = pathlib.Path(folder)
    scene_traces.main(program, models, "320", "180", folder / "scenes")
    traces = [f"scenes/{trace.name}" for trace in sorted((folder / "scenes").glob("*.json"))]
    plan = {"beampipe_sweep": 1, "traces": traces, "implementations": ["shaders"], "errors": True} | plan
    (folder / "plan.json").write_text(json.dumps(plan, indent=1) + "\n")
    subprocess.run([program, "sweep", folder / "plan.json", "-o", folder], check=True, stdout=subprocess.DEVNULL)


class Table:
    """The rows of a sweep by scene and technique, of the first size unless one is named."""

    def __init__(self, path):
        self.rows, self.scenes = {}, []
        with open(path, newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                self.rows[pathlib.Path(row["trace"]).stem, row["technique"], f"{row['width']}x{row['height']}"] = row
        found = {scene for scene, *_ in self.rows}
        self.scenes = [*(name for name in PROCEDURAL if name in found), *sorted(found - set(PROCEDURAL))]
        self.size = next(iter(self.rows))[2]

    def row(self, scene, spec, size=None):
        return self.rows[scene, spec, size or self.size]

    def values(self, column, spec, scenes=None, size=None):
        return [float(self.row(scene, spec, size)[column]) for scene in scenes or self.scenes]


def mean(values):
    return math.exp(sum(map(math.log, values)) / len(values))


def rate(value):
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def emr(row):
    return {"lower": "≥ ", "upper": "< "}.get(row["emr_bound"], "") + rate(float(row["emr"]))


def print_scenes(table):
    print_head("scene", *(f"`{spec}`" for spec in SCENES))
    for scene in table.scenes:
        print_row(scene, *(emr(table.row(scene, spec)) for spec in SCENES))
    print_row("geometric mean", *(rate(mean(table.values("emr", spec))) for spec in SCENES))
    print_row("least", *(rate(min(table.values("emr", spec))) for spec in SCENES))


def print_density(table):
    print_head("scene", *(f"{size.replace('x', ' × ')}: {'sorted' if 'sorted' in spec else f'`{spec}`'}" for size in SIZES
                          for spec in DENSITY))
    for scene in table.scenes:
        print_row(scene, *(emr(table.row(scene, spec, size)) for size in SIZES for spec in DENSITY))
    for title, summary in (("geometric mean", mean), ("least", min)):
        print_row(title, *(rate(summary(table.values("emr", spec, size=size))) for size in SIZES for spec in DENSITY))


def bytes_of(table, spec):
    """On chip, off chip, and together, as geometric means over the scenes; no bytes count as half of one."""
    places = [table.values(f"{place}_chip_bytes_per_pixel", spec) for place in ("on", "off")]
    return [mean([max(value, 0.5) for value in values]) for values in (*places, list(map(sum, zip(*places))))]


def print_storage(table):
    print_head("technique", "on chip", "off chip", "together", "EMR: geometric mean", "least")
    for spec in STORAGE:
        rates = table.values("emr", spec)
        print_row(f"`{spec}`", *(f"{value:.0f}" for value in bytes_of(table, spec)), rate(mean(rates)), rate(min(rates)))


def print_groups(table, specs, titles=(), extra=lambda spec: ()):
    """A row for each spec: what `extra` says, and EMRs over procedural scenes, models and all."""
    models = [scene for scene in table.scenes if scene not in PROCEDURAL]
    procedural = [scene for scene in table.scenes if scene in PROCEDURAL]
    groups = {"procedural": procedural, "models": models, "all": table.scenes}
    groups = {title: scenes for title, scenes in groups.items() if scenes}
    print_head("technique", *titles, *(f"EMR: {title}" if i == 0 else title for i, title in enumerate(groups)), "least")
    for spec in specs:
        print_row(f"`{spec}`", *extra(spec), *(rate(mean(table.values("emr", spec, scenes))) for scenes in groups.values()),
                  rate(min(table.values("emr", spec))))


def print_steps(table):
    print_head("step", "spec", "on chip", "off chip", "EMR: mean", "least", "RMSE ÷ that of `msaa:256`")
    for step, spec in STEPS.items():
        rates = table.values("emr", spec)
        print_row(step, f"`{spec}`", *(f"{value:.0f}" for value in bytes_of(table, spec)[:2]), rate(mean(rates)),
                  rate(min(rates)), f"{rmse_ratio(table, spec):.2f}")


def rmse_ratio(table, spec):
    return mean(table.values("rmse", spec)) / mean(table.values("rmse", "msaa:256"))


def print_results(table):
    print_groups(table, RESULTS, ["on chip", "off chip", "RMSE ÷ that of `msaa:256`"], lambda spec: [
        *(f"{value:.0f}" for value in bytes_of(table, spec)[:2]), f"{rmse_ratio(table, spec):.2f}"])


def print_bins(table):
    """The specs have bins of 32 pixels, and those of 16 and 8 that follow."""
    print_head("technique", *(f"`bin={bin}`: {title}" for bin in (32, 16, 8) for title in ("geometric mean", "least")))
    for spec, specs in BINS.items():
        rates = [table.values("emr", each) for each in specs]
        print_row(f"`{spec}`", *(rate(summary(of_spec)) for of_spec in rates for summary in (mean, min)))


def print_overview(program, folder, table, density):
    print_head("scene", "triangles", "per pixel", "`casav`", "`beam`", "`beam` at 1280 × 720")
    rates = []
    for scene in table.scenes:
        answer = subprocess.run([program, "info", folder / f"{scene}.json", "--json"], check=True, capture_output=True)
        frame = json.loads(answer.stdout)["frames"][0]
        rows = table.row(scene, "casav"), table.row(scene, "beam"), density.row(scene, "beam", "1280x720")
        rates.append([float(row["emr"]) for row in rows])
        print_row(scene, f"{frame['triangles']:,}", f"{frame['triangles'] / frame['width'] / frame['height']:.2g}",
                  *map(emr, rows))
    for title, summary in (("geometric mean", mean), ("least", min)):
        print_row(title, "", "", *(rate(summary(column)) for column in zip(*rates)))


def print_unsorted(table):
    def extra(spec):
        work = [a / b for a, b in zip(table.values("operations", spec), table.values("operations", "beam:order=sorted"))]
        return *(f"{value:.0f}" for value in bytes_of(table, spec)[:2]), f"{mean(work):.2f}", f"{max(work):.2f}"

    print_groups(table, UNSORTED, ["bytes on chip", "bytes off chip", "operations ÷ those of sorted order", "most"], extra)


def print_formats(table):
    def extra(spec):
        return (f"{bytes_of(table, spec)[1]:.0f}", f"{1000 * mean(table.values('rmse', spec)):.3f}")

    print_groups(table, FORMATS, ["bytes off chip", "RMSE × 1000"], extra)


def draw_frontier(table, path):
    """Memory against EMR: a line for each number of positions, and labelled points for the others."""
    data, plots = [], []
    for bits, specs in CAPACITIES.items():
        points = [(bytes_of(table, spec)[2], mean(table.values("emr", spec))) for spec in specs]
        data.append(f"$b{bits} << EOD\n" + "".join(f"{x} {y}\n" for x, y in points) + "EOD\n")
        plots.append(f"$b{bits} with linespoints pt 7 ps 0.6 title '{bits} positions, 2 to 32 slots'")
    others = [f'{bytes_of(table, spec)[2]} {mean(table.values("emr", spec))} "{spec}"\n' for spec in OTHERS]
    data.append("$others << EOD\n" + "".join(others) + "EOD\n")
    plots += ["$others using 1:2 with points pt 6 ps 1 lc 'black' notitle",
              "$others using 1:2:3 with labels left offset 0.8,0 noenhanced font ',11' notitle"]
    script = "".join(data) + f"""
set terminal svg size 900,560 font 'sans-serif,13' background 'white'
set output {json.dumps(str(path))}
set logscale xy
set xrange [40:6000]
set yrange [1.5:1100]
set xlabel 'bytes per pixel, on chip and off chip together'
set ylabel 'equivalent MSAA rate, geometric mean'
set key bottom right
set grid
plot {', '.join(plots)}
"""
    subprocess.run(["gnuplot"], input=script, text=True, check=True)


TABLES = {"results": print_results, "steps": print_steps, "scenes": print_scenes, "density": print_density,
          "bins": print_bins, "storage": print_storage, "unsorted": print_unsorted,
          "order": lambda table: print_groups(table, ORDER), "policies": lambda table: print_groups(table, POLICIES),
          "formats": print_formats}


def main(arguments):
    match arguments:
        case ["sweep", program, models, "-o", folder]:
            sweep(program, models, folder, {"techniques": ALL})
        case ["sizes", program, models, "-o", folder]:
            sweep(program, models, folder, {"techniques": DENSITY, "sizes": SIZES})
        case ["overview", program, folder, table, density]:
            print_overview(program, pathlib.Path(folder) / "scenes", Table(table), Table(density))
        case ["frontier", table, "-o", path]:
            draw_frontier(Table(table), path)
        case [kind, table] if kind in TABLES:
            TABLES[kind](Table(table))
        case _:
            sys.exit(__doc__.strip())


if __name__ == "__main__":
    main(sys.argv[1:])
