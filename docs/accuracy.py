#!/usr/bin/env python3
"""Makes the tables and the plot of docs/accuracy.md and docs/findings.md from the table of a sweep.

usage: docs/accuracy.py sweep PROGRAM MODELS -o DIR    every spec below, on the 17 scenes of docs/scene_traces.py
       docs/accuracy.py sizes PROGRAM MODELS -o DIR    some specs in four sizes
       docs/accuracy.py culling PROGRAM MODELS -o DIR  some specs on the 17 scenes, culled the other way
       docs/accuracy.py results|steps|pools|readings TABLE
       docs/accuracy.py density|losses SIZES_TABLE
       docs/accuracy.py faces TABLE CULLING_TABLE
       docs/accuracy.py scenes PROGRAM DIR TABLE SIZES_TABLE
       docs/accuracy.py merges PROGRAM DIR TABLE       what some readings of casav do, scene by scene
       docs/accuracy.py frontier TABLE -o SVG          needs gnuplot

DIR is then a folder of `beampipe sweep`, with the plan and the traces. TABLE is its table.csv. Means over scenes are
geometric. A mean over rates of which some are bounds is a bound; there is none over bounds in both directions, nor over a
scene where MSAA does not converge.
"""
import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import scene_traces
from measure import PROCEDURAL, print_head, print_row, results, stages

SCENES = ["casav", "beam", "beam:bits=128,pool=30", "beam:order=stream", "beam:order=sorted"]
SIZES = ["1280x720", "320x180", "96x54", "32x18"]
DENSITY = ["beam", "beam:order=sorted"]
FACES = ["beam", "beam:order=stream", "beam:order=sorted", "casav", "alpha", "z3", "acaa:8", "dvm", "msaa:8",
         "msaa:256"]
CAPACITIES = {32: "beam:bits=32,pool=16", 64: "beam:bits=64,pool=24", 128: "beam:bits=128,pool=30", 256: "beam"}
POOLS = [16, 30, 40, 60, 80, 128]  # the last one has room for nearly all
ROOM = 2 * 32 * 32 * 160  # bytes on chip: two bins fit on a core, whatever the spec, so that bins are as large as it says
POOLED = {f"beam:{options}": [f"beam:{options}{',' if options else ''}pool={pool}" for pool in POOLS]
          for options in ("bits=256,bin=32", "bits=256,bin=16", "bits=128,bin=32", "bits=128,bin=16")}
OTHERS = ["beam", "beam:order=stream", "beam:order=sorted", "casav", "z3", "z3:shape=128x3", "acaa:8",
          "dvm", "msaa:8", "msaa:32", "msaa:256"]
LABELS = {"beam": "right offset -0.6,0.6", "beam:order=stream": "left offset 0.6,0.6"}  # where a line is at the right
EXACT_MASKS = "casav:mask=exact,fuzzy=mix"
LOSSES = {"as published, best reading": "casav", "masks by edge tests": "casav:mask=exact",
          "specks that take nothing from what is behind": "casav:overlap=unbounded",
          "slabs without thickness": "casav:thickness=none",
          "the depth of each position, no slab": "casav:depths=positions",
          "masks, specks and depths together": "casav:mask=exact,overlap=unbounded,depths=positions",
          "ours, 32 positions, 14 bytes": "beam:order=sorted,bits=32",
          "ours, 256 positions, one triangle at a time": "beam:order=sorted,window=one",
          "ours, 256 positions": "beam:order=sorted"}
STEPS = {"1. published pipeline": "casav", "2. exact masks, and between over and under within the slab": EXACT_MASKS,
         "3. without an A-buffer": "casav:order=near-first,layers=8",
         "4a. areas conserved, 32 positions": "beam:order=sorted,bits=32",
         "4b. areas conserved, 256 positions": "beam:order=sorted",
         **{f"5{letter}. one pass, {bits} positions": spec
            for letter, (bits, spec) in zip("abcd", CAPACITIES.items())}}
