#!/usr/bin/env python3
"""Measures the frame times of docs/performance.md.

usage: docs/performance.py ratios  PROGRAM [--runs N] [--threads N] TRACE...
       docs/performance.py threads PROGRAM [--runs N] TRACE...
       docs/performance.py items PROGRAM [--runs N] [--peak N] TRACE...
       docs/performance.py memory PROGRAM [--runs N] TRACE...
       docs/performance.py textures PROGRAM [--runs N] TRACE...
       docs/performance.py peers PROGRAM FOLDER [--runs N] TRACE...
       docs/performance.py growth PROGRAM PLOT.svg

PROGRAM is for instance build/release/tools/beampipe. Techniques take turns in one process, so that other work of the
machine affects all of them alike. A time is the least of the runs, in `growth` their median, with the memory model off.
`growth` makes its own traces, and draws the plot with gnuplot. `items` prints nanoseconds per item of each stage of
`beam`, on one thread; with --peak, also what the operations that the stage is charged take at N operations per
nanosecond (operations_per_ns of vector_peak in build/release/bench/kernels_benchmark). `memory` prints what modelling
memory costs: a frame's time with the model ÷ that without. `textures` prints what materials cost: a frame's time ÷ that
of the same frame with one flat colour for each draw. `peers` compares with other renderers, which FOLDER has: peer_gl
(llvmpipe) and, if it is there, peer_embree draw the triangles of `beampipe export-soup` and print JSON with the least
time of a frame, "ms_frame_min".
"""
import argparse
import contextlib
import json
import os
import statistics
import subprocess
import sys
import tempfile

import measure

RATIOS = ["beam", "beam:order=sorted", "beam:order=stream", "msaa:4", "msaa:8", "msaa:32", "msaa:256"]


def frame_times(program, trace, specs, runs, threads):
    """(median, least, most) milliseconds of frame 0, by technique."""
    with tempfile.TemporaryDirectory() as folder:
        found = measure.results(program, "run", trace, specs, folder, "--repeat", str(runs), "--threads", str(threads),
                                "--no-memory-model")
        times = {spec: result["frames"][0]["wall_ms"] for spec, result in found.items()}
        return {spec: (time["median"], time["min"], time["max"]) for spec, time in times.items()}


@contextlib.contextmanager
def changed_trace(trace, change):
    """A copy beside the trace, because traces name their files relative to their own place. change(json) changes it."""
    with open(trace, encoding="utf-8") as file:
        copy = json.load(file)
    change(copy)
    path = os.path.join(os.path.dirname(os.path.abspath(trace)), f".{os.getpid()}.json")
    try:
        with open(path, "w", encoding="utf-8") as file:
            json.dump(copy, file)
        yield path
    finally:
        os.remove(path)


def equivalent_rate(program, trace):
    """EMR of `beam` on the same scene at 320 x 180."""
    def make_small(copy):
        for frame in copy["frames"]:
            frame["width"], frame["height"] = 320, 180

    with changed_trace(trace, make_small) as small, tempfile.TemporaryDirectory() as folder:
        result = measure.results(program, "compare", small, RATIOS[:1], folder, "--no-memory-model")[RATIOS[0]]
        if "equivalent_msaa" not in result:
            return "does not converge"
        rate = f"{result['equivalent_msaa']:.0f}"
        return "≥ " + rate if result.get("equivalent_msaa_is_lower_bound") else rate


def print_ratios(arguments):
    measure.print_head("scene", f"`{RATIOS[0]}` ms", "spread", *(f"`{spec}`" for spec in RATIOS[1:]), "EMR")
    for trace in arguments.traces:
        times = frame_times(arguments.program, trace, RATIOS, arguments.runs, arguments.threads)
        _, least, most = times[RATIOS[0]]
        others = [f"{times[spec][1] / least:.2f}" for spec in RATIOS[1:]]
        measure.print_row(name_of(trace), f"{least:.0f}", f"{least:.0f} to {most:.0f}", *others,
                          equivalent_rate(arguments.program, trace))
        sys.stdout.flush()


def print_threads(arguments):
    specs = ["beam", "msaa:8", "msaa:256"]
    measure.print_head("scene", *(f"`{spec}`" for spec in specs))
    for trace in arguments.traces:
        rounds = {spec: [] for spec in specs}
        for _ in range(arguments.runs):  # in turn
            one, two = (frame_times(arguments.program, trace, specs, 3, threads) for threads in (1, 2))
            for spec in specs:
                rounds[spec].append(one[spec][1] / two[spec][1])
        measure.print_row(name_of(trace), *(f"{statistics.median(rounds[spec]):.2f}" for spec in specs))
        sys.stdout.flush()


