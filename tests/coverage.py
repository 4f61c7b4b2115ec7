#!/usr/bin/env python3
"""Prints which lines and branches of stages/ and simd/ the tests reach.

    cmake --preset coverage && cmake --build --preset coverage --target simd_tests stages_tests pipeline_tests
    tests/coverage.py build/coverage [simd stages pipeline]

runs those tests (all three, or the named ones) and prints a table with the lines that no test reaches. A kernel is
compiled for several instruction sets; a line or branch of it counts as reached if it is reached with one of them.
Branches that are taken only for exceptions do not count.
"""
import collections
import json
import pathlib
import subprocess
import sys

FOLDERS = ("simd", "stages")


def main(build, *tests):
    build = pathlib.Path(build).resolve()
    source = build.parent.parent
    for old in build.rglob("*.gcda"):
        old.unlink()
    for folder in tests or ("simd", "stages", "pipeline"):
        # The test left out looks for tests of other programs, which need not be built.
        subprocess.run([build / "tests" / f"{folder}_tests", "--gtest_brief=1",
                        "--gtest_filter=-CounterRegistry.NamesTests*"], check=True)

    lines = collections.defaultdict(lambda: collections.Counter())
    branches = collections.defaultdict(lambda: collections.Counter())
    for notes in sorted(build.rglob("*.gcda")):
        text = subprocess.run(["gcov", "--json-format", "--stdout", "--branch-probabilities", notes], cwd=build,
                              check=True, capture_output=True, text=True).stdout
        for report in text.splitlines():
            for file in json.loads(report)["files"]:
                path = (build / file["file"]).resolve()
                if not path.is_relative_to(source) or path.relative_to(source).parts[0] not in FOLDERS:
                    continue
                name = str(path.relative_to(source))
                for line in file["lines"]:
                    lines[name][line["line_number"]] += line["count"]
                    for i, branch in enumerate(line["branches"]):
                        if not branch["throw"]:
                            branches[name][line["line_number"], i] += branch["count"]

    print(f"{'file':36} {'lines':>12} {'branches':>12}  not reached")
    totals = collections.Counter()
    for name in sorted(lines):
        hit = sum(count > 0 for count in lines[name].values())
        taken = sum(count > 0 for count in branches[name].values())
        totals.update(hit=hit, lines=len(lines[name]), taken=taken, branches=len(branches[name]))
        missed = " ".join(str(line) for line, count in sorted(lines[name].items()) if count == 0)
        print(f"{name:36} {hit:5} / {len(lines[name]):4} {taken:5} / {len(branches[name]):4}  {missed}")
    print(f"{'all':36} {totals['hit']:5} / {totals['lines']:4} {totals['taken']:5} / {totals['branches']:4}")


if __name__ == "__main__":
    main(*sys.argv[1:])
