#!/usr/bin/env python3
"""Checks that #include arrows point the right way. Prints file:line and the broken rule, and fails if there is one.

Usage: imports.py [REPOSITORY]
       imports.py --self-test    checks that wrong arrows are found, and right ones are not

The rules:

1.  Paths. An include of our own files is in quotes and starts at the root of the repository, without "." or "..".
    Third-party headers are in angle brackets; only those of Highway (hwy/) may be in quotes. No include is a macro.
2.  Folders. Imports run tools -> pipeline -> stages -> simd. All but simd may include traces, which stands alone.
    Inside traces/, files/ and scenes/ include the root, which may include scenes/. Only tools may include files/. What
    is left includes no third-party headers but those of GLM, Highway and oneTBB, and in stages/spirv/ of SPIRV-Tools.
3.  Inside tools/: cli -> sweep -> report -> claims -> evaluate -> files, where sweep leaves out claims. Only cli
    includes stress, which includes none of them. cli, report and python may include inspect, which may include evaluate
    and files. python, which includes cli as a whole program (cli/program.h), may include those too.
4.  Inside pipeline/: techniques -> units -> bins -> memory. All of them may include technique.h, which may
    include only memory. The other files at the root of pipeline/ may include bins and memory; only techniques may include them.
5.  Inside stages/. Each subfolder is a group of stages, except for data/ (types that stages share), cost/ (counters
    and costs that stages share), spirv/ (runs shaders), surface/ (what surfaces look like, wherever they are shaded)
    and rop/ (what draws do to what is stored): group -> surface -> rop, spirv -> cost -> data -> simd. Of these, only
    groups, surface/ and rop/ may include traces. No group includes another.
6.  A stage knows no other stage. The files of stage X in a group are X.h, X.cpp, X_cost.h, X_cost.cpp and parts of its
    kernel, X_PART-inl.h, and they include no other files of the group than these and the headers in SHARED_IN_GROUP.
7.  Not checked: tests/ and bench/, which may include anything, but which the folders above may not include.
"""

import re
import sys
from pathlib import Path, PurePosixPath

FOLDERS = {
    "tools": {"pipeline", "stages", "simd", "traces"}, "pipeline": {"stages", "simd", "traces"},
    "stages": {"simd", "traces"}, "simd": set(), "traces": set()}
# What each place in a folder may include of the same folder, besides itself. "root": the files in no subfolder.
ORDER = {
    "tools": {
        "cli": {"sweep", "report", "stress", "inspect", "claims", "evaluate", "files"},
        "sweep": {"report", "evaluate", "files"}, "report": {"inspect", "claims", "evaluate", "files"},
        "inspect": {"evaluate", "files"}, "python": {"cli", "inspect", "evaluate", "files"},
        "stress": set(), "claims": {"evaluate", "files"}, "evaluate": {"files"}, "files": set()},
    "pipeline": {
        "techniques": {"root", "units", "bins", "memory", "technique.h"}, "root": {"bins", "memory", "technique.h"},
        "units": {"bins", "memory", "technique.h"}, "bins": {"memory", "technique.h"},
        "memory": {"technique.h"}, "technique.h": {"memory"}},
    "stages": {"data": set(), "cost": {"data"}, "surface": {"data", "cost", "spirv", "rop"}, "spirv": {"data", "cost"},
               "rop": {"data", "cost"}},
    "traces": {"root": {"scenes"}, "scenes": {"root"}, "files": {"root"}}}
STAGE_GROUP = {"data", "cost", "surface", "rop"}
WITHOUT_TRACES = {"data", "cost", "spirv"}
# Of the packages that all may use, the standard library and the system.
LIGHT_HEADER = re.compile(r"(glm|hwy|tbb)/.*|\w+|(fcntl|malloc|unistd)\.h")
STAGE_FILE = re.compile(r"(.*?)(?:_cost|_[a-z]+-inl)?")
# Headers in stage groups that are no stage's own: formulas of stages and costs, and algorithms in files of their own.
SHARED_IN_GROUP = {
    "stages/beam/merge_sort.h", "stages/beam/owner_rules.h", "stages/beam/owner_rules_cost.h",
    "stages/beam/owners_bin.h",
    "stages/beam/position_states-inl.h", "stages/beam/register_mask-inl.h", "stages/beam/casav_fragment.h",
    "stages/beam/casav_merges.h", "stages/beam/region_rules.h", "stages/beam/specks.h", "stages/beam/specks_cost.h", "stages/geometry/clip.h",
    "stages/geometry/depth_ends.h", "stages/geometry/depth_order.h",
    "stages/geometry/draw_geometry.h", "stages/geometry/draw_notes.h", "stages/geometry/draw_plan.h",
    "stages/geometry/setup_formulas.h", "stages/picture/picture_formulas.h", "stages/raster/cutout_cells.h", "stages/raster/reference_raster.h",
    "stages/raster/reference_raster_cost.h", "stages/raster/reference_spans.h", "stages/raster/traverse.h",
    "stages/raster/traverse_cost.h", "stages/samples/sample_formulas.h",
    "stages/temporal/temporal_formulas.h"}
