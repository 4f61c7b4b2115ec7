# %% [markdown]
# # What does a technique's error cost?
# Cells of this file run one by one in editors that know `# %%`, and all at once with
# `python3 tools/python/example.py out`, where `beampipe compare TRACE -t SPEC... -o out` wrote the folder.

# %%
import sys

import numpy

import beampipe

folder = sys.argv[1] if len(sys.argv) > 1 else "out"
report = beampipe.Report(folder)

# %% [markdown]
# One line per technique: error, DRAM bytes, modelled time on the first hardware.

# %%
print(f"{'technique':24} {'RMSE x 1000':>12} {'EMR':>8} {'DRAM, MB':>10} {'modelled, ms':>13}")
for technique in report.techniques:
    result = report[technique]
    if technique == "reference":
        continue
    dram = sum(frame["dram_bytes"] for frame in result["frames"]) / len(result["frames"])
    times = result["frames"][0].get("modelled_ms", {})
    first = next(iter(times.values()))["in_turn"] if times else numpy.nan
    print(f"{technique:24} {1000 * result['error']['rmse']:12.3f} {result['equivalent_msaa']:8.1f} {dram / 1e6:10.2f} "
          f"{first:13.3f}")

# %% [markdown]
# The error again, from the pictures themselves.

# %%
truth = report.picture("reference")[..., :3].astype(float)
for technique in report.techniques:
    difference = report.picture(technique)[..., :3] - truth
    print(f"{technique:24} {1000 * numpy.sqrt(numpy.mean(difference ** 2)):12.3f}")

# %% [markdown]
# Where is it wrong? The worst pixel of each technique, and what was counted there.

# %%
for technique in report.techniques:
    counters = report.counters(technique)
    if "error" not in counters:
        continue
    y, x = numpy.unravel_index(numpy.argmax(counters["error"]), counters["error"].shape)
    counted = ", ".join(f"{name} {layer[y, x]:g}" for name, layer in sorted(counters.items()))
    print(f"{technique}: pixel {x},{y}: {counted}")

# %% [markdown]
# DRAM bytes by stage.

# %%
for technique in report.techniques:
    for stage, counters in report.stages(technique).items():
        if counters.get("dram_bytes"):
            print(f"{technique:24} {stage:24} {counters['dram_bytes'] / 1e6:8.2f} MB")
