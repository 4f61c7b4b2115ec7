#!/usr/bin/env python3
"""Checks that #include arrows point the right way. Prints file:line and the broken rule, and fails if there is one.

Usage: imports.py [REPOSITORY]

The rules:

1.  Folders. A file includes its own folder and those that stand after the arrow:
        tools    -> pipeline, stages, simd, traces
        pipeline -> stages, simd, traces
        stages   -> simd, traces
        simd     -> nothing else
        traces   -> nothing else
2.  Inside stages/. Each subfolder is a group of stages, except for data/ (types that stages share) and cost/ (counters
    and costs that stages share):
        data    -> simd
        cost    -> data, simd
        a group -> data, cost, simd, traces
3.  A stage knows no other stage. A header in a group is a stage's header if its first line reads "// name: in -> out".
    Only the files of that stage include it: those with the same name, with or without "_cost" at the end. For instance,
    only claim.cpp, claim_cost.h and claim_cost.cpp may include claim.h.

tests/ and bench/ may include anything. Third-party headers, which are in angle brackets or stand in no folder of the
repository, are not checked.
"""

import re
import sys
from pathlib import Path

FOLDERS = {
    "tools": {"pipeline", "stages", "simd", "traces"},
    "pipeline": {"stages", "simd", "traces"},
    "stages": {"simd", "traces"},
    "simd": set(),
    "traces": set(),
}
STAGE_FOLDERS = {"data": {"simd"}, "cost": {"data", "simd"}}
ANY_STAGE_GROUP = {"data", "cost", "simd", "traces"}

INCLUDE = re.compile(r'\s*#\s*include\s*"([^"]+)"')
STAGE_HEADER = re.compile(r"// \w+: .+ -> ")


def sources(repository):
    for folder in FOLDERS:
        for path in sorted((repository / folder).rglob("*")):
            if path.suffix in {".h", ".cpp"}:
                yield path.relative_to(repository)


def is_stage_header(repository, path):
    if path.parts[0] != "stages" or path.suffix != ".h" or path.parts[1] in STAGE_FOLDERS:
        return False
    with open(repository / path, encoding="utf-8") as file:
        # A long first line may be wrapped before its arrow.
        return STAGE_HEADER.match(file.readline().rstrip() + " " + file.readline().removeprefix("//").strip()) is not None


def stage_of(path):
    """The name of the stage that the file belongs to, if it belongs to one."""
    return path.stem.removesuffix("_cost")


def broken_rule(source, target, stage_headers):
    """What is wrong with `source` including `target`, or None. Both are paths in the repository."""
    folder, other = source.parts[0], target.parts[0]
    if other not in FOLDERS:
        return f"{folder}/ may not include {other}/"
    if other != folder and other not in FOLDERS[folder]:
        return f"{folder}/ may not include {other}/: the arrows are tools -> pipeline -> stages -> simd, and traces alone"
    if folder == "stages":
        group, other_group = source.parts[1], target.parts[1] if other == "stages" else other
        allowed = STAGE_FOLDERS.get(group, ANY_STAGE_GROUP)
        if other_group != group and other_group not in allowed:
            return f"stages/{group}/ may only include itself, {', '.join(sorted(allowed))}"
        own = source.parent == target.parent and stage_of(source) == target.stem
        if target in stage_headers and not own:
            return f"{target} is the header of another stage: what stages share belongs in stages/data/ or stages/cost/"
    return None


def main():
    repository = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent)
    files = list(sources(repository))
    stage_headers = {path for path in files if is_stage_header(repository, path)}
    if not stage_headers:
        print("expected headers of stages, which begin with \"// name: in -> out\"; found none")
        return 1
    broken = 0
    for source in files:
        for number, line in enumerate((repository / source).read_text(encoding="utf-8").splitlines(), start=1):
            match = INCLUDE.match(line)
            if not match or not (repository / match[1]).is_file():
                continue
            rule = broken_rule(source, Path(match[1]), stage_headers)
            if rule:
                print(f"{source}:{number}: {match[1]}: {rule}")
                broken += 1
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
