#!/usr/bin/env python3
"""Compares modelled times and their ratios with the paper's, for docs/accounting.md.

modelled_times.py DIR...   folders that `beampipe run TRACE -t beam:rules=paper beam:order=sorted msaa:32,128,256 -o DIR` wrote
"""
import json
import pathlib
import sys

PUBLISHED_MS = {"beam:rules=paper": 30.2, "msaa:32": 24.0, "msaa:128": 78.0, "msaa:256": 198.0}  # Titan V, classroom
BASE = "beam:rules=paper"
SUMS = ("sum", "overlap")


def main(folder):
    report = json.loads((folder / "report.json").read_text())
    times = {result["technique"]: result["frames"][0]["modelled_ms"] for result in report["results"]}
    implementations = list(next(iter(times.values())))
    print(f"\n{folder.name}:\n\n| technique | published ms | over beam | " +
          " | ".join(f"`{i}`, {s}: ms | over beam | error" for i in implementations for s in SUMS) + " |")
    print("|---" * (3 + 3 * len(implementations) * len(SUMS)) + "|")
    for technique, modelled in times.items():
        published = PUBLISHED_MS.get(technique)
        cells = [f"`{technique}`", f"{published}" if published else "",
                 f"{published / PUBLISHED_MS[BASE]:.2f}" if published else ""]
        for implementation in implementations:
            for sums in SUMS:
                ratio = modelled[implementation][sums] / times[BASE][implementation][sums]
                error = ratio * PUBLISHED_MS[BASE] / published - 1 if published else None
                cells += [f"{modelled[implementation][sums]:.2f}", f"{ratio:.2f}",
                          "" if error is None or technique == BASE else f"{100 * error:+.0f} %"]
        print("| " + " | ".join(cells) + " |")
    for sums in SUMS:
        shorter = [PUBLISHED_MS[t] / modelled[sums] for t in PUBLISHED_MS for modelled in times[t].values()]
        print(f"\nPublished over modelled, {sums}: {min(shorter):.0f} to {max(shorter):.0f}")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    for argument in sys.argv[1:]:
        main(pathlib.Path(argument))
