#!/usr/bin/env python3
"""Compares the frame times of two builds: bench/compare.py OLD NEW TRACE... [-t SPEC...] [--rounds N]

OLD and NEW are programs, such as build/release/tools/beampipe of two checkouts. They take turns, so that other work of
the machine affects both alike, and each time is the least of its rounds. Prints milliseconds, the ratio NEW / OLD with
the least and the greatest ratio of single rounds, and whether pictures and counters are the same. Exits with 1 if they
are not.
"""
import argparse
import hashlib
import json
import pathlib
import subprocess
import sys
import tempfile


def measure(program, trace, specs):
    """By spec: milliseconds of the first frame, and a digest of its picture and counters."""
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "run", trace, "-t", *specs, "--frames", "0", "--threads", "1", "--no-memory-model",
                   "--repeat", "3", "--allow-outside", "-o", folder]
        finished = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        if finished.returncode:
            sys.exit(f"{program}: {finished.stderr.strip()}")
        found = {}
        for result in json.loads((pathlib.Path(folder) / "report.json").read_text())["results"]:
            frame = result["frames"][0]
            counters = [{key: value for key, value in stage.items() if "ms" not in key} for stage in frame["stages"]]
            picture = (pathlib.Path(folder) / frame["picture"]).read_bytes()
            digest = hashlib.sha256(picture + json.dumps(counters).encode()).hexdigest()
            found[result["technique"]] = frame["wall_ms"]["min"], digest
        return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("traces", nargs="+", metavar="TRACE")
    parser.add_argument("-t", "--technique", nargs="+", default=["beam", "msaa:8"], dest="specs")
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    same = True
    print("| trace | technique | old ms | new ms | new / old | of single rounds | pictures and counters |")
    print("|---" * 7 + "|")
    for trace in options.traces:
        rounds = [(measure(options.old, trace, options.specs), measure(options.new, trace, options.specs))
                  for _ in range(options.rounds)]
        for spec in options.specs:
            old, new = ([each[side][spec][0] for each in rounds] for side in (0, 1))
            single = sorted(b / a for a, b in zip(old, new))
            equal = rounds[0][0][spec][1] == rounds[0][1][spec][1]
            same = same and equal
            print(f"| {pathlib.Path(trace).stem} | `{spec}` | {min(old):.1f} | {min(new):.1f} | {min(new) / min(old):.3f} | "
                  f"{single[0]:.3f} to {single[-1]:.3f} | {'the same' if equal else 'DIFFERENT'} |", flush=True)
    sys.exit(0 if same else 1)


if __name__ == "__main__":
    main()