RESULTS = ["beam", "beam:bin=16", "beam:bits=128,pool=30", "beam:order=stream", "casav", "z3:shape=128x3", "acaa:8", "msaa:8", "msaa:256"]
READINGS = ["casav", *(f"casav:{reading}" for reading in (
    "reading=literal", "fuzzy=delta", "slab=full", "plane=area", "fuzzy=mix", "mask=exact", "tiny=3",
    "overlap=over", "overlap=transition", "extents=slab",
    "order=near-first,layers=1", "order=near-first,layers=8",
    "order=stream,layers=8")), EXACT_MASKS]
MERGES = ["casav:reading=literal", "casav", "casav:mask=exact,overlap=unbounded,depths=positions"]
ALL = list(dict.fromkeys(SCENES + FACES + list(STEPS.values()) + RESULTS + list(CAPACITIES.values()) + OTHERS +
                         READINGS + MERGES + sum(POOLED.values(), [])))


def sweep(program, models, folder, plan, other_way=False):
    """Makes the scenes and the plan in the folder, and sweeps. What is finished there is not done again."""
    folder = pathlib.Path(folder)
    scene_traces.main(program, models, "320", "180", folder / "scenes", other_way)
    run_sweep(program, folder, [f"scenes/{trace.name}" for trace in sorted((folder / "scenes").glob("*.json"))], plan)


def run_sweep(program, folder, traces, plan):
    """Sweeps traces, which are named as seen from the folder."""
    folder = pathlib.Path(folder)
    plan = {"beampipe_sweep": 1, "traces": traces, "implementations": ["shaders"], "errors": True,
            "memory_system.on_chip_bytes": [ROOM]} | plan
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

    def rates(self, spec, scenes=None, size=None):
        return [rate_of(self.row(scene, spec, size)) for scene in scenes or self.scenes]

    def values(self, column, spec, scenes=None, size=None):
        return [float(self.row(scene, spec, size)[column]) for scene in scenes or self.scenes]


def mean(values):
    return math.exp(sum(map(math.log, values)) / len(values))


def rate(value):
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def rate_of(row):
    """A rate, and whether it is "lower" or "upper" than the true one, or "" if it is that. None if MSAA does not converge."""
    return None if row["emr_bound"] == "none" else (float(row["emr"]), row["emr_bound"])


def rate_text(found):
    return "–" if found is None else {"lower": "≥ ", "upper": "< "}.get(found[1], "") + rate(found[0])


def emr(row):
    return rate_text(rate_of(row))


def mean_rate(rates):
    bounds = {bound for _, bound in filter(None, rates)} - {""}
    if None in rates or len(bounds) > 1:
        return "–"
    return rate_text((mean([value for value, _ in rates]), next(iter(bounds), "")))


def least_rate(rates):
    return rate_text(min(filter(None, rates), default=None))


SUMMARIES = {"geometric mean": mean_rate, "least": least_rate}


def print_scenes(program, folder, table, density):
    """EMRs of each scene, at the size of the sweep and, for `beam`, at 1280 x 720."""
    print_head("scene", "triangles per pixel", *(f"`{spec}`" for spec in SCENES), "`beam` at 1280 × 720")
    columns = [table.rates(spec) for spec in SCENES] + [density.rates("beam", table.scenes, SIZES[0])]
    for scene in table.scenes:
        answer = subprocess.run([program, "info", folder / f"{scene}.json", "--json"], check=True, stdout=subprocess.PIPE)
        frame = json.loads(answer.stdout)["frames"][0]
        print_row(scene, f"{frame['triangles'] / frame['width'] / frame['height']:.2g}",
                  *(emr(table.row(scene, spec)) for spec in SCENES), emr(density.row(scene, "beam", SIZES[0])))
    for title, summary in SUMMARIES.items():
        print_row(title, "", *map(summary, columns))


def print_density(table):
    print_head("technique", *(size.replace("x", " × ") for size in SIZES))
    for spec in DENSITY:
        columns = [table.rates(spec, size=size) for size in SIZES]
        print_row(f"`{spec}`", *(f"{mean_rate(column)}, {least_rate(column)}" for column in columns))


