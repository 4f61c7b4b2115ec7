#!/usr/bin/env python3
"""Holds real files to the JSON Schemas that `beampipe schema` prints: report.json, inspections.json, what
`beampipe inspect --json` prints, and the traces and configuration files that come with the source.

usage: report_schema_test.py BEAMPIPE SOURCE_FOLDER

Needs the module jsonschema (Debian: python3-jsonschema).
"""

import copy
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import jsonschema

BEAMPIPE, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])


def validator(kind):
    schema = json.loads(subprocess.run([BEAMPIPE, "schema", kind], check=True, stdout=subprocess.PIPE).stdout)
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


REPORT = validator("report")
INSPECTIONS = validator("inspections")


def keys_of(value, path=""):
    """The paths of all keys: "results/frames/index"."""
    if isinstance(value, dict):
        for key, member in value.items():
            yield path + key
            yield from keys_of(member, path + key + "/")
    if isinstance(value, list):
        for element in value:
            yield from keys_of(element, path)


class SchemaTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.scratch.cleanup)
        folder = pathlib.Path(cls.scratch.name)
        cls.room, fence = str(folder / "room.json"), str(folder / "fence.json")
        size, cache = ["--width", "16", "--height", "9"], ["--reference-cache", str(folder / "cache")]
        cls.run_program("make", "room", *size, "--triangles", "1000", "-o", cls.room)
        cls.run_program("make", "fence", *size, "--triangles", "1000", "--frames", "2", "--orbit", "3", "-o", fence)
        runs = {"run": ["run", fence, "--frames", "0", "--repeat", "2", "--material-cost", "10", "-t", "beam", "dvm", "msaa:2,motion"],
                "no_memory": ["run", fence, "--no-memory-model", "--measure-from", "1", "-t", "beam"],
                "compare": ["compare", fence, "--reference-error", "--causes", "--orders", "--inspect-worst", "1", "--ladder", "1,2,4,8,16", "--hardware", "rtx_4090", *cache, "-t",
                            "beam", "beam:order=sorted", "casav", "acaa:2", "msaa:1"],
                "kept": ["compare", fence, "--ladder", "1", *cache, "-t", "msaa:1"],
                "varying": ["compare", cls.room, "--inspect-worst", "1", "--ladder", "1,2,4,8,16", "--inspect", "8,4", "--metric", "flip", "-t",
                        "beam", "msaa:4"]}
        cls.reports, cls.inspections = {}, {}
        for name, arguments in runs.items():
            cls.run_program(*arguments, "-o", str(folder / name))
            cls.reports[name] = json.loads((folder / name / "report.json").read_text())
            for file in (folder / name).glob("*/inspections.json"):
                cls.inspections[f"{name} {file.parent.name}"] = json.loads(file.read_text())
        printed = cls.run_program("inspect", cls.room, "--pixel", "8,4", "-t", "beam:order=stream", "z3", "alpha", "--json")
        cls.inspections["inspect --json"] = json.loads(printed)

    @staticmethod
    def run_program(*arguments):
        return subprocess.run([BEAMPIPE, *arguments], check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout

    def assert_valid(self, schema, value, name):
        for error in schema.iter_errors(value):
            self.fail(f"{name}: {error.json_path}: {error.message[:300]}")

    def test_reports(self):
        for name, report in self.reports.items():
            self.assert_valid(REPORT, report, name)

    def test_inspections(self):
        self.assertGreaterEqual(len(self.inspections), 8)
        for name, inspections in self.inspections.items():
            self.assert_valid(INSPECTIONS, inspections, name)

    def test_files_of_the_source(self):
        """What the reader takes, which other tests try, the schema takes too."""
        files = {"trace": sorted((SOURCE / "traces/samples").glob("*.json")),
                 "hardware": [*(SOURCE / "tools/evaluate/hardware").glob("*.json"), SOURCE / "docs/examples/hardware.json"],
                 "sweep": [SOURCE / "docs/examples/sweep.json"]}
        for kind, paths in files.items():
            self.assertTrue(paths, kind)
            schema = validator(kind)
            for path in paths:
                value = json.loads(path.read_text())
                self.assert_valid(schema, value, path.name)
                value["no_such_key"] = 1
                self.assertFalse(schema.is_valid(value), path.name)
        room = json.loads(pathlib.Path(self.room).read_text())
        self.assert_valid(validator("trace"), room, "room")
        camera, schema = room["frames"][0]["camera"], validator("camera")
        self.assert_valid(schema, camera, "the camera of a trace")
        self.assert_valid(schema, {key: camera[key] for key in ("eye", "target")}, "a camera of which the rest is chosen")
        for key, value in [("no_such_key", 1), ("eye", [1, 2]), ("fovy_deg", 180), ("near", 0)]:
            self.assertFalse(schema.is_valid(camera | {key: value}), key)
        self.assertFalse(schema.is_valid({"eye": camera["eye"]}))

    def test_every_key_of_the_schemas_is_in_some_result(self):
        def keys_in(rule, path=""):
            """The paths of the keys that the schema names."""
            for key, member in rule.get("properties", {}).items():
                yield path + key
                yield from keys_in(member, path + key + "/")
            if "items" in rule:
                yield from keys_in(rule["items"], path)

        for schema, results, absent in [
                (REPORT.schema, self.reports,
                 {"notes/reason", "notes/left_out", "notes/draws", "notes/triangles", "notes/invocations", "notes",  # of captured programs
                  *(f"results/frames/stopped{key}" for key in ("", "/draw", "/invocations")),
                  "results/equivalent_msaa_is_upper_bound", "results/visibility/equivalent_msaa_is_upper_bound",
                  "results/visibility/equivalent_msaa_low", "results/visibility/equivalent_msaa_high",  # so small a picture has no
                  "results/equivalent_msaa_does_not_converge", "results/visibility/equivalent_msaa_does_not_converge"}),
                (INSPECTIONS.schema, self.inspections, set())]:
            found = {key for result in results.values() for key in keys_of(result)}
            for key in keys_in(schema):
                self.assertTrue(key in found or key in absent, f"{schema['title']}: no result has {key}")

    def test_schemas_refuse_what_is_wrong(self):
        report = self.reports["compare"]
        for path, value in [
                (["no_such_key"], 1), (["beampipe_report"], 1), (["threads"], 0), (["threads"], None),
                (["made_by", "trace"], "fence"), (["results", 0, "technique"], ""), (["results", 0, "no_such_key"], 1),
                (["results", 0, "frames", 0, "index"], -1), (["results", 0, "frames", 0, "stages", 0, "ops", "add"], 1.5),
                (["results", 0, "frames", 0, "stages", 0, "no_such_counter"], 1),
                (["results", 0, "frames", 0, "wall_ms", "median"], "2"), (["claims", 0, "kind"], "guessed")]:
            changed = copy.deepcopy(report)
            at = changed
            for key in path[:-1]:
                at = at[key]
            at[path[-1]] = value
            if value is None:
                del at[path[-1]]
            self.assertFalse(REPORT.is_valid(changed), path)
        pixels = self.inspections["varying beam"]
        for key, value in [("x", -1), ("color", [0, 0, 0]), ("no_such_key", 1), ("owners", [None, "1"])]:
            changed = copy.deepcopy(pixels)
            changed["pixels"][0][key] = value
            self.assertFalse(INSPECTIONS.is_valid(changed), key)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
