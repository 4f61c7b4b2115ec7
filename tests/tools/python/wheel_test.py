#!/usr/bin/env python3
"""Makes a wheel from a build, installs it into a new virtual environment, and uses it: wheel_test.py SOURCE BUILD_FOLDER"""
import pathlib
import subprocess
import sys
import tarfile
import tempfile
import unittest

SOURCE, BUILD = sys.argv[1:3]
USE = """
import beampipe, sys
assert beampipe.__file__.startswith(sys.prefix), beampipe.__file__
found = beampipe.render(beampipe.make("bars", width=32, height=16), "beam")
print(found.picture.shape, beampipe.__version__)
"""


class Wheel(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def run_it(self, *command):
        found = subprocess.run(list(map(str, command)), cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(found.returncode, 0, found.stdout + found.stderr)
        return found.stdout

    def test_a_wheel_is_installed_offline_and_works(self):
        # numpy is that of the system: an environment without it could not get it offline.
        self.run_it(sys.executable, "-m", "venv", "--system-site-packages", "new")
        python = self.folder / "new/bin/python"
        self.run_it(python, "-m", "pip", "install", "--no-index", "--no-build-isolation", "--disable-pip-version-check",
                    f"--config-settings=build={BUILD}", SOURCE)
        shape, version = self.run_it(python, "-c", USE).rsplit(" ", 1)
        self.assertEqual(shape, "(16, 32, 3)")
        self.assertIn(f"Version: {version}", self.run_it(python, "-m", "pip", "show", "beampipe"))

    def test_the_same_build_gives_the_same_wheel(self):
        sys.path.insert(0, f"{SOURCE}/tools/python")
        import build_backend
        for folder in ("a", "b"):
            (self.folder / folder).mkdir()
            name = build_backend.build_wheel(self.folder / folder, {"build": BUILD})
        self.assertEqual((self.folder / "a" / name).read_bytes(), (self.folder / "b" / name).read_bytes())

    def test_the_sdist_has_the_sources(self):
        if not (pathlib.Path(SOURCE) / ".git").exists():
            self.skipTest("not a Git repository")
        sys.path.insert(0, f"{SOURCE}/tools/python")
        import build_backend
        name = build_backend.build_sdist(self.folder)
        with tarfile.open(self.folder / name) as archive:
            names = archive.getnames()
        stem = name.removesuffix(".tar.gz")
        for file in ("pyproject.toml", "PKG-INFO", "CMakeLists.txt", "tools/python/native/module.cpp"):
            self.assertIn(f"{stem}/{file}", names)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
