#!/usr/bin/env python3
"""Installs a build, uses it as others would, and makes its Debian package: install_test.py CMAKE BUILD_FOLDER"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

CMAKE, BUILD = sys.argv[1:3]
ALONE_PROJECT = """cmake_minimum_required(VERSION 3.25)
project(alone LANGUAGES CXX)
find_package(beampipe REQUIRED)
add_executable(alone main.cpp)
target_link_libraries(alone PRIVATE beampipe::pipeline)
"""
ALONE_PROGRAM = """#include <iostream>
#include "pipeline/technique.h"
#include "traces/scenes.h"
int main() {
  const beampipe::Trace trace = beampipe::make_scene("bars", {});
  std::cout << beampipe::parse_technique("beam").render(trace, 0, {}).image.width << std::endl;
}
"""
EXAMPLES = pathlib.Path(__file__).resolve().parent.parent.parent / "docs/examples/library"


class Install(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.scratch.name)
        cls.prefix = cls.folder / "prefix"
        cls.run_it(CMAKE, "--install", BUILD, "--prefix", cls.prefix)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    @classmethod
    def run_it(cls, *command, **options):
        found = subprocess.run(list(map(str, command)), cwd=cls.folder, capture_output=True, text=True, **options)
        if found.returncode:
            raise AssertionError(f"{command}: exit {found.returncode}\n{found.stdout}\n{found.stderr}")
        return found.stdout

    def build_examples(self):
        """Builds the example programs, makes t.json, and returns the installed program."""
        self.run_it(CMAKE, "-S", EXAMPLES, "-B", "examples", f"-DCMAKE_PREFIX_PATH={self.prefix}")
        self.run_it(CMAKE, "--build", "examples", "--parallel", "2")
        program = self.prefix / "bin/beampipe"
        self.run_it(program, "make", "fence", "--triangles", "2000", "--width", "40", "--height", "30", "-o", "t.json")
        return program

    def test_examples_outside_the_tree_build_and_run(self):
        program = self.build_examples()
        rendered = self.run_it("examples/render_trace", "t.json", "beam")
        self.assertIn("beam: 40 x 30 pixels", rendered)
        self.run_it(program, "run", "t.json", "-t", "beam", "-o", "out")
        report = (self.folder / "out/report.json").read_text()
        for stage, items in re.findall(r"^(\w+): (\d+) in", rendered, re.M):
            self.assertRegex(report, rf'"stage": "{stage}",\s*"items_in": {items}\b')
        rate = self.run_it("examples/equivalent_rate", "t.json", "msaa:8")
        self.assertRegex(rate, r"equivalent MSAA rate 8\n(\w+: [\d.e-]+ ms\n)+$")

    def test_a_technique_outside_the_tree_is_compared_swept_and_reported(self):
        self.build_examples()
        self.run_it("examples/own_technique", "compare", "t.json", "-t", "overdraw", "msaa:1", "-o", "own")
        report = json.loads((self.folder / "own/report.json").read_text())
        result, = (each for each in report["results"] if each["technique"] == "overdraw")
        self.assertGreater(result["equivalent_msaa"], 0)
        for times in result["frames"][0]["modelled_ms"].values():
            self.assertGreater(times["at_once"], 0)
        self.run_it("examples/own_technique", "report", "own")
        self.assertIn("overdraw", (self.folder / "own/report.html").read_text())
        plan = {"beampipe_sweep": 1, "traces": ["t.json"], "techniques": ["overdraw", "msaa:1"]}
        (self.folder / "plan.json").write_text(json.dumps(plan))
        self.run_it("examples/own_technique", "sweep", "plan.json", "-o", "swept")
        self.assertIn("overdraw", (self.folder / "swept/table.csv").read_text())

    def test_the_pipeline_needs_glm_highway_and_onetbb_alone(self):
        project = self.folder / "alone"
        project.mkdir()
        (project / "main.cpp").write_text(ALONE_PROGRAM)
        (project / "CMakeLists.txt").write_text(ALONE_PROJECT)
        others = ("PNG", "libjpeg-turbo", "tinyobjloader", "TinyGLTF", "OpenEXR", "Imath", "ZLIB", "SQLite3", "Boost")
        self.run_it(CMAKE, "-S", project, "-B", "alone/build", f"-DCMAKE_PREFIX_PATH={self.prefix}",
                    *(f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in others))
        self.run_it(CMAKE, "--build", "alone/build")
        self.assertEqual(self.run_it("alone/build/alone"), "320\n")

    def test_bash_completes_commands_options_and_values(self):
        script = self.prefix / "share/bash-completion/completions/beampipe"

        def completions(*words):
            line = " ".join(f"'{word}'" for word in words)
            text = self.run_it("bash", "-c", f"source {script}; COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; "
                                             "_beampipe; printf '%s\\n' \"${COMPREPLY[@]}\"")
            return text.split()

        self.assertIn("compare", completions("beampipe", "co"))
        self.assertEqual(completions("beampipe", "repo"), ["report"])
        self.assertIn("--memory-limit", completions("beampipe", "run", "--mem"))
        self.assertIn("--eye", completions("beampipe", "make", "--"))
        self.assertNotIn("--eye", completions("beampipe", "run", "--"))
        self.assertEqual(completions("beampipe", "run", "-t", "acaa"), ["acaa"])
        self.assertEqual(completions("beampipe", "make", "fen"), ["fence"])
        self.assertEqual(completions("beampipe", "run", "--hardware", "mali"), ["mali_g710"])

    def test_zsh_accepts_its_script(self):
        if not shutil.which("zsh"):
            self.skipTest("no zsh")
        self.run_it("zsh", "-n", self.prefix / "share/zsh/site-functions/_beampipe")

    def test_the_manual_page_has_every_command_and_no_errors(self):
        page = self.prefix / "share/man/man1/beampipe.1"
        if shutil.which("groff"):
            formatted = subprocess.run(["groff", "-man", "-Tascii", "-ww", page], capture_output=True, text=True)
            self.assertEqual(formatted.stderr, "")
            self.assertIn("equivalent", formatted.stdout)
        commands = re.findall(r"^  ([a-z][a-z-]*)  ", self.run_it(self.prefix / "bin/beampipe", "--help"), re.M)
        self.assertGreater(len(commands), 10)
        for command in commands:
            self.assertIn(f".SS beampipe {command}".replace("-", "\\-"), page.read_text())

    def test_the_python_module_is_there(self):
        self.assertTrue((self.prefix / "lib/python3/dist-packages/beampipe/__init__.py").is_file())

    def test_the_debian_package_has_the_program_and_its_needs(self):
        if not shutil.which("dpkg-shlibdeps"):
            self.skipTest("no dpkg-dev")
        self.run_it(pathlib.Path(CMAKE).with_name("cpack"), "--config", pathlib.Path(BUILD) / "CPackConfig.cmake", "-B",
                    self.folder / "package")
        package, = (self.folder / "package").glob("*.deb")
        self.assertIn("./usr/bin/beampipe", self.run_it("dpkg-deb", "--contents", package))
        self.assertRegex(self.run_it("dpkg-deb", "--field", package, "Depends"), "libopenexr")


if __name__ == "__main__":
    os.environ.pop("DESTDIR", None)
    unittest.main(argv=sys.argv[:1])