def print_losses(table):
    """What each part of the published rules costs, at two sizes."""
    sizes = SIZES[:2]
    print_head("in place of what the paper does", "spec", *(f"EMR at {size.replace('x', ' × ')}" for size in sizes))
    for title, spec in LOSSES.items():
        columns = [table.rates(spec, size=size) for size in sizes]
        print_row(title, f"`{spec}`", *(f"{mean_rate(column)}, {least_rate(column)}" for column in columns))


def print_faces(table, other_way):
    """EMRs with and without back faces, and how long a frame takes without them, in relation."""
    print_head("technique", "all faces: EMR, mean", "least", "culled: EMR, mean", "least", "time, culled ÷ all")
    for spec in FACES:
        def rows(culled):
            return [(table if (scene in PROCEDURAL) == culled else other_way).row(scene, spec) for scene in table.scenes]
        rates = [list(map(rate_of, rows(culled))) for culled in (False, True)]
        times = [float(new["at_once_ms"]) / float(old["at_once_ms"]) for new, old in zip(rows(True), rows(False))]
        print_row(f"`{spec}`", *(summary(column) for column in rates for summary in SUMMARIES.values()),
                  f"{mean(times):.2f}")


def bytes_of(table, spec):
    """On chip, off chip, and together, as geometric means over the scenes; no bytes count as half of one."""
    places = [table.values(f"{place}_chip_bytes_per_pixel", spec) for place in ("on", "off")]
    return [mean([max(value, 0.5) for value in values]) for values in (*places, list(map(sum, zip(*places))))]


def print_pools(table):
    """What records in memory move through L2, and how long the frame takes, beside those with the largest pool."""
    print_head("technique", *(f"`pool={pool}`" for pool in POOLS[:-1]))
    for technique, specs in POOLED.items():
        largest = specs[-1]
        cells = []
        for spec in specs[:-1]:
            moved = [float(table.row(scene, spec)["l2_bytes"]) - float(table.row(scene, largest)["l2_bytes"])
                     for scene in table.scenes]
            pixels = math.prod(map(int, table.size.split("x")))
            times = [new / old for new, old in zip(table.values("at_once_ms", spec), table.values("at_once_ms", largest))]
            cells.append(f"{sum(moved) / len(moved) / pixels:.1f}, {mean(times):.2f}, {max(times):.2f}")
        print_row(f"`{technique}`", *cells)


def print_groups(table, specs, titles=(), extra=lambda spec: ()):
    """A row for each spec: what `extra` says, and EMRs over procedural scenes, models and all."""
    models = [scene for scene in table.scenes if scene not in PROCEDURAL]
    procedural = [scene for scene in table.scenes if scene in PROCEDURAL]
    groups = {"procedural": procedural, "models": models, "all": table.scenes}
    groups = {title: scenes for title, scenes in groups.items() if scenes}
    print_head("technique", *titles, *(f"EMR: {title}" if i == 0 else title for i, title in enumerate(groups)), "least")
    for spec in specs:
        print_row(f"`{spec}`", *extra(spec), *(mean_rate(table.rates(spec, scenes)) for scenes in groups.values()),
                  least_rate(table.rates(spec)))


def print_steps(table):
    print_head("step", "spec", "on chip", "off chip", "EMR: mean", "least", "RMSE ÷ that of `msaa:256`")
    for step, spec in STEPS.items():
        rates = table.rates(spec)
        print_row(step, f"`{spec}`", *(f"{value:.0f}" for value in bytes_of(table, spec)[:2]), mean_rate(rates),
                  least_rate(rates), f"{rmse_ratio(table, spec):.2f}")


def rmse_ratio(table, spec):
    return mean(table.values("rmse", spec)) / mean(table.values("rmse", "msaa:256"))


def print_results(table):
    print_groups(table, RESULTS, ["on chip", "off chip", "RMSE ÷ that of `msaa:256`"], lambda spec: [
        *(f"{value:.0f}" for value in bytes_of(table, spec)[:2]), f"{rmse_ratio(table, spec):.2f}"])


def print_readings(table):
    pixels = math.prod(map(int, table.size.split("x")))
    print_groups(table, READINGS, ["off chip", "operations per pixel", "RMSE ÷ that of `msaa:256`"], lambda spec: [
        f"{bytes_of(table, spec)[1]:.0f}", f"{mean(table.values('operations', spec)) / pixels:.0f}",
        f"{rmse_ratio(table, spec):.1f}"])