# For the self-test: the rule that is expected ("-" for none), the file, and its text.
CASES = r"""
our own files are included in quotes|tools/cli/main.cpp|#include <pipeline/technique.h>
without . or ..|pipeline/bins/bin.cpp|#include "../pipeline/technique.h"
without . or ..|stages/beam/windows.cpp|#include <stages/../pipeline/technique.h>
starts at the root|stages/beam/windows.cpp|#include "a_buffer.h"
not written out|stages/beam/windows.cpp|#include A_BUFFER
simd/ may not include traces/|simd/match.cpp|/* " */ # /**/ include /**/ "traces/trace.h" // a comment
tools/ may not include tests/|tools/claims/text.h.in|auto a = R"(")";\n#include "tests/x.h"
stages/data may not include traces/|stages/data/pair.h|#include "traces/trace.h"
data may not include cost|stages/data/pair.h|#include "stages/cost/counters.h"
beam may not include picture|stages/beam/windows.cpp|#include "stages/picture/picture_formulas.h"
file of the stage a_buffer|stages/beam/windows.cpp|#include "stages/beam/a_buffer_cost.h"
file of the stage windows|stages/beam/specks.h|#include "stages/beam/windows.h"
file of the stage shading_point|stages/samples/accumulate.cpp|#include "stages/samples/shading_point.h"
file of the stage materials|stages/samples/dilate_cost.h|#include "stages/samples/materials.h"
units may not include techniques|pipeline/units/gbuffer_unit.h|#include "pipeline/techniques/msaa.h"
bins may not include units|pipeline/bins/bin.h|#include "pipeline/units/gbuffer_unit.h"
root may not include units|pipeline/technique_table.h|#include "pipeline/units/gbuffer_unit.h"
memory may not include root|pipeline/memory/parameters.h|#include "pipeline/technique_table.h"
technique.h may not include root|pipeline/technique.h|#include "pipeline/spec.h"
evaluate may not include report|tools/evaluate/render.cpp|#include "tools/report/plot.h"
report may not include stress|tools/report/plot.cpp|#include "tools/stress/judge.h"
in traces/, root may not include files|traces/camera.cpp|#include "traces/files/json.h"
pipeline/ may not include traces/files/|pipeline/spec.cpp|#include "traces/files/json.h"
may include this library|stages/data/half_bits.h|#include <half.h>
may include this library|traces/scenes/room.cpp|#include <nlohmann/json.hpp>
may include this library|stages/surface/sheets.cpp|#include <spirv/unified1/spirv.hpp>
-|stages/spirv/module.h|#include <spirv/unified1/spirv.hpp>\n#include "stages/cost/counters.h"
in stages/, spirv may not include surface|stages/spirv/module.cpp|#include "stages/surface/sheets.h"
-|traces/files/image_file.cpp|#include <png.h>\n#include "traces/material.h"
-|stages/beam/windows_cost.h|#include "stages/beam/windows.h"\n#include "stages/beam/specks.h"\n#include <map>
-|stages/beam/windows.cpp|#include "stages/beam/windows_part-inl.h"
file of the stage windows|stages/beam/a_buffer.cpp|#include "stages/beam/windows_part-inl.h"
-|tools/cli/main.cpp|// /*\n#include "pipeline/technique.h"\n/* #include "a_buffer.h"\n#include "a_buffer.h" */"/*"
-|simd/match.cpp|#include "hwy/highway.h"\nauto text = R"x(\n#include "a_buffer.h"\n)x";"""
SOURCE = re.compile(r".*\.(h|hpp|c|cc|cpp|inc|inl)(\.in)?")
# Strings are matched so that "/*" in one does not begin a comment. A raw string may contain whole lines of code.
COMMENT_OR_STRING = re.compile(
    r'''//[^\n]*|/\*.*?\*/|R"(?P<end>[^\s()\\]*)\(.*?\)(?P=end)"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])\'''', re.DOTALL)
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include\b[ \t]*(.*?)[ \t]*$', re.MULTILINE)


