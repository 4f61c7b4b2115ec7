#!/usr/bin/env python3
"""Runs the DRAM requests of frames through DRAMsim3 and Ramulator 2 and prints their times beside the model's.

  docs/dram_simulators.py PROGRAM --dramsim3 FOLDER --ramulator2 FOLDER -t SPEC... -- TRACE...

The folders are checkouts that have been built: DRAMsim3's build/dramsim3main and configs/, Ramulator 2's python/ with
its extension module, built for the Python that runs this script. docs/costs.md says how.

Both simulators take at most one request per clock from a file, which is what two of the 48 pseudo channels of the
modelled GPU need. So the requests are dealt to channels here, 256 bytes at a time, and each channel is simulated by
itself. The time of the frame is that of the slowest channel.
"""

import argparse
import configparser
import json
import pathlib
import subprocess
import sys
import tempfile

SECTOR = 32
INTERLEAVE = 256  # bytes in a row on one channel
EPOCH = 200  # cycles: how exactly the end is known from DRAMsim3's statistics

# Name, configuration, what it changes in it, nanoseconds per cycle, cycles that a burst of 32 bytes takes at least, and
# the number of channels whose rates together are closest to the model's 652.8 GB/s. Only what makes bursts of 32 bytes
# and channels of their width is changed, and HBM2's clock, which is that of a Titan V (850 MHz).
DRAMSIM3 = [
    ("HBM2", "HBM2_8Gb_x128.ini",
     {"dram_structure": {"device_width": "64", "columns": "128"}, "system": {"bus_width": "64", "channel_size": "512"},
      "timing": {"tCK": "1.17647"}}, 1.17647, 2, 48),
    ("GDDR5", "GDDR5_8Gb_x32.ini", {"system": {"bus_width": "32", "channel_size": "1024"}}, 0.667, 2, 27),
    ("GDDR6", "GDDR6_8Gb_x16.ini", {"system": {"bus_width": "16", "channel_size": "1024"}}, 0.66, 3, 40),
]
RAMULATOR_CHANNELS, RAMULATOR_NS, RAMULATOR_CYCLES = 24, 1.17647, 1  # of two pseudo channels each

# Rows of 1 KiB one after the other, or 128 bytes on each bank in turn.
RAMULATOR_MAPPERS = ["RoBaRaCoCh", "MOP4CLXOR"]


