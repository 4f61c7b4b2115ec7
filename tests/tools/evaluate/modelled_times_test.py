#!/usr/bin/env python3
"""Computes all modelled times of a report again from its counters and its hardware, as docs/costs.md describes them.

usage: modelled_times_test.py BEAMPIPE SOURCE_FOLDER
"""
import heapq
import json
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

NO_COSTS = {kind: {"operations": 0, "fetches": 0, "registers": 0} for kind in ("material", "light")}
OF_CORES = {"shader", "texture", "latency"}
PICTURE = {"motion", "dilate", "temporal", "resolve"}
SHADING = {"sample_select", "material_sort", "shade", "light"}
BY_PIXEL = {"a_buffer", "windows", "compose", "depth_test", "blend", "stencil_test", "accumulate", "motion", "dilate",
            "temporal", "resolve"}
SPECS = ["beam", "beam:order=sorted", "casav", "msaa:8", "msaa:8,prepass", "acaa:8", "deferred", "taa:4", "dvm"]


def unit_clocks(unit, stage, described, on_chip, memory, threads):
    """The clocks that a unit needs for the work of a stage. threads: in flight, of all cores."""
    per_core = {name[len("core_"):]: rate * memory["cores"] for name, rate in described.items() if name.startswith("core_")}
    rates = described | per_core
    ops, logical = stage["ops"], stage["bytes_read"] + stage["bytes_written"]
    pixels = logical / rates["on_chip_bytes_per_clk" if on_chip else "rop_bytes_per_clk"]
    if unit in ("shader", "shading"):
        floats = ops["mul_add"] + ops["add"]
        narrow = max(1 - ops["wide"] / floats, 0) if floats else 0
        return max((ops["total"] + ops["wide"]) / rates["issue_per_clk"],
                   narrow * (ops["mul_add"] / rates["mul_add_per_clk"] + ops["add"] / rates["add_per_clk"]),
                   ops["bit"] / rates["bit_per_clk"] + ops["wide"] / rates["wide_per_clk"],
                   *(ops[kind] / rates[f"{kind}_per_clk"] for kind in ("fetch", "special", "convert")),
                   (logical - stage["texture_bytes"]) / rates["on_chip_bytes_per_clk"])
    works = {
        "triangles": [("items_in", "triangles_per_clk")],
        "raster": [("items_in", "triangles_per_clk"), ("items_out", "raster_pixels_per_clk")],
        "conservative_raster": [("items_in", "triangles_per_clk"), ("lanes_used", "conservative_pixels_per_clk")],
        "export": [("bytes_written", "export_bytes_per_clk")],
        "texture": [("texture_bytes", "texture_bytes_per_clk")],
        "mask_generator": [("items_in", "conservative_pixels_per_clk"), ("position_tests", "mask_positions_per_clk")],
        "composer": [("items_in", "rop_fragments_per_clk"), ("position_tests", "compose_positions_per_clk")],
        "rop_samples": [("items_in", "rop_samples_per_clk")],
        "rop_fragments": [("items_in", "rop_fragments_per_clk")],
        "sorter": [("items_in", "rop_fragments_per_clk")],
        "l2": [("l2_bytes", "l2_bytes_per_clk")],
    }
    if unit == "latency":
        dram = min(stage["dram_bytes"], stage["l2_bytes"])
        sectors = (stage["l2_bytes"] - dram) * rates["l2_clocks"] + dram * rates["dram_clocks"]
        return ((ops["total"] + ops["wide"] - ops["fetch"]) * rates["operation_clocks"] + 4 * sectors / memory["sector_bytes"]
                + (ops["fetch"] + stage["texture_bytes"] / 16) * rates["fetch_clocks"]) / threads
    if unit == "quads":
        return stage["lanes_issued"] / 4 / rates["quads_per_clk"]
    if unit == "dram":
        return stage["dram_bytes"] / (rates["dram_bytes_per_clk"] * rates["dram_efficiency"])
    clocks = [stage[counter] / rates[rate] for counter, rate in works[unit]]
    if unit == "sorter":
        clocks.append(ops["total"] / rates["sort_operations_per_clk"])
    if unit in ("composer", "rop_samples", "rop_fragments"):
        clocks.append(pixels)
    return max(clocks)


def priced(stage, shading, has_light):
    """The stage's counters with what its invocations cost beside their materials, and the registers of one."""
    name, costs = stage["stage"], []
    if name == "shade":
        costs = [shading["material"]] + ([] if has_light else [shading["light"]])
    elif name == "light":
        costs = [shading["light"]]
    stage = stage | {"ops": dict(stage["ops"])}
    for cost in costs:
        half, texels = int(stage["lanes_issued"] * cost["operations"] / 2), int(stage["lanes_issued"] * cost["fetches"] * 16)
        for kind, more in (("mul_add", half), ("add", half), ("total", 2 * half)):
            stage["ops"][kind] += more
        for counter in ("bytes_read", "texture_bytes"):
            stage[counter] += texels
    return stage, max([cost["registers"] for cost in costs], default=0)


def threads_of_bin(stage, pixels, bins):
    """Of the mean bin: its items, of which those of a pixel are taken in order by some stages."""
    name = stage["stage"].removeprefix("prepass_")
    items = stage["lanes_issued" if name in SHADING else "items_in"] / bins
    return min(items, pixels) if pixels and name in BY_PIXEL else items


