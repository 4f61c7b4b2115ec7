#!/usr/bin/env python3
"""Prints which lines and branches of stages/ and simd/ the tests reach.

    cmake --preset coverage && cmake --build --preset coverage --target {simd,stages,spirv,programs,pipeline}_tests
    tests/coverage.py build/coverage [simd stages spirv programs pipeline]

runs those tests (all, or the named ones) and prints a table. Clang counts how often each condition of the source
is true and false. A kernel is compiled for several instruction sets, and a template for several types; a line or branch
counts as reached if it is reached in one of them. For each branch that no test takes, the table names its line and
column and which way is open, T or F. Conditions that are known to the compiler do not count.
"""
import collections
import json
import os
import pathlib
import re
import subprocess
import sys

FOLDERS = ("simd", "stages")
TESTS = ("simd", "stages", "spirv", "programs", "pipeline")


def tool(name):
    """The program of LLVM that belongs to the compiler of the preset."""
    found = subprocess.run(["clang++", f"-print-prog-name={name}"], check=True, capture_output=True, text=True)
    return found.stdout.strip()


def main(build, *tests):
    build = pathlib.Path(build).resolve()
    source = build.parent.parent
    programs = [build / "tests" / f"{folder}_tests" for folder in tests or TESTS]
    profiles = []
    for program in programs:
        profiles.append(build / f"{program.name}.profraw")
        # The test left out looks for tests of other programs, which need not be built.
        subprocess.run([program, "--gtest_brief=1", "--gtest_filter=-CounterRegistry.NamesTests*"], check=True,
                       stdout=subprocess.DEVNULL, env=dict(os.environ, LLVM_PROFILE_FILE=str(profiles[-1])))
    # Clang describes a kernel only where its file includes itself no more, for the last instruction set. What the other
    # ones count is added to that: they are the same functions in other namespaces.
    merged, counts = build / "tests.profdata", build / "tests.proftext"
    subprocess.run([tool("llvm-profdata"), "merge", "-text", "-o", counts, *profiles], check=True)
    counts.write_text(re.sub(r"6N_AVX[23]|9N_AVX3_DL|6N_SSE[24]|7N_SSSE3", "8N_EMU128", counts.read_text()))
    subprocess.run([tool("llvm-profdata"), "merge", "-o", merged, counts], check=True)
    objects = [option for program in programs[1:] for option in ("-object", program)]
    text = subprocess.run([tool("llvm-cov"), "export", "-instr-profile", merged, programs[0], *objects], check=True,
                          capture_output=True, text=True).stdout

    print(f"{'file':40} {'lines':>12} {'branches':>12}  not reached")
    totals = collections.Counter()
    for file in json.loads(text)["data"][0]["files"]:
        path = pathlib.Path(file["filename"]).resolve()
        if not path.is_relative_to(source) or path.relative_to(source).parts[0] not in FOLDERS:
            continue
        branches = collections.defaultdict(lambda: [0, 0])
        for line, column, _, _, true, false, *_ in file["branches"]:
            branches[line, column][0] += true
            branches[line, column][1] += false
        open_ways = [f"{line}:{column}{way}" for (line, column), counts in sorted(branches.items()) if any(counts)
                     for way, count in zip("TF", counts) if count == 0]
        never = [f"{line}:{column}" for (line, column), counts in sorted(branches.items()) if not any(counts)]
        lines = file["summary"]["lines"]
        ways = 2 * (len(branches) - len(never))
        totals.update(hit=lines["covered"], lines=lines["count"], taken=ways - len(open_ways), branches=ways)
        print(f"{path.relative_to(source)!s:40} {lines['covered']:5} / {lines['count']:4} "
              f"{ways - len(open_ways):5} / {ways:4}  {' '.join(open_ways)}{' never: ' if never else ''}{' '.join(never)}")
    print(f"{'all':40} {totals['hit']:5} / {totals['lines']:4} {totals['taken']:5} / {totals['branches']:4}")


if __name__ == "__main__":
    main(*sys.argv[1:])