def stage_times(program, trace, folder):
    """Milliseconds, items and operations of each stage of `beam`, in the order of the pipeline."""
    events = f"{folder}/events.json"
    result = measure.results(program, "run", trace, ["beam"], f"{folder}/out", "--trace-events", events, "--repeat", "3",
                             "--threads", "1", "--no-memory-model")["beam"]
    spans = {}
    with open(events, encoding="utf-8") as file:
        for event in json.load(file)["traceEvents"]:
            if event.get("ph") == "X":
                spans.setdefault(event["name"], []).append(event["dur"])
    frames = len(spans["vertex_setup"])
    return {name: (sum(spans[name]) / frames / 1000, max(stage["items_in"], stage["items_out"]), stage["ops"]["total"])
            for name, stage in measure.stages(result).items() if name in spans}


def print_items(arguments):
    measure.print_head("stage", *(f"{name_of(trace)} ns" for trace in arguments.traces), "ms of a frame", "items")
    found = []
    for trace in arguments.traces:
        runs = []
        for _ in range(arguments.runs):
            with tempfile.TemporaryDirectory() as folder:
                runs.append(stage_times(arguments.program, trace, folder))
        found.append({stage: (min(run[stage][0] for run in runs), *runs[0][stage][1:]) for stage in runs[0]})

    def per_item(ms, items, operations):
        limit = f" ({operations / max(items, 1) / arguments.peak:.1f})" if arguments.peak else ""
        return f"{1e6 * ms / max(items, 1):.1f}{limit}"

    for stage in found[0]:
        measure.print_row(f"`{stage}`", *(per_item(*of_trace[stage]) for of_trace in found),
                          ", ".join(f"{of_trace[stage][0]:.1f}" for of_trace in found),
                          ", ".join(str(of_trace[stage][1]) for of_trace in found))


def print_memory(arguments):
    specs = ["beam", "msaa:8"]
    measure.print_head("scene", *(f"`{spec}`" for spec in specs))
    for trace in arguments.traces:
        least = {}
        for _ in range(arguments.runs):
            for options in ((), ("--no-memory-model",)):
                with tempfile.TemporaryDirectory() as folder:
                    found = measure.results(arguments.program, "run", trace, specs, folder, "--threads", "1", *options)
                for spec in specs:
                    time = found[spec]["frames"][0]["wall_ms"]["min"]
                    least[spec, options] = min(least.get((spec, options), time), time)
        measure.print_row(name_of(trace), *(f"{least[spec, ()] / least[spec, ('--no-memory-model',)]:.2f}"
                                            for spec in specs))
        sys.stdout.flush()


def print_textures(arguments):
    def make_flat(copy):
        for frame in copy["frames"]:
            for draw in frame["draws"]:
                draw["kd"] = [0.5, 0.5, 0.5]

    specs = ["beam", "msaa:8"]
    measure.print_head("scene", *(column for spec in specs for column in (f"`{spec}` ms", "flat ms", "ratio")))
    for trace in arguments.traces:
        least = {}
        with changed_trace(trace, make_flat) as flat:
            for _ in range(arguments.runs):  # in turn
                for path in (trace, flat):
                    for spec, times in frame_times(arguments.program, path, specs, 1, 1).items():
                        least[path, spec] = min(least.get((path, spec), times[1]), times[1])
            cells = [f"{least[path, spec]:.0f}" if path else f"{least[trace, spec] / least[flat, spec]:.2f}"
                     for spec in specs for path in (trace, flat, None)]
        measure.print_row(name_of(trace), *cells)
        sys.stdout.flush()


def peer_time(peer, soup, samples):
    """Least milliseconds of a frame, or None if there is no such program."""
    if not os.path.exists(peer):
        return None
    answer = subprocess.run([peer, soup, f"{soup}.pfm", "--samples", str(samples), "--threads", "1", "--runs", "3"],
                            check=True, stdout=subprocess.PIPE, text=True)
    return json.loads(answer.stdout)["ms_frame_min"]


def print_peers(arguments):
    specs = ["beam", "msaa:4", "msaa:256"]
    peers = [("peer_gl", 8, "beam"), ("peer_gl", 64, "beam"), ("peer_gl", 256, "beam"), ("peer_embree", 256, "beam"),
             ("peer_gl", 4, "msaa:4"), ("peer_gl", 256, "msaa:256")]
    names = {"peer_gl": "llvmpipe", "peer_embree": "Embree"}
    measure.print_head("scene", "`beam` ms", *(f"{names[peer]} {samples} ÷ `{spec}`" for peer, samples, spec in peers))
    for trace in arguments.traces:
        least = {}
        with tempfile.TemporaryDirectory() as folder:
            soup = f"{folder}/frame.soup"
            subprocess.run([arguments.program, "export-soup", trace, "-o", soup], check=True, stdout=subprocess.DEVNULL)
            for _ in range(arguments.runs):  # in turn
                found = {spec: times[1] for spec, times in frame_times(arguments.program, trace, specs, 3, 1).items()}
                for peer, samples in dict.fromkeys(peer[:2] for peer in peers):
                    found[peer, samples] = peer_time(os.path.join(arguments.peers, peer), soup, samples)
                for what, time in found.items():
                    least[what] = min(least.get(what, time), time) if time else None
        cells = [f"{least[peer, samples] / least[spec]:.2f}" if least[peer, samples] else ""
                 for peer, samples, spec in peers]
        measure.print_row(name_of(trace), f"{least['beam']:.0f}", *cells)
        sys.stdout.flush()


