#!/usr/bin/env python3
"""Makes the tables of docs/accounting.md about modelled DRAM bytes per frame, and about the peaks of buffers.

dram_bytes.py BEAMPIPE TRACE...   the first frame of each trace, with block compression and without
dram_bytes.py BEAMPIPE --places TRACE...  the same with the pixels of a bin in memory and on chip
dram_bytes.py BEAMPIPE --stack    peak bytes of the buffers held for pixels, for a stack of 1 to 10,000 triangles that
                                  covers a 4 x 4 picture, and for the same stack from afar
"""
import json
import pathlib
import subprocess
import sys
import tempfile

TECHNIQUES = ["beam:order=sorted", "msaa:8", "msaa:32", "acaa:8"]
PER_TRIANGLE = ("setup_triangles", "bin_lists")
PLACED = ["beam", "msaa:8", "msaa:32", "beam:order=sorted", "beam:order=stream"]
PLACES = {"in-memory": "in memory", "on-chip": "on chip"}
GEOMETRY = ("vertex_setup", "sample_raster")  # write, bin and read the triangles of one pass
STACK = ["beam", "beam:order=stream", "beam:order=sorted", "casav", "msaa:8"]


def run(program, trace, techniques, *options):
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "run", trace, "--frames", "0", "-o", folder, "-t", *techniques, *options]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        report = json.loads((pathlib.Path(folder) / "report.json").read_text())
    return {result["technique"]: result["frames"][0] for result in report["results"]}


def dram_table(program, traces):
    print("| scene | geometry | " + " | ".join(f"`{t}`" for t in TECHNIQUES) + " | least | " +
          " | ".join(f"`{t}`, raw" for t in TECHNIQUES) + " |")
    print("|---" * (2 * len(TECHNIQUES) + 3) + "|")
    for trace in traces:
        cells = []
        for options in ([], ["--no-compression"]):
            frames = run(program, trace, TECHNIQUES, *options)
            cells.append([frames[t]["dram_bytes"] / 1e6 for t in TECHNIQUES])
        least = TECHNIQUES[cells[0].index(min(cells[0]))]
        numbers = [" | ".join(f"{value:.1f}" for value in row) for row in cells]
        one_pass = sum(stage["dram_bytes"] for stage in frames["msaa:8"]["stages"] if stage["stage"] in GEOMETRY) / 1e6
        print(f"| {pathlib.Path(trace).stem} | {one_pass:.1f} | {numbers[0]} | `{least}` | {numbers[1]} |", flush=True)


def places_table(program, traces):
    print("| scene | " + " | ".join(f"{title}: `{t}`" for title in PLACES.values() for t in PLACED) + " |")
    print("|---" * (len(PLACES) * len(PLACED) + 1) + "|")
    for trace in traces:
        cells = []
        for place in PLACES:
            frames = run(program, trace, PLACED, "--framebuffer", place)
            cells += [f"{frames[t]['dram_bytes'] / 1e6:.1f}" for t in PLACED]
        print(f"| {pathlib.Path(trace).stem} | " + " | ".join(cells) + " |", flush=True)


def stack_table(program, camera):
    print("| fragments per pixel | " + " | ".join(f"`{t}`" for t in STACK) + " |")
    print("|---" * (len(STACK) + 1) + "|")
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "stack.json"
        for layers in (1, 10, 100, 1000, 10000):
            subprocess.run([program, "make", "stack", "--triangles", str(layers), "--width", "4", "--height", "4",
                            "-o", path], check=True, stdout=subprocess.DEVNULL)
            trace = json.loads(path.read_text())
            trace["frames"][0]["camera"].update(camera)
            path.write_text(json.dumps(trace))
            frames = run(program, path, STACK)
            peaks = [sum(buffer["peak_bytes"] for buffer in frames[t]["buffers"] if buffer["name"] not in PER_TRIANGLE)
                     / 1024 for t in STACK]
            print(f"| {layers} | " + " | ".join(f"{peak:.1f}" for peak in peaks) + " |", flush=True)


if __name__ == "__main__":
    if len(sys.argv) == 3 and sys.argv[2] == "--stack":
        stack_table(sys.argv[1], {})
        print("\nFrom afar:\n")
        stack_table(sys.argv[1], {"eye": [0, 0, 300], "far": 400})
    elif len(sys.argv) > 3 and sys.argv[2] == "--places":
        places_table(sys.argv[1], sys.argv[3:])
    elif len(sys.argv) > 2:
        dram_table(sys.argv[1], sys.argv[2:])
    else:
        sys.exit(__doc__)