def on_busiest_core(operations, cores):
    """The work of the busiest core over the mean: each bin starts on the core that is free first."""
    free_at = [0] * cores
    for work in operations:
        heapq.heapreplace(free_at, free_at[0] + work)
    return max(free_at) * cores / sum(operations) if sum(operations) else 1


class ModelledTimesTest(unittest.TestCase):
    def test_every_time_follows_from_counters_and_rates(self):
        with tempfile.TemporaryDirectory() as scratch:
            trace, out = f"{scratch}/trace.json", pathlib.Path(scratch) / "out"
            size = ["--triangles", "4000", "--width", "96", "--height", "54"]
            subprocess.run([BEAMPIPE, "make", "room", *size, "-o", trace], check=True, stdout=subprocess.DEVNULL)
            for part in ("titan_v", "rtx_4090", "mali_g710", f"{SOURCE}/docs/examples/hardware.json"):
                subprocess.run([BEAMPIPE, "run", trace, "-t", *SPECS, "--hardware", part, "-o", out, "--force"], check=True,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                self.check(json.loads((out / "report.json").read_text()), part)

    def check(self, report, part):
        hardware, memory = report["hardware"], report["memory_system"]
        rates, clocks_per_ms = hardware["rates"], hardware["clock_mhz"] * 1e3
        compared = []
        for result in report["results"]:
            frame = result["frames"][0]
            bin_bytes = sum(buffer["peak_bytes"] for buffer in frame["buffers"] if buffer["name"] == "open_pixels")
            most = memory["bins_per_core"] * max(1024 // frame["bin_pixels"], 1)
            held = max(min(memory["on_chip_bytes"] // max(bin_bytes, 1), most), 1)
            all_bins, shaded_bins = (max(sum(work > 0 for work in frame[key]), 1) for key in ("bin_operations", "bin_invocations"))
            for way, implementation in hardware["implementations"].items():
                before, of_bins, in_turn, alone = {}, {}, 0, 0
                units_of = {stage["stage"]: implementation["units"][stage["stage"].removeprefix("prepass_")]
                            for stage in frame["stages"]}
                used = {unit for name, units in units_of.items() if name != "resolve" for unit in units}
                has_rops = used & {"rop_samples", "rop_fragments", "composer"}
                not_there = set() if has_rops else {"export"}
                has_light = any(stage["stage"] == "light" for stage in frame["stages"])
                for counted in frame["stages"]:
                    stage, registers = priced(counted, hardware.get("shading", NO_COSTS), has_light)
                    units = units_of[stage["stage"]]
                    is_geometry = stage["stage"].endswith("vertex_setup")
                    threads = rates["core_threads"]
                    if registers:
                        threads = min(threads, rates["core_registers"] // registers)
                    if not is_geometry:
                        bins = all_bins if stage["stage"] in PICTURE else shaded_bins
                        threads = min(threads, held * threads_of_bin(stage, frame["bin_pixels"], bins))
                    threads = max(min(threads * memory["cores"], threads_of_bin(stage, None, 1)), 1)
                    if {"shader", "shading"} & set(units):
                        units = units + ["latency"]
                    times = {unit: unit_clocks(unit, stage, rates, bin_bytes > 0, memory, threads)
                             / clocks_per_ms for unit in units + ["l2", "dram"] if unit not in not_there}
                    if "shading" in times:
                        times["shader"] = max(times.pop("shading"), times.get("shader", 0))
                    compared.append((f"{part} {result['technique']} {way} {stage['stage']}", stage["modelled_ms"][way],
                                     max(times.values())))
                    in_turn += max(times.values())
                    for unit, ms in times.items():
                        busy = before if is_geometry else of_bins
                        busy[unit] = busy.get(unit, 0) + ms
                    if not is_geometry:  # what a bin takes that has its core and the shared units for itself
                        shares = {"latency": held} | {unit: 1 for unit in OF_CORES - {"latency"}}
                        alone += max(ms * shares.get(unit, 1 / memory["cores"]) for unit, ms in times.items())
                added = sum(cost["operations"] for cost in hardware.get("shading", NO_COSTS).values())
                work = [operations + added * invocations for operations, invocations
                        in zip(frame["bin_operations"], frame["bin_invocations"])]
                longer = on_busiest_core(work, memory["cores"])
                self.assertAlmostEqual(frame["bin_spread"]["busiest_core"], longer, delta=1e-9 * longer)
                core = max(*(ms for unit, ms in of_bins.items() if unit in OF_CORES), alone / held)
                on_cores = max(before.values()) + max(core * longer, *(ms for unit, ms in of_bins.items()
                                                                      if unit not in OF_CORES))
                at_once = max(before.get(unit, 0) + of_bins.get(unit, 0) for unit in before | of_bins)
                for key, expected in (("in_turn", in_turn), ("on_cores", on_cores), ("at_once", at_once)):
                    compared.append((f"{part} {result['technique']} {way} {key}", frame["modelled_ms"][way][key], expected))
        for name, found, expected in compared:
            self.assertAlmostEqual(found, expected, delta=1e-9 * expected, msg=name)
        for name, found, _ in random.Random(1).sample(compared, 10):
            print(f"{name}: {found:.6g} ms, computed again")


if __name__ == "__main__":
    BEAMPIPE, SOURCE = sys.argv.pop(1), sys.argv.pop(1)
    unittest.main()
