#!/usr/bin/env python3
"""Makes tables of docs/*.md from finished runs: modelled times on several parts, and their ratios.

usage: docs/modelled_times.py TABLE PROGRAM DIR...

PROGRAM is for instance beampipe. The folders are PART/SCENE, as `beampipe run TRACE -t SPEC... --hardware PART -o
PART/SCENE` wrote them; those of one scene stand side by side. TABLE is one of these:

times    milliseconds with their intervals, and the equivalent MSAA rate where `beampipe compare` wrote the first folder
bins     what a bin has on chip, and milliseconds
errors   times over that of the published pipeline, beside the paper's ratios
beam     times of beam over those of MSAA, for several prices of shading
ways     the same without a price of shading, for each way in which stages can follow each other
traffic  what a bin has on chip, DRAM bytes of geometry and of the rest, and milliseconds
measured  measured times of a CSV file, which stands in place of the folders, and what is modelled
"""
import argparse
import json
import subprocess

import measure
from measure import print_head, print_row

PUBLISHED_MS = {"casav": 30.2, "msaa:32": 24.0, "msaa:128": 78.0, "msaa:256": 198.0}  # Titan V, classroom
BASE = "casav"
COSTS = (0, 1000, 10000)  # operations per invocation
GEOMETRY = {"vertex_setup", "bin_sort", "conservative_raster", "sample_raster", "beam_fragment", "shade"}
BEAM, MSAA = "beam", ("msaa:8", "msaa:8,prepass")


def scene_of(folder):
    return folder.rstrip("/").rsplit("/", 1)[-1]


def model(program, folders, *options):
    """By scene: the times by technique, and by PART.IMPLEMENTATION within it."""
    text = subprocess.run([program, "model", *folders, "--json", *options], check=True, stdout=subprocess.PIPE,
                          text=True).stdout
    found = {}
    for report in json.loads(text):
        times = found.setdefault(scene_of(report["folder"]), {})
        for time in report["times"]:
            times.setdefault(time["technique"], {})[f"{time['hardware']}.{time['implementation']}"] = time
    return found


def first_folders(folders):
    """By scene: the first of its folders."""
    first = {}
    for folder in folders:
        first.setdefault(scene_of(folder), folder)
    return first


def limit_of(time):
    """The busiest unit, and the rate that limits it where that is not the unit's own."""
    rate = time["busiest_rate"].removeprefix("core_").removesuffix("_per_clk")
    return time["busiest"] if rate.startswith(time["busiest"]) else f"{time['busiest']}: {rate}"


def cells_of(times, names):
    """Milliseconds with their interval, and the busiest unit."""
    return [f"{time['in_turn']:.3f} ({time['in_turn_interval'][0]:.3g}–{time['in_turn_interval'][1]:.3g}, {limit_of(time)})"
            for time in (times[name] for name in names)]


def names_of(times):
    return list(next(iter(times.values())))


def quoted(names):
    return [f"`{name}`" for name in names]


def results_of(folder):
    with open(f"{folder}/report.json", encoding="utf-8") as file:
        return json.load(file)["results"]


def emr_of(result):
    if "equivalent_msaa" not in result:
        return ""
    bound = ("≥ " if result.get("equivalent_msaa_is_lower_bound") else
             "< " if result.get("equivalent_msaa_is_upper_bound") else "")
    return f"{bound}{result['equivalent_msaa']:.3g}"


def times(program, folders):
    first = first_folders(folders)
    for scene, found in model(program, folders).items():
        emr = {result["technique"]: emr_of(result) for result in results_of(first[scene])}
        names = names_of(found)
        print_head("technique", "EMR", *quoted(names))
        for technique, of in found.items():
            print_row(f"`{technique}`", emr[technique], *cells_of(of, names))


def kib_per_bin(result):
    return sum(buffer["peak_bytes"] for buffer in result["frames"][0]["buffers"] if buffer["held"] == "bin") / 1024


def bins(program, folders):
    first = first_folders(folders)
    for scene, found in model(program, folders).items():
        kib = {result["technique"]: kib_per_bin(result) for result in results_of(first[scene])}
        names = names_of(found)
        print_head("technique", "KiB of a bin", "bins held", *quoted(names))
        for technique, of in found.items():
            held = next(iter(of.values())).get("bins_held", "none")
            print_row(f"`{technique}`", f"{kib[technique]:.0f}", held, *cells_of(of, names))


