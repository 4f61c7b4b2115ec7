#!/usr/bin/env python3
"""Prints which lines and branches of stages/ and simd/ the tests reach.

    cmake --preset coverage
    cmake --build --preset coverage --target {simd,stages,spirv,programs,pipeline,lavapipe}_tests
    tests/coverage.py build/coverage [simd stages spirv programs pipeline lavapipe]

runs those tests (all, or the named ones) and prints a table. Clang counts how often each condition of the source
is true and false. A kernel is compiled for several instruction sets, and a template for several types; a line or branch
counts as reached if it is reached in one of them. The table names the lines that no test reaches and, of each branch
that none takes, line and column and which way is open, T or F. Conditions that are known to the compiler do not count.
"""
import collections
import json
import os
import pathlib
import re
import subprocess
import sys

FOLDERS = ("simd", "stages")
TESTS = ("simd", "stages", "spirv", "programs", "pipeline", "lavapipe")


def tool(name):
    """The program of LLVM that belongs to the compiler of the preset."""
    found = subprocess.run(["clang++", f"-print-prog-name={name}"], check=True, capture_output=True, text=True)
    return found.stdout.strip()


def lines_without_count(lcov):
    """By path, from the export in the format of lcov."""
    lines = collections.defaultdict(list)
    for line in lcov.splitlines():
        kind, _, value = line.partition(":")
        if kind == "SF":
            path = pathlib.Path(value).resolve()
        elif kind == "DA" and value.split(",")[1] == "0":
            lines[path].append(int(value.split(",")[0]))
    return lines


def ranges(lines):
    """[3, 4, 5, 9] -> ["3-5", "9"]"""
    found = []
    for line in lines:
        if found and found[-1][1] == line - 1:
            found[-1][1] = line
        else:
            found.append([line, line])
    return [str(first) if first == last else f"{first}-{last}" for first, last in found]


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

    def export(*options):
        command = [tool("llvm-cov"), "export", *options, "-instr-profile", merged, programs[0], *objects]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout

    open_lines = lines_without_count(export("-format=lcov"))
    print(f"{'file':40} {'lines':>12} {'branches':>12}  not reached")
    totals = collections.Counter()
    for file in json.loads(export())["data"][0]["files"]:
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
              f"{ways - len(open_ways):5} / {ways:4}  "
              f"{' '.join([*ranges(open_lines[path]), *open_ways])}{' never: ' if never else ''}{' '.join(never)}")
    print(f"{'all':40} {totals['hit']:5} / {totals['lines']:4} {totals['taken']:5} / {totals['branches']:4}")


if __name__ == "__main__":
    main(*sys.argv[1:])
