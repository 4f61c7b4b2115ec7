#!/usr/bin/env python3
"""Makes tables of docs/*.md from finished runs: modelled times on several parts, and their ratios.

usage: docs/modelled_times.py times  PROGRAM [--hardware A,B,...] DIR...
       docs/modelled_times.py bins   PROGRAM [--hardware A,B,...] DIR...
       docs/modelled_times.py errors PROGRAM [--hardware A,B,...] DIR...
       docs/modelled_times.py beam   PROGRAM [--hardware A,B,...] DIR...
       docs/modelled_times.py traffic PROGRAM [--hardware A,B,...] DIR...

PROGRAM is for instance beampipe; `beampipe run TRACE -t SPEC... -o DIR` wrote the folders. `times` prints milliseconds,
and the equivalent MSAA rate where `beampipe compare` wrote the folder.
`bins` adds what a bin has on chip. `errors` divides times by that of the published pipeline, beside the paper's ratios.
`beam` divides the times of beam by those of MSAA, for several prices of shading. `traffic` prints what a bin has on chip,
DRAM bytes of geometry and of the rest, and milliseconds.
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
SMALL_BINS = {"mali_g710": "beam:bin=16"}  # parts without room for two bins of `beam`


def model(program, hardware, folders, cost=0):
    """By folder: the times by technique, and by implementation within it."""
    text = subprocess.run([program, "model", *folders, "--json", "--hardware", hardware, "--material-cost", str(cost)],
                          check=True, capture_output=True, text=True).stdout
    found = {}
    for report in json.loads(text):
        times = found.setdefault(report["folder"], {})
        for time in report["times"]:
            times.setdefault(time["technique"], {})[time["implementation"]] = time
    return found


def cells_of(times):
    return [f"{time['sum']:.3f} ({time['busiest']})" for time in times.values()]


def names_of(times):
    return [f"`{name}`" for name in next(iter(times.values()))]


def scene_of(folder):
    return folder.rstrip("/").rsplit("/", 1)[-1]


def results_of(folder):
    with open(f"{folder}/report.json", encoding="utf-8") as file:
        return json.load(file)["results"]


def emr_of(result):
    if "equivalent_msaa" not in result:
        return ""
    bound = ("≥ " if result.get("equivalent_msaa_is_lower_bound") else
             "< " if result.get("equivalent_msaa_is_upper_bound") else "")
    return f"{bound}{result['equivalent_msaa']:.3g}"


def times(program, hardware, folders):
    for folder, found in model(program, hardware, folders).items():
        emr = {result["technique"]: emr_of(result) for result in results_of(folder)}
        print_head("technique", "EMR", *names_of(found))
        for technique, of in found.items():
            print_row(f"`{technique}`", emr[technique], *cells_of(of))


def kib_per_bin(result):
    return sum(buffer["peak_bytes"] for buffer in result["frames"][0]["buffers"] if buffer["held"] == "bin") / 1024


def bins(program, hardware, folders):
    for folder, found in model(program, hardware, folders).items():
        kib = {result["technique"]: kib_per_bin(result) for result in results_of(folder)}
        print_head("technique", "KiB per bin", *names_of(found))
        for technique, of in found.items():
            print_row(f"`{technique}`", f"{kib[technique]:.0f}", *cells_of(of))


def errors(program, hardware, folders):
    rates = [technique for technique in PUBLISHED_MS if technique != BASE]
    print_head("", *(f"`{technique}`" for technique in rates))
    print_row("published", *(f"{PUBLISHED_MS[technique] / PUBLISHED_MS[BASE]:.2f}" for technique in rates))
    for folder, found in model(program, hardware, folders).items():
        for name in found[BASE]:
            cells = []
            for technique in rates:
                ratio = found[technique][name]["sum"] / found[BASE][name]["sum"]
                cells.append(f"{ratio:.2f} ({100 * (ratio * PUBLISHED_MS[BASE] / PUBLISHED_MS[technique] - 1):+.0f} %)")
            print_row(f"{scene_of(folder)}, `{name}`", *cells)


def beam(program, hardware, folders):
    by_cost = {cost: model(program, hardware, folders, cost) for cost in COSTS}
    names = list(by_cost[0][folders[0]][BEAM])
    print_head("ratio", "part", *COSTS)
    for msaa in MSAA:
        for name in names:
            cells = []
            technique = SMALL_BINS.get(name.split(".")[0], BEAM)
            for cost in COSTS:
                of = [by_cost[cost][folder] for folder in folders]
                each = [found[technique][name]["sum"] / found[msaa][name]["sum"] for found in of]
                cells.append(f"{min(each):.2f} to {max(each):.2f}")
            print_row(f"`{technique}` / `{msaa}`", f"`{name}`", *cells)


def dram_megabytes(result):
    """Of geometry (setup triangles, bin lists, attributes of triangles), and of pixels and the picture."""
    geometry = rest = 0
    for name, stage in measure.stages(result).items():
        if name.removeprefix("prepass_") in GEOMETRY:
            geometry += stage["dram_bytes"]
        else:
            rest += stage["dram_bytes"]
    return geometry / 1e6, rest / 1e6


def traffic(program, hardware, folders):
    found = model(program, hardware, folders)
    print_head("scene", "technique", "KiB per bin", "DRAM MB: geometry", "pixels", *names_of(found[folders[0]]))
    for folder, times in found.items():
        for result in results_of(folder):
            name = result["technique"]
            geometry, pixels = dram_megabytes(result)
            print_row(scene_of(folder), f"`{name}`", f"{kib_per_bin(result):.0f}", f"{geometry:.1f}", f"{pixels:.1f}",
                      *(f"{time['sum']:.2f}" for time in times[name].values()))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", choices=("times", "bins", "errors", "beam", "traffic"))
    parser.add_argument("program")
    parser.add_argument("--hardware", default="titan_v")
    parser.add_argument("folders", nargs="+")
    options = parser.parse_args()
    globals()[options.table](options.program, options.hardware, options.folders)
