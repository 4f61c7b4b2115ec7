#!/usr/bin/env python3
"""Modelled times on several parts, side by side, and their ratios beside the paper's, for docs/costs.md.

modelled_times.py PROGRAM [--hardware A,B,...] DIR...
    folders that `beampipe run TRACE -t beam:rules=paper ... msaa:32,128,256 ... -o DIR` wrote
"""
import argparse
import json
import subprocess

PUBLISHED_MS = {"beam:rules=paper": 30.2, "msaa:32": 24.0, "msaa:128": 78.0, "msaa:256": 198.0}  # Titan V, classroom
BASE = "beam:rules=paper"


COSTS = (0, 100, 300, 1000, 3000, 10000)  # operations per invocation
BEAM, MSAA = ("beam:bin=16",), ("msaa:8", "msaa:8,prepass", "msaa:32")


def model(program, hardware, folders, cost=0):
    text = subprocess.run([program, "model", *folders, "--json", "--hardware", hardware, "--material-cost", str(cost)],
                          check=True, capture_output=True, text=True).stdout
    return json.loads(text)


def beam_over_msaa(program, hardware, folders):
    """The ratio of times where each invocation of a fragment shader costs so much beside the trace's materials."""
    by_cost = {cost: model(program, hardware, folders, cost) for cost in COSTS}
    for k, folder in enumerate(folders):
        sums = {cost: {(time["technique"], time["implementation"]): time["sum"] for time in found[k]["times"]}
                for cost, found in by_cost.items()}
        names = list(dict.fromkeys(name for _, name in sums[0]))
        print(f"\n{folder}: time over that of MSAA, by operations per invocation:\n")
        print("| ratio | part | " + " | ".join(map(str, COSTS)) + " |\n" + "|---" * (2 + len(COSTS)) + "|")
        for beam in BEAM:
            for msaa in MSAA:
                if (beam, names[0]) in sums[0] and (msaa, names[0]) in sums[0]:
                    for name in names:
                        cells = [f"{sums[cost][beam, name] / sums[cost][msaa, name]:.2f}" for cost in COSTS]
                        print(f"| `{beam}` / `{msaa}` | `{name}` | " + " | ".join(cells) + " |")


def main(program, hardware, folders):
    for found in model(program, hardware, folders):
        times = {}
        for time in found["times"]:
            times.setdefault(time["technique"], {})[time["implementation"]] = time
        names = list(next(iter(times.values())))
        print(f"\n{found['folder']}, ms, one stage after the other (and the busiest unit if all run at once):\n")
        print("| technique | " + " | ".join(f"`{name}`" for name in names) + " |")
        print("|---" * (1 + len(names)) + "|")
        for technique, of in times.items():
            cells = [f"{of[name]['sum']:.3f} ({of[name]['busiest']})" for name in names]
            print(f"| `{technique}` | " + " | ".join(cells) + " |")
        if BASE not in times:
            continue
        print(f"\nOver `{BASE}`, and the error of that ratio where the paper has one:\n")
        print("| technique | paper | " + " | ".join(f"`{name}`" for name in names) + " |")
        print("|---" * (2 + len(names)) + "|")
        for technique, of in times.items():
            published = PUBLISHED_MS.get(technique, 0) / PUBLISHED_MS[BASE]
            cells = []
            for name in names:
                ratio = of[name]["sum"] / times[BASE][name]["sum"]
                error = f" ({100 * (ratio / published - 1):+.0f} %)" if published and technique != BASE else ""
                cells.append(f"{ratio:.2f}{error}")
            print(f"| `{technique}` | {f'{published:.2f}' if published else ''} | " + " | ".join(cells) + " |")
    beam_over_msaa(program, hardware, folders)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--hardware", default="titan_v")
    parser.add_argument("folders", nargs="+")
    main(**vars(parser.parse_args()))