def deal(lines, channels):
    """The requests of each channel, as (address within the channel, access, nanosecond)."""
    dealt = [[] for _ in range(channels)]
    for address, access, nanosecond in lines:
        block, offset = divmod(address, INTERLEAVE)
        dealt[block % channels].append((block // channels * INTERLEAVE + offset, access, nanosecond))
    return dealt


def run_dramsim3(folder, work, memory, dealt):
    """Cycles of each channel, and row activations of all."""
    name, file, changes, tck, burst, _ = memory
    config = configparser.ConfigParser(inline_comment_prefixes=(";",), strict=False)
    config.optionxform = str
    text = (folder / "configs" / file).read_text()
    config.read_string(text)
    for section, values in changes.items():
        config[section].update(values)
    config["system"]["channels"] = "1"
    config["other"].update({"epoch_period": str(EPOCH), "output_level": "1"})
    with open(work / "memory.ini", "w") as out:
        config.write(out)
    cycles, activations = [], 0
    for requests in dealt:
        if not requests:
            cycles.append(0)
            continue
        (work / "requests").write_text(
            "".join(f"{address:#x} {access} {int(ns / tck)}\n" for address, access, ns in requests))
        most = int(requests[-1][2] / tck) + 4 * burst * len(requests) + 20000
        subprocess.run([folder / "build/dramsim3main", work / "memory.ini", "-c", str(most), "-t", work / "requests",
                        "-o", work], check=True, stdout=subprocess.DEVNULL)
        total = json.loads((work / "dramsim3.json").read_text())["0"]
        moved = total["num_reads_done"] + total["num_writes_done"]
        if not 0 <= moved - len(requests) <= 1:  # DRAMsim3 reads the last line of a file twice
            sys.exit(f"{name}: DRAMsim3 has served {moved} of {len(requests)} requests in {most} cycles")
        epochs = json.loads((work / "dramsim3epoch.json").read_text())
        last = max(epoch["epoch_num"] for epoch in epochs if epoch["num_reads_done"] + epoch["num_writes_done"] > 0)
        cycles.append(last * EPOCH)
        activations += total["num_act_cmds"]
    return cycles, activations


def run_ramulator2(work, mapper, dealt):
    """Cycles of each channel, and row misses and conflicts of all."""
    import ramulator
    cycles, activations = [], 0
    for requests in dealt:
        if not requests:
            cycles.append(0)
            continue
        (work / "requests").write_text(
            "".join(f"{'ST' if access == 'WRITE' else 'LD'} {address:#x}\n" for address, access, _ in requests))
        controller = ramulator.controller.HBM12(
            dram=ramulator.dram.HBM2(org_preset="HBM2_8Gb", timing_preset="HBM2_2000Mbps"),
            scheduler=ramulator.scheduler.FRFCFSRowHit(), refresh_manager=ramulator.refresh_manager.AllBank(),
            row_policy=ramulator.row_policy.Open(), addr_mapper=getattr(ramulator.addr_mapper, mapper)(),
            read_buffer_size=64, write_buffer_size=64)
        memory = ramulator.memory_system.GenericDRAM(
            clock_ratio=1, controllers=[controller],
            channel_mapper=ramulator.channel_mapper.CacheLineInterleave())
        frontend = ramulator.frontend.LoadStoreTrace(clock_ratio=4, path=str(work / "requests"))
        simulation = ramulator.Simulation(frontend, memory)
        simulation.run()
        stats = simulation.stats["memory_system"]["controller"]
        # It stops when the last request is in a queue: the rest is served at the rate so far.
        served = sum(stats[f"num_{kind}"] for kind in ("read_reqs_served", "write_reqs_served", "read_reqs_forwarded",
                                                       "write_reqs_coalesced"))
        cycles.append(round(stats["cycles"] * len(requests) / served))
        activations += stats["row_misses"] + stats["row_conflicts"]
    return cycles, activations


def turns(dealt):
    """How often a channel goes over from reads to writes or back."""
    return sum(a[1] != b[1] for requests in dealt for a, b in zip(requests, requests[1:]))


def row(scene, spec, simulator, cycles, ns, burst, dealt, activations, model_ms):
    requests = sum(map(len, dealt))
    bytes_moved = requests * SECTOR
    slowest, mean = max(cycles), sum(cycles) / len(cycles)
    ms = slowest * ns / 1e6
    busy = requests / len(cycles) * burst
    print(f"| {scene} | `{spec}` | {simulator} | {slowest:,} | {ms:.3f} | {bytes_moved / ms / 1e6:.0f} | "
          f"{busy / slowest * 100:.0f} % | {busy / mean * 100:.0f} % | {activations / requests * 100:.1f} % | "
          f"{turns(dealt) / requests * 100:.1f} % | {ms / model_ms:.2f} |", flush=True)


def print_streams(dramsim3):
    """The share of the peak that one channel of HBM2 reaches on a stream that turns every so many requests."""
    print("| requests between turns | DRAMsim3 |" + "".join(f" Ramulator 2, {m} |" for m in RAMULATOR_MAPPERS))
    print("|---|---|" + "---|" * len(RAMULATOR_MAPPERS))
    count, far = 1 << 15, 1 << 26
    for length in (count, 1024, 64, 32):
        requests = [(i * SECTOR + i // length % 2 * far, "WRITE" if i // length % 2 else "READ", 0)
                    for i in range(count)]
        with tempfile.TemporaryDirectory() as folder:
            work, memory = pathlib.Path(folder), DRAMSIM3[0]
            shares = [count * memory[4] / run_dramsim3(dramsim3, work, memory, [requests])[0][0]]
            shares += [count * RAMULATOR_CYCLES / run_ramulator2(work, mapper, [requests])[0][0]
                       for mapper in RAMULATOR_MAPPERS]
        name = "reads only" if length == count else length
        print(f"| {name} |" + "".join(f" {share * 100:.0f} % |" for share in shares), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--dramsim3", type=pathlib.Path, required=True)
    parser.add_argument("--ramulator2", type=pathlib.Path, required=True)
    parser.add_argument("-t", "--technique", nargs="+", default=[])
    parser.add_argument("--reads", action="store_true", help="take writes for reads, to see what turns cost")
    parser.add_argument("--streams", action="store_true", help="print what simple streams reach, and no frames")
    parser.add_argument("traces", nargs="*")
    arguments = parser.parse_args()
    sys.path.insert(0, str(arguments.ramulator2 / "python"))
    if arguments.streams:
        return print_streams(arguments.dramsim3)
    print("| scene | technique | memory | cycles | ms | GB/s | of peak | with equal channels | rows opened | turns | time over "
          "model's |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for trace in arguments.traces:
        for spec in arguments.technique:
            with tempfile.TemporaryDirectory() as folder:
                work = pathlib.Path(folder)
                subprocess.run([arguments.program, "run", trace, "-t", spec, "-o", work / "out", "--frames", "0",
                                "--memory-trace", work / "trace"], check=True, stderr=subprocess.DEVNULL,
                               stdout=subprocess.DEVNULL)
                report = json.loads((work / "out/report.json").read_text())
                rate = report["hardware"]["rates"]["dram_bytes_per_clk"] * report["hardware"]["clock_mhz"] / 1e3
                lines = []
                with open(work / "trace") as text:
                    for line in text:
                        address, access, nanosecond = line.split()
                        lines.append((int(address, 16), "READ" if arguments.reads else access, int(nanosecond)))
                bytes_moved = sum(stage["dram_bytes"] for stage in report["results"][0]["frames"][0]["stages"])
                if len(lines) * SECTOR != bytes_moved:
                    sys.exit(f"{trace}, {spec}: {len(lines)} requests are not the report's {bytes_moved} bytes")
                model_ms = bytes_moved / rate / 1e6
                scene = pathlib.Path(trace).stem
                print(f"| {scene} | `{spec}` | model | | {model_ms:.3f} | {rate:.0f} | 100 % | 100 % | | | 1.00 |",
                      flush=True)
                for memory in DRAMSIM3:
                    dealt = deal(lines, memory[5])
                    cycles, activations = run_dramsim3(arguments.dramsim3, work, memory, dealt)
                    row(scene, spec, "DRAMsim3, " + memory[0], cycles, memory[3], memory[4], dealt, activations,
                        model_ms)
                dealt = deal(lines, RAMULATOR_CHANNELS)
                for mapper in RAMULATOR_MAPPERS:
                    cycles, activations = run_ramulator2(work, mapper, dealt)
                    row(scene, spec, f"Ramulator 2, HBM2, {mapper}", cycles, RAMULATOR_NS, RAMULATOR_CYCLES, dealt,
                        activations, model_ms)


if __name__ == "__main__":
    main()