def place(path):
    """The part of its top folder that the file is in: a key of ORDER[top folder], or a group of stages."""
    if len(path.parts) > 2:
        return path.parts[1]
    return "technique.h" if str(path) == "pipeline/technique.h" else "root"


def broken_rule(source, include):
    """What is wrong with the line `#include include` in the file `source`, a path in the repository, or None."""
    match = re.fullmatch(r'"([^"]+)"|<([^>]+)>', include)
    if not match:
        return "the path is not written out"
    target = PurePosixPath(match[1] or match[2])
    folder, other = source.parts[0], target.parts[0]
    if {"", ".", ".."} & set((match[1] or match[2]).split("/")):
        return "a path starts at the root of the repository, without . or .."
    if match[2] and other in {*FOLDERS, "bench", "tests"}:
        return "our own files are included in quotes"
    if match[2]:
        is_light = folder == "tools" or place(source) == "files" or LIGHT_HEADER.fullmatch(match[2])
        is_spirv = source.parts[:2] == ("stages", "spirv") and other in {"spirv", "spirv-tools"}
        return None if is_light or is_spirv else "only tools/ and traces/files/ may include this library"
    if other == "hwy":
        return None
    if other in {"bench", "tests"} or other in FOLDERS and other != folder and other not in FOLDERS[folder]:
        return f"{folder}/ may not include {other}/"
    if other not in FOLDERS or len(target.parts) == 1:
        return "a path in quotes starts at the root of the repository"
    here, there = place(source), place(target)
    if folder == "stages" and here in WITHOUT_TRACES and other == "traces":
        return f"stages/{here} may not include traces/"
    if folder not in {"tools", "traces"} and target.parts[:2] == ("traces", "files"):
        return f"{folder}/ may not include traces/files/"
    if folder == other and folder in ORDER and here != there:
        allowed = ORDER[folder].get(here, STAGE_GROUP if folder == "stages" else set())
        return None if there in allowed else f"in {folder}/, {here} may not include {there}"
    if folder == other == "stages" and here not in ORDER["stages"] and str(target) not in SHARED_IN_GROUP:
        stage, other_stage = (STAGE_FILE.fullmatch(path.name.split(".")[0])[1] for path in (source, target))
        return None if stage == other_stage else f"{stage} may not include a file of the stage {other_stage}"
    return None


def broken_rules(source, text):
    """Yields (line number, what is included, broken rule) for a file's text."""
    code = COMMENT_OR_STRING.sub(lambda m: m[0] if m[0][0] in "\"'" else " " + "\n" * m[0].count("\n"), text)
    for match in INCLUDE.finditer(code):
        rule = broken_rule(source, match[1])
        if rule:
            yield code.count("\n", 0, match.start()) + 1, match[1], rule


def self_test():
    failed = 0
    for case in CASES.strip().splitlines():
        expected, source, text = case.split("|")
        rules = [rule for _, _, rule in broken_rules(PurePosixPath(source), text.replace("\\n", "\n"))]
        passes = not rules if expected == "-" else len(rules) == 1 and expected in rules[0]
        if not passes or not SOURCE.fullmatch(source):
            print(f"{case}: found {rules}")
            failed = 1
    return failed


def main():
    repository = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent)
    broken = [f"{header}: is in SHARED_IN_GROUP but does not exist" for header in sorted(SHARED_IN_GROUP)
              if not (repository / header).is_file()]
    for path in sorted(path for folder in FOLDERS for path in (repository / folder).rglob("*")):
        if SOURCE.fullmatch(path.name):
            source = PurePosixPath(path.relative_to(repository).as_posix())
            for line, include, rule in broken_rules(source, path.read_text(encoding="utf-8")):
                broken.append(f"{source}:{line}: {include}: {rule}")
    print(*broken, sep="\n", end="\n" if broken else "")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(self_test() if sys.argv[1:] == ["--self-test"] else main())
