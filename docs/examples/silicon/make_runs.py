#!/usr/bin/env python3
"""Makes the runs that a file of measured numbers names, PART/SCENE of those below, and copies it to them.

usage: make_runs.py BEAMPIPE MEASURED.csv -o FOLDER

The parts are described as changes of the built-in Titan V class: its implementations and choices of units that no
measurement here uses.
"""
import argparse
import concurrent.futures
import csv
import json
import os
import pathlib
import subprocess

TITAN_V = pathlib.Path(__file__).resolve().parents[3] / "tools/evaluate/hardware/titan_v.json"

FERMI_EXPORT = ("SMs x 8 bytes: each hands on 2 pixels of 32 bits per clock (NVIDIA on GF100, quoted by PC Games "
                "Hardware, Some gory guts of Geforce GTX 470/480 explained; TechPowerUp, Pixel fillrate and Fermi); "
                "choice: half as many of 64 bits")
KEPLER_EXPORT = "choice: 8 SMX x 4 pixels of 32 bits, as many as the 32 ROPs take"
BEHARDWARE = "BeHardware, article 795: GF104 in blocks of each SM, which run at twice the clock"
KANTER = "David Kanter, Tile-based rasterization in Nvidia GPUs (Real World Tech, 2016): from Maxwell on"
FERMI_THREADS = (1536, 32768, 11), "CUDA C Programming Guide, compute capability 2.x; 22 clocks of lanes at twice the clock"
KEPLER_THREADS = (2048, 65536, 11), "CUDA C Programming Guide, compute capability 3.x"
ROP = "x 16/3 depth samples: the 48 of GF100 write 256 that compress (NVIDIA, quoted by PC Games Hardware)"


def part(name, mhz, sms, sm, of_threads, rops, export, rasters, gb_per_s, l2_kib, sources):
    """A description. sm: lanes of an SM per clock of the rest: float, load and store, special functions, texture units;
    of_threads: an SM's threads and registers and the clocks of an operation, and where these are from; rasters: units
    that set up a triangle and find 8 pixels each per clock."""
    lanes, loads, special, textures = sm
    (threads, registers, operation), thread_source = of_threads
    rates = {
        "triangles_per_clk": rasters, "raster_pixels_per_clk": 8 * rasters,
        "conservative_pixels_per_clk": 8 * rasters, "quads_per_clk": 2 * rasters, "export_bytes_per_clk": export,
        "core_issue_per_clk": lanes, "core_mul_add_per_clk": lanes, "core_add_per_clk": lanes,
        "core_bit_per_clk": lanes / 2, "core_wide_per_clk": lanes / 4, "core_fetch_per_clk": loads,
        "core_special_per_clk": special, "core_convert_per_clk": special, "core_texture_bytes_per_clk": 16 * textures,
        "core_threads": threads, "core_registers": registers, "operation_clocks": operation,
        "rop_samples_per_clk": round(rops * 16 / 3),
        "rop_fragments_per_clk": rops, "rop_bytes_per_clk": round(rops * 16 / 3) * 4,
        "core_on_chip_bytes_per_clk": 128, "l2_bytes_per_clk": 32 * rops / 2,
        "dram_bytes_per_clk": round(gb_per_s * 1e3 / mhz, 1)}
    hardware = json.loads(TITAN_V.read_text())
    hardware |= {"name": name, "clock_mhz": mhz}
    hardware.pop("energy")
    hardware["memory_system"] = {
        "parameters": {"l2_bytes": l2_kib * 1024, "l2_ways": 16, "cores": sms, "binned": False},
        "sources": {"l2_bytes": sources["l2"], "l2_ways": "choice", "cores": sources["sms"], "binned": KANTER}}
    sourced = ("export_bytes_per_clk", "raster_pixels_per_clk")
    hardware["ranges"] = {rate: [rates.get(rate, was) * end / was for end in ends]
                          for rate, ends in hardware["ranges"].items() if rate not in sourced
                          for was in [hardware["rates"][rate]]}
    hardware["rates"] |= rates
    hardware["sources"] |= {
        "clock_mhz": sources["sms"], "triangles_per_clk": "one in each raster engine (GF100 whitepaper)",
        "raster_pixels_per_clk": "8 in each raster engine (GF100 whitepaper)",
        "export_bytes_per_clk": sources["export"], "rop_samples_per_clk": f"{rops} ROPs {ROP}",
        "rop_fragments_per_clk": f"{rops} ROPs; choice: one blended pixel each",
        "l2_bytes_per_clk": "choice: 64 bytes for 4 ROPs", "dram_bytes_per_clk": sources["sms"]}
    for rate in ("issue", "mul_add", "add", "fetch", "special"):
        hardware["sources"][f"core_{rate}_per_clk"] = sources["lanes"]
    for rate in ("bit", "wide", "convert"):
        hardware["sources"][f"core_{rate}_per_clk"] = "choice: half of the float lanes, a quarter, and the special functions"
    for rate in ("core_threads", "core_registers", "operation_clocks"):
        hardware["sources"][rate] = thread_source
    for rate in ("fetch_clocks", "l2_clocks", "dram_clocks"):
        hardware["sources"][rate] = "choice: as titan_v"
    hardware["sources"]["core_texture_bytes_per_clk"] = "texture units x 16 bytes, a bilinear probe"
    hardware["sources"]["core_on_chip_bytes_per_clk"] = "choice: 128 bytes in each SM"
    return hardware


