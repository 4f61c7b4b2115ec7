#!/usr/bin/env python3
"""Measures what counting costs: bench/counting.py NONE COUNTED [--rounds N]

NONE and COUNTED are counting_benchmark of a build with -DBEAMPIPE_COUNT_NOTHING=ON and of one without. They take turns,
so that other work of the machine affects both alike, and each time is the least of its rounds. Prints milliseconds and
their ratios as the table of docs/accounting.md.
"""
import argparse
import json
import subprocess

MODEL = "/memory_model"


def measure(program):
    """Milliseconds of processor time by benchmark."""
    finished = subprocess.run([program, "--benchmark_format=json"], check=True, stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL)
    return {each["name"]: each["cpu_time"] for each in json.loads(finished.stdout)["benchmarks"]}


def least(rounds):
    return {name: min(each[name] for each in rounds) for name in rounds[0]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("none")
    parser.add_argument("counted")
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    rounds = [(measure(options.none), measure(options.counted)) for _ in range(options.rounds)]
    none, counted = least([each[0] for each in rounds]), least([each[1] for each in rounds])
    print("| technique | no counters, ms | counters | counters ÷ none | with memory model | model ÷ counters |")
    print("|---" * 6 + "|")
    for spec in counted:
        if not spec.endswith(MODEL):
            print(f"| `{spec}` | {none[spec]:.1f} | {counted[spec]:.1f} | {counted[spec] / none[spec]:.2f} | "
                  f"{counted[spec + MODEL]:.1f} | {counted[spec + MODEL] / counted[spec]:.2f} |")


if __name__ == "__main__":
    main()