def errors(program, folders):
    rates = [technique for technique in PUBLISHED_MS if technique != BASE]
    print_head("", *quoted(rates))
    print_row("published", *(f"{PUBLISHED_MS[technique] / PUBLISHED_MS[BASE]:.2f}" for technique in rates))
    for scene, found in model(program, folders, "--over", BASE).items():
        for name in found[BASE]:
            cells = []
            for technique in rates:
                time = found[technique][name]
                off = 100 * (time["ratio"] * PUBLISHED_MS[BASE] / PUBLISHED_MS[technique] - 1)
                low, high = time["ratio_interval"]
                cells.append(f"{time['ratio']:.2f} ({low:.2f}–{high:.2f}; {off:+.0f} %)")
            print_row(f"{scene}, `{name}`", *cells)


def beam(program, folders):
    print_head("ratio", "part", *COSTS)
    for msaa in MSAA:
        by_cost = {cost: model(program, folders, "--material-cost", str(cost), "--over", msaa) for cost in COSTS}
        scenes = list(by_cost[0])
        for name in by_cost[0][scenes[0]][BEAM]:
            cells = []
            for cost in COSTS:
                of = [by_cost[cost][scene][BEAM][name] for scene in scenes]
                ratios = [time["ratio"] for time in of]
                low, high = min(time["ratio_interval"][0] for time in of), max(time["ratio_interval"][1] for time in of)
                cells.append(f"{min(ratios):.2f}–{max(ratios):.2f} ({low:.2f}–{high:.2f})")
            print_row(f"`{BEAM}` / `{msaa}`", f"`{name}`", *cells)


def ways(program, folders):
    found = model(program, folders)
    print_head(f"`{BEAM}` / `{MSAA[0]}`", "in turn", "on cores", "at once")
    for name in names_of(next(iter(found.values()))):
        cells = []
        for way in ("in_turn", "on_cores", "at_once"):
            ratios = [times[BEAM][name][way] / times[MSAA[0]][name][way] for times in found.values()]
            cells.append("–".join(f"{ratio:.2f}" for ratio in sorted({min(ratios), max(ratios)})))
        print_row(f"`{name}`", *cells)


def dram_megabytes(result):
    """Of geometry (setup triangles, bin lists, attributes of triangles), and of pixels and the picture."""
    geometry = rest = 0
    for name, stage in measure.stages(result).items():
        if name.removeprefix("prepass_") in GEOMETRY:
            geometry += stage["dram_bytes"]
        else:
            rest += stage["dram_bytes"]
    return geometry / 1e6, rest / 1e6


def traffic(program, folders):
    found, first = model(program, folders), first_folders(folders)
    names = names_of(found[scene_of(folders[0])])
    print_head("scene", "technique", "KiB per bin", "DRAM MB: geometry", "pixels", *quoted(names))
    for scene, times_of in found.items():
        for result in results_of(first[scene]):
            name = result["technique"]
            geometry, pixels = dram_megabytes(result)
            print_row(scene, f"`{name}`", f"{kib_per_bin(result):.0f}", f"{geometry:.1f}", f"{pixels:.1f}",
                      *(f"{times_of[name][part]['in_turn']:.2f}" if part in times_of[name] else "" for part in names))


def measured(program, files):
    text = subprocess.run([program, "correlate", *files, "--json"], check=True, stdout=subprocess.PIPE, text=True).stdout
    found = json.loads(text)
    ways = ("in_turn", "at_once")
    print_head("", "measured", "in turn", "over measured", "at once", "over measured")
    for row in found["rows"]:
        modelled = [(f"{row[way]['modelled']:.3g}", f"{row[way]['over_measured']:.2f}") for way in ways]
        print_row(row["name"], f"{row['measured']:.3g}", *modelled[0], *modelled[1])
    errors = [cell for way in ways for cell in ("", f"{found[way]['mape']:.0%}".replace("%", " %"))]
    print_row("mean absolute error", "", *errors)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", choices=("times", "bins", "errors", "beam", "ways", "traffic", "measured"))
    parser.add_argument("program")
    parser.add_argument("folders", nargs="+")
    options = parser.parse_args()
    globals()[options.table](options.program, options.folders)