PARTS = {
    "gtx_460": part("GeForce GTX 460, 768 MB", 675, 7, (96, 32, 16, 8), FERMI_THREADS, 24, 7 * 8, 2, 86.4, 384, {
        "sms": "TechSpot, review 299: 7 SMs, 24 ROPs, 675 MHz, 86.4 GB/s", "l2": "384 KB (iXBT Labs, gf104-p2)",
        "lanes": BEHARDWARE, "export": FERMI_EXPORT}),
    "gtx_580": part("GeForce GTX 580", 772, 16, (64, 32, 8, 4), FERMI_THREADS, 48, 16 * 8, 4, 192.4, 768, {
        "sms": "Guru3D, GTX 680 review: 16 SMs, 48 ROPs, 772 MHz, 192 GB/s", "l2": "768 KB (in4.pl, GTX 680)",
        "lanes": "as GF100: BeHardware, article 795", "export": FERMI_EXPORT}),
    "gtx_680": part("GeForce GTX 680", 1006, 8, (192, 32, 32, 16), KEPLER_THREADS, 32, 8 * 16, 4, 192.3, 512, {
        "sms": "Guru3D, GTX 680 review: 8 SMX, 32 ROPs, 1006 MHz, 192.3 GB/s", "l2": "512 KB (in4.pl, GTX 680)",
        "lanes": "192 lanes in each SMX (Guru3D); load, store and special functions: choice, 32 each",
        "export": KEPLER_EXPORT}),
}


def trace(width, height, cell, layers, opacity):
    """Layers over the whole picture, the farthest first, each a grid of cells of so many pixels, in two triangles."""
    columns, rows = -(-width // cell), -(-height // cell)
    positions, indices = [], []
    for row in range(rows + 1):
        for column in range(columns + 1):
            positions += [2 * min(column * cell, width) / width - 1, 1 - 2 * min(row * cell, height) / height, 0]
    for row in range(rows):
        for column in range(columns):
            a = row * (columns + 1) + column
            indices += [a, a + columns + 1, a + 1, a + 1, a + columns + 1, a + columns + 2]
    layer = {"positions": positions, "indices": indices}
    made = {"beampipe_trace": 2, "meshes": {"layer": layer}}
    if opacity < 1:
        glass = {"base_color": [0.5, 0.5, 0.5, opacity], "alpha_mode": "blend", "unlit": True, "double_sided": True}
        made["materials"] = {"glass": glass}
        layer["materials"] = ["glass"]
    identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
    depths = [0.9 - 1.8 * i / layers for i in range(layers)]
    draws = [{"mesh": "layer", "transform": identity[:14] + [depth, 1]} for depth in depths]
    made["frames"] = [{"width": width, "height": height, "view": identity, "projection": identity, "draws": draws}]
    return made


FILL = {"fill": trace(1920, 1080, 2048, 16, 1), "blend": trace(1920, 1080, 2048, 16, 0.5)}
TILES = {f"tiles_{cell}": trace(1920, 1080, cell, 1, 1) for cell in (1, 128)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("measured", type=pathlib.Path)
    parser.add_argument("-o", dest="folder", type=pathlib.Path, required=True)
    options = parser.parse_args()
    folder = options.folder
    folder.mkdir(parents=True, exist_ok=True)
    for name, hardware in PARTS.items():
        (folder / f"{name}.json").write_text(json.dumps(hardware, indent=1))
    for name, made in (FILL | TILES).items():
        (folder / f"{name}.json").write_text(json.dumps(made))
    with open(options.measured, newline="") as file:
        rows = list(csv.DictReader(file))
    runs = {}
    for row in rows:
        runs.setdefault(row["folder"], set()).add(row["technique"])
        if row["over_technique"]:
            runs.setdefault(row["over_folder"] or row["folder"], set()).add(row["over_technique"])

    def draw(run):
        hardware, scene = run.split("/")
        subprocess.run([options.program, "run", folder / f"{scene}.json", "-t", *sorted(runs[run]), "--hardware",
                        folder / f"{hardware}.json", "-o", folder / run, "--force"], check=True)

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:  # without bins a run has one thread
        list(pool.map(draw, runs))
    (folder / "measured.csv").write_text(options.measured.read_text())


if __name__ == "__main__":
    main()
