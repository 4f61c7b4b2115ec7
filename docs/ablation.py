#!/usr/bin/env python3
"""Makes the ablation tables of docs/accuracy.md: how each choice that the published rules leave open affects accuracy.

usage: docs/ablation.py PROGRAM [TRACE...]

PROGRAM is for instance build/release/tools/beampipe. The script makes the nine procedural scenes, and measures them and
the given traces. It prints the equivalent MSAA rate of the published rules with one policy changed at a time.
"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile

SCENES = ["hairball", "classroom", "boat", "pickets", "terrain", "sphere", "fence", "soup", "foliage"]
POLICIES = ["", "mask=exact", "sort=nearest", "tiny=3", "overlap=over", "overlap=add", "overlap=transition",
            "regional=area", "local=keep", "fuzzy=mix", "extents=slab", "slab=visible", "plane=visible", "thickness=containing",
            "tiny=3,overlap=transition",
            "mask=exact,local=keep,fuzzy=mix,slab=visible,plane=visible"]


def rates(program, trace, folder):
    """Results by policy."""
    specs = {",".join(filter(None, ["beam:rules=paper", policy])): policy for policy in POLICIES}
    subprocess.run([program, "compare", trace, "-t", *specs, "-o", folder], check=True, stdout=subprocess.DEVNULL)
    with open(f"{folder}/report.json", encoding="utf-8") as file:
        report = json.load(file)
    return {specs[r["technique"]]: r for r in report["results"] if r["technique"] in specs}


def text(result):
    return ("< " if result.get("equivalent_msaa_is_upper_bound") else "") + f"{result['equivalent_msaa']:.3g}"


def mean(results):
    return f"{math.exp(sum(math.log(r['equivalent_msaa']) for r in results) / len(results)):.3g}"


def print_table(names, found, means):
    print("| policy | " + " | ".join(names) + " | " + " | ".join(title for title, _ in means) + " |")
    print("|---" * (len(names) + len(means) + 1) + "|")
    for policy in POLICIES:
        cells = [text(found[name][policy]) for name in names]
        cells += [mean([found[name][policy] for name in over]) for _, over in means]
        print(f"| {f'`{policy}`' if policy else 'as published'} | " + " | ".join(cells) + " |")
    print()


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__.strip())
    program, traces, found = sys.argv[1], sys.argv[2:], {}
    with tempfile.TemporaryDirectory() as folder:
        for scene in SCENES:
            trace = f"{folder}/{scene}.json"
            subprocess.run([program, "make", scene, "-o", trace], check=True, stdout=subprocess.DEVNULL)
            found[scene] = rates(program, trace, f"{folder}/out")
        for trace in traces:
            found[pathlib.Path(trace).stem] = rates(program, trace, f"{folder}/out")
    models = [name for name in found if name not in SCENES]
    print_table(SCENES, found, [("geometric mean", SCENES)])
    if models:
        print_table(models, found, [("geometric mean", models), (f"of all {len(found)}", list(found))])


main()