def print_merges(program, folder, table):
    """EMR, RMSE x 1000 and operations per merge of each scene. These are `compose`'s operations over its fragments."""
    print_head("scene", "off chip", *(f"`{spec}`" for spec in MERGES))
    columns = {spec: [] for spec in MERGES}
    for scene in table.scenes:
        with tempfile.TemporaryDirectory() as pictures:
            found = results(program, "run", folder / f"{scene}.json", MERGES, pictures, "--no-memory-model")
        for spec in MERGES:
            compose = stages(found[spec])["compose"]
            columns[spec].append((float(table.row(scene, spec)["emr"]), 1000 * float(table.row(scene, spec)["rmse"]),
                                  compose["ops"]["total"] / compose["items_in"]))
    def cells(values):
        return [f"{rate(emr)}, {rmse:.2f}, {work:.0f}" for emr, rmse, work in values]
    bytes_off_chip = table.values("off_chip_bytes_per_pixel", "casav")
    for i, scene in enumerate(table.scenes):
        print_row(scene, f"{bytes_off_chip[i]:.0f}", *cells(column[i] for column in columns.values()))
    print_row("geometric mean", f"{mean(bytes_off_chip):.0f}",
              *cells(tuple(map(mean, zip(*column))) for column in columns.values()))


def draw_frontier(table, path):
    """Memory against EMR: a line of `beam` by its positions, and labelled points for the others."""
    line = [(bytes_of(table, spec)[2], mean(table.values("emr", spec))) for spec in CAPACITIES.values()]
    data = ["$beam << EOD\n" + "".join(f"{x} {y}\n" for x, y in line) + "EOD\n"]
    plots = ["$beam with linespoints pt 7 ps 0.6 title 'beam, 32 to 256 positions'"]
    points = {spec: f'{bytes_of(table, spec)[2]} {mean(table.values("emr", spec))} "{spec}"\n' for spec in OTHERS}
    for i, (spec, point) in enumerate(points.items()):
        data.append(f"$other{i} << EOD\n{point}EOD\n")
        plots += [f"$other{i} using 1:2 with points pt 6 ps 1 lc 'black' notitle",
                  f"$other{i} using 1:2:3 with labels {LABELS.get(spec, 'left offset 0.8,0')} noenhanced font ',11' notitle"]
    script = "".join(data) + f"""
set terminal svg size 900,560 font 'sans-serif,13' background 'white'
set output {json.dumps(str(path))}
set logscale xy
set xrange [20:6000]
set yrange [1.5:1100]
set xlabel 'bytes per pixel, on chip and off chip together'
set ylabel 'equivalent MSAA rate, geometric mean'
set key bottom right
set grid
plot {', '.join(plots)}
"""
    subprocess.run(["gnuplot"], input=script, text=True, check=True)


TABLES = {"losses": print_losses,
          "results": print_results, "steps": print_steps, "density": print_density,
          "pools": print_pools, "readings": print_readings}


def main(arguments):
    match arguments:
        case ["sweep", program, models, "-o", folder]:
            sweep(program, models, folder, {"techniques": ALL})
        case ["sizes", program, models, "-o", folder]:
            specs = list(dict.fromkeys([*DENSITY, *LOSSES.values()]))
            sweep(program, models, folder, {"techniques": specs, "sizes": SIZES})
        case ["culling", program, models, "-o", folder]:
            sweep(program, models, folder, {"techniques": FACES}, other_way=True)
        case ["faces", table, other_way]:
            print_faces(Table(table), Table(other_way))
        case ["scenes", program, folder, table, density]:
            print_scenes(program, pathlib.Path(folder) / "scenes", Table(table), Table(density))
        case ["merges", program, folder, table]:
            print_merges(program, pathlib.Path(folder) / "scenes", Table(table))
        case ["frontier", table, "-o", path]:
            draw_frontier(Table(table), path)
        case [kind, table] if kind in TABLES:
            TABLES[kind](Table(table))
        case _:
            sys.exit(__doc__.strip())


if __name__ == "__main__":
    main(sys.argv[1:])