def name_of(trace):
    return os.path.basename(trace).removesuffix(".json")


# ---- Growth ----

GROWTH = {
    "triangles": [("sphere", ["--triangles", str(n), "--width", "1280", "--height", "720", "--binary"], n)
                  for n in (1000, 10_000, 100_000, 1_000_000, 10_000_000)],
    "pixels": [("hairball", ["--triangles", "100000", "--width", str(16 * h // 9), "--height", str(h)], 16 * h * h // 9)
               for h in (180, 360, 720, 1440, 2160, 4320)],
    "opaque layers per pixel": [("stack", ["--triangles", str(n), "--width", "64", "--height", "36"], n)
                                for n in (1, 10, 100, 1000, 10_000)],
}
GROWTH["translucent layers per pixel"] = GROWTH["opaque layers per pixel"]
GROWING = ["beam", "beam:order=stream", "msaa:8", "msaa:32"]
STREAMED = 1 << 23  # pixels, at most, whose chunks beam:order=stream can number


def peak_memory(program, trace, spec, folder):
    """Peak MiB of the whole process, including the trace."""
    code = ("import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL); "
            "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss // 1024)")
    answer = subprocess.run([sys.executable, "-c", code, program, "run", trace, "-t", spec, "--threads", "1",
                             "--no-memory-model", "--force", "-o", folder], check=True, stdout=subprocess.PIPE,
                            text=True)
    return int(answer.stdout)


def make_translucent(copy):
    """Gives all triangles one material that hides a thousandth of what is behind it."""
    copy["beampipe_trace"] = 2
    copy["materials"] = {"film": {"base_color": [0.5, 0.4, 0.3, 0.001], "alpha_mode": "blend", "double_sided": True,
                                  "unlit": True}}
    for mesh in copy["meshes"].values():
        mesh["materials"] = ["film"]
    for frame in copy["frames"]:
        del frame["light"]
        for draw in frame["draws"]:
            del draw["shading"]


def print_growth(arguments):
    data = {}
    with tempfile.TemporaryDirectory() as folder:
        for axis, rows in GROWTH.items():
            print("\nms, and MiB of the process\n")
            measure.print_head(axis, *(f"`{spec}`" for spec in GROWING))
            data[axis] = []
            for scene, options, value in rows:
                trace = measure.make(arguments.program, scene, f"{folder}/{scene}.json", *options)
                change = make_translucent if axis.startswith("translucent") else lambda copy: None
                specs = [spec for spec in GROWING if axis != "pixels" or value <= STREAMED or "stream" not in spec]
                with changed_trace(trace, change) as drawn:
                    times = frame_times(arguments.program, drawn, specs, 3, 1)
                    memory = {spec: peak_memory(arguments.program, drawn, spec, folder) for spec in specs}
                measure.print_row(value, *(f"{times[spec][0]:.1f}, {memory[spec]}" if spec in times else ""
                                           for spec in GROWING))
                sys.stdout.flush()
                data[axis].append((value, *(times[spec][0] if spec in times else "NaN" for spec in GROWING)))
    draw(data, arguments.plot)


def draw(data, plot):
    script = [f"set terminal svg size 1200,840 font 'sans,12'; set output '{plot}'",
              "set multiplot layout 2,2; set logscale xy; set grid; set key left top; set ylabel 'ms'",
              "set format x '10^{%L}'; set format y '10^{%L}'"]
    for index, (axis, rows) in enumerate(data.items()):
        block = f"$data{index}"
        script += [f"{block} << EOD", *(" ".join(map(str, row)) for row in rows), "EOD", f"set xlabel '{axis}'"]
        lines = [f"{block} using 1:{i + 2} with linespoints title '{spec}'" for i, spec in enumerate(GROWING)]
        script.append("plot " + ", ".join(lines))
    subprocess.run(["gnuplot"], input="\n".join(script) + "\n", text=True, check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    for name, action in (("ratios", print_ratios), ("threads", print_threads), ("items", print_items),
                         ("memory", print_memory), ("textures", print_textures), ("peers", print_peers)):
        command = commands.add_parser(name)
        command.add_argument("program")
        if name == "peers":
            command.add_argument("peers", metavar="folder")
        command.add_argument("traces", nargs="+")
        command.add_argument("--runs", type=int, default=5)
        if name == "ratios":
            command.add_argument("--threads", type=int, default=1)
        if name == "items":
            command.add_argument("--peak", type=float, metavar="N")
        command.set_defaults(action=action)
    growth = commands.add_parser("growth")
    growth.add_argument("program")
    growth.add_argument("plot")
    growth.set_defaults(action=print_growth)
    arguments = parser.parse_args()
    arguments.action(arguments)


if __name__ == "__main__":
    main()
