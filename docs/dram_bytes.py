#!/usr/bin/env python3
"""Makes the tables of docs/costs.md about modelled DRAM bytes per frame, and about the peaks of buffers.

dram_bytes.py BEAMPIPE --places TRACE...  the first frame of each trace, with the pixels of a bin on chip and in memory
dram_bytes.py BEAMPIPE --stack    peak bytes of the buffers held for pixels, for a stack of 1 to 10,000 triangles of which
                                  each covers parts of four pixels of a 4 x 4 picture
"""
import json
import pathlib
import subprocess
import sys
import tempfile

PER_TRIANGLE = ("setup_triangles", "bin_lists")
PLACED = {"on-chip": ["beam", "msaa:8"], "in-memory": ["beam", "msaa:8", "msaa:32", "beam:order=sorted"]}
TITLES = {"on-chip": "on chip", "in-memory": "in memory"}
FAR = {"eye": [0, 0, 300], "far": 400}  # from where a triangle of the stack is smaller than a pixel
STACK = ["beam", "beam:order=stream", "beam:order=sorted", "casav", "msaa:8"]


def run(program, trace, techniques, *options):
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "run", trace, "--frames", "0", "-o", folder, "-t", *techniques, *options]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        report = json.loads((pathlib.Path(folder) / "report.json").read_text())
    return {result["technique"]: result["frames"][0] for result in report["results"]}


def places_table(program, traces):
    print("| scene | " + " | ".join(f"{TITLES[place]}: `{t}`" for place, specs in PLACED.items() for t in specs) + " |")
    print("|---" * (sum(map(len, PLACED.values())) + 1) + "|")
    for trace in traces:
        cells = []
        for place, specs in PLACED.items():
            frames = run(program, trace, specs, "--framebuffer", place)
            cells += [f"{frames[t]['dram_bytes'] / 1e6:.1f}" for t in specs]
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
        stack_table(sys.argv[1], FAR)
    elif len(sys.argv) > 3 and sys.argv[2] == "--places":
        places_table(sys.argv[1], sys.argv[3:])
    else:
        sys.exit(__doc__)
