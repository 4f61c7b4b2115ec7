"""Captures small programs and reads the traces: `python3 capture_test.py BEAMPIPE`.

Programs and packages that are not installed are skipped. Exit code 77 if there was nothing to capture with."""
import importlib.util
import json
import os
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest

BEAMPIPE = sys.argv.pop(1) if len(sys.argv) > 1 else "beampipe"
SECONDS = 120  # that any of these captures may take; they take a few
TYPES = {"float32": "f", "uint32": "I", "uint16": "H", "uint8": "B"}


def environment():
    """Without a display, so that each capture starts its own."""
    return {key: value for key, value in os.environ.items() if key != "DISPLAY"}


def capture(*words, display=None, before=()):
    """`before`: the words of a command that runs the rest of its words."""
    return subprocess.run([*before, BEAMPIPE, "capture", "--timeout", str(SECONDS), *words], text=True,
                          stdin=subprocess.DEVNULL, env={**environment(), **({"DISPLAY": display} if display else {})},
                          capture_output=True)


def values_of(trace, folder, view):
    """A view's numbers. Fails where it does not lie within its buffer."""
    buffer = trace["buffers"][view["buffer"]]
    path = os.path.join(folder, buffer["file"])
    size = struct.calcsize(TYPES[view["type"]])
    assert os.path.getsize(path) == buffer["bytes"], path
    assert view["offset"] % size == 0 and view["offset"] + size * view["count"] <= buffer["bytes"], view
    with open(path, "rb") as file:
        file.seek(view["offset"])
        return struct.unpack(f"<{view['count']}{TYPES[view['type']]}", file.read(size * view["count"]))


class Captures(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = holder.name

    def trace_of(self, program, *words, agrees=True):
        """The trace of a program. `agrees`: it has all that makes up the program's picture."""
        if shutil.which(program) is None:
            self.skipTest(f"{program} is not installed")
        path = os.path.join(self.folder, "frame.json")
        done = capture("-o", path, *words)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stderr, "")  # progress is for terminals
        with open(path) as file:
            trace = json.load(file)
        self.check(trace)
        if agrees:
            self.check_with_program(path)
        self.printed = done.stdout
        return trace

    def check_with_program(self, path):
        """The program reads the trace, and draws the captured depths and colours."""
        info = subprocess.run([BEAMPIPE, "info", path], text=True, capture_output=True)
        self.assertEqual(info.returncode, 0, info.stderr)
        self.assertIn("captured from ", info.stdout)
        checked = subprocess.run([BEAMPIPE, "check-capture", path, "--json"], text=True, capture_output=True)
        self.assertEqual(checked.returncode, 0, checked.stderr)
        for frame in json.loads(checked.stdout)["frames"]:
            self.assertGreater(frame["coverage"], 0.999, frame)
            self.assertGreater(frame["depths_within_1e-4"], 0.999, frame)
            self.assertGreater(frame["colors"]["within_2_codes"], 0.999, frame)

    def check(self, trace):
        for name, mesh in trace["meshes"].items():
            positions = values_of(trace, self.folder, mesh["positions4"])
            indices = values_of(trace, self.folder, mesh["indices"])
            self.assertLess(max(indices), len(positions) // 4, name)
            self.assertEqual(len(indices) % 3, 0)
        for frame in trace["frames"]:
            depth = values_of(trace, self.folder, frame["captured"]["depth"])
            self.assertEqual(len(depth), frame["width"] * frame["height"])
            self.assertTrue(0 <= min(depth) < max(depth) == frame["captured"]["clear_depth"])
            for draw in frame["draws"]:
                mesh, program = trace["meshes"][draw["mesh"]], trace["programs"][draw["program"]["program"]]
                self.assertEqual(values_of(trace, self.folder, program["spirv"])[0], 0x07230203)
                self.assertEqual(mesh["varyings"]["count"] * 4,
                                 mesh["positions4"]["count"] * sum(one["count"] for one in program["inputs"]))
            self.assertEqual(sum(one["kept"] for one in frame["passes"]), 1)
        for image in trace["images"].values():
            with open(os.path.join(self.folder, image["file"]), "rb") as file:
                self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")
        self.assertIn("no_brilinear", trace["source"]["shading"])
        left = [name for name in os.listdir(self.folder) if name.endswith(".part")]
        self.assertEqual(left, [])

    def test_vulkan(self):
        trace = self.trace_of("vkcube", "--after", "1", "--", "vkcube")
        self.assertEqual(trace["source"]["api"], "Vulkan")
        self.assertEqual([len(mesh) > 0 for mesh in trace["meshes"].values()], [True])
        self.assertEqual(sum(mesh["indices"]["count"] for mesh in trace["meshes"].values()), 36)

    def test_a_machine_that_does_not_know_localhost(self):
        without_names = ("unshare", "--user", "--map-root-user", "--mount", "sh", "-c",
                         'mount --bind /dev/null /etc/hosts && ! getent hosts localhost && exec "$0" "$@"')
        if shutil.which("vkcube") is None or subprocess.run([*without_names, "true"], capture_output=True).returncode:
            self.skipTest("vkcube is not installed, or localhost cannot be hidden")
        done = capture("-o", os.path.join(self.folder, "frame.json"), "--", "vkcube", before=without_names)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_fixed_functions_go_through_zink_and_moving_meshes_are_stored_once(self):
        trace = self.trace_of("glxgears", "--frame", "60", "--frames", "2", "--", "glxgears")
        self.assertEqual(trace["source"]["api"], "OpenGL (zink)")
        first, second = ([draw["mesh"] for draw in frame["draws"]] for frame in trace["frames"])
        self.assertEqual(len(first), 12)
        # Six flat faces only turn. The program lights vertices, so the rounding of a face's colour may differ between
        # two frames, and then it is a mesh of its own.
        self.assertGreaterEqual(len(set(first) & set(second)), 3)
        moved = [draw for draw in trace["frames"][1]["draws"] if "transform" in draw]
        self.assertGreaterEqual(len(moved), 3)
        self.assertTrue(all(len(draw["transform"]) == 16 for draw in moved))

    def test_opengl_es(self):
        trace = self.trace_of("glmark2-es2", "--frame", "30", "--", "glmark2-es2", "-b", "build:model=horse")
        self.assertEqual(trace["source"]["api"], "OpenGL (zink)")
        triangles = sum(mesh["indices"]["count"] // 3 for mesh in trace["meshes"].values())
        self.assertGreater(triangles, 1000)
        arrays = trace["buffers"]["arrays"]["bytes"]
        self.assertLessEqual(arrays, 40 * triangles)

    def test_textures_are_read(self):
        trace = self.trace_of("glmark2-es2", "--frame", "30", "--", "glmark2-es2", "-b", "texture")
        image, = trace["program_images"]
        texels = sum(max(1, image["width"] >> level) * max(1, image["height"] >> level)
                     for level in range(image["levels"]))
        self.assertEqual(len(values_of(trace, self.folder, image["texels"])), 4 * texels)
        bound, = trace["frames"][0]["draws"][0]["program"]["images"]
        self.assertEqual((bound["image"], bound["sampler"]), (0, 0))

    def test_the_program_of_the_sample(self):
        """What traces/samples/captured_quads.json was made of."""
        program = os.path.join(os.path.dirname(os.path.abspath(__file__)), "own_program.py")
        trace = self.trace_of(sys.executable, "--frame", "10", "--", sys.executable, program)
        states = [draw["state"] for draw in trace["frames"][0]["draws"]]
        self.assertEqual(len(states), 6)
        self.assertEqual([number for number, state in enumerate(states) if "depth_bias" in state], [1])
        self.assertEqual([number for number, state in enumerate(states) if "scissor" in state], [3])
        self.assertEqual([number for number, state in enumerate(states) if not state.get("depth_test", True)], [4, 5])
        self.assertEqual([number for number, state in enumerate(states) if "blend" in state], [5])

    def test_lines_points_stencils_and_clears(self):
        program = os.path.join(os.path.dirname(os.path.abspath(__file__)), "own_lines.py")
        frame, = self.trace_of(sys.executable, "--frame", "10", "--", sys.executable, program)["frames"]
        self.assertEqual(frame["left_out"], [])
        states = [draw.get("state", {}) for draw in frame["draws"]]
        self.assertEqual(len(states), 7)
        self.assertEqual([number for number, state in enumerate(states) if "stencil_back" in state], [0, 1])
        self.assertEqual([(number, state["clears_stencil"], state["clears_depth"]) for number, state in enumerate(states)
                          if "clears_stencil" in state], [(3, 9, True)])
        self.assertEqual({draw["cull"] for draw in frame["draws"]}, {"none"})

    def frame_of_targets(self, what, **options):
        program = os.path.join(os.path.dirname(os.path.abspath(__file__)), "own_targets.py")
        trace = self.trace_of(sys.executable, "--frame", "10", "--", sys.executable, program, what, **options)
        return trace["frames"][0]

    def test_colours_are_encoded_as_the_target_is_seen(self):
        for what, target in (("window_srgb", "srgb"), ("object_srgb", "srgb"), ("object_codes", "unorm")):
            with self.subTest(what):
                frame = self.frame_of_targets(what)
                self.assertEqual((frame["target"], frame["left_out"]), (target, []))
                note = r"target \d+ is a framebuffer object of OpenGL: its rows are stored bottom up"
                (self.assertRegex if "object" in what else self.assertNotRegex)(self.printed, note)

    def test_what_a_trace_lacks_of_its_targets_is_named(self):
        earlier = [f"{what} is not cleared before the first draw" for what in ("colour", "depth")]
        for what, reasons in (("uncleared", earlier), ("part", ["a clear of a part of the target"]),
                              ("mixed_srgb", ["sRGB encoding differs from that of the largest draw"])):
            with self.subTest(what):
                frame = self.frame_of_targets(what, agrees=False)
                self.assertEqual([one["reason"] for one in frame["left_out"]], reasons)
                for reason in reasons:
                    self.assertRegex(self.printed, rf"left out: 1 [^\n]*: {reason.removeprefix('a clear ')}\n")

    def test_a_target_that_no_pass_draws_to(self):
        if shutil.which("glxgears") is None:
            self.skipTest("glxgears is not installed")
        done = capture("--list", "--frame", "5", "--target", "1", "--", "glxgears")
        self.assertRegex(done.stderr, r"\Abeampipe: error: no pass draws to target 1; expected one of \d+ "
                                      r"\(see --list\)\n\Z")

    def test_a_frame_that_is_not_reached_says_how_far_it_went(self):
        if shutil.which("glxgears") is None:
            self.skipTest("glxgears is not installed")
        done = capture("--list", "--frame", "1000000", "--timeout", "4", "--", "glxgears")
        self.assertRegex(done.stderr, r"\Abeampipe: error: glxgears: no frame captured within the time limit "
                                      r"\(frame \d+ was reached; see --timeout\)")

    def test_a_program_that_ends_is_one_line(self):
        done = capture("-o", os.path.join(self.folder, "a.json"), "--", "false")
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertRegex(done.stderr, r"\Abeampipe: error: false ended with exit code 1[^\n]*\n\Z")
        self.assertEqual(os.listdir(self.folder), [])

    def test_the_last_words_of_a_program_are_not_lost(self):
        for _ in range(8):
            done = capture("--list", "--", "sh", "-c", "echo no such thing; exit 4")
            self.assertIn('(it last said: "no such thing")', done.stderr)

    def test_a_display_that_is_none(self):
        done = capture("--list", "--", "sh", "-c", "exit 4", display=":77")
        self.assertIn("DISPLAY is :77; without it, a program gets a virtual display", done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1)

    def test_a_program_that_ends_before_the_frame_says_when(self):
        if shutil.which("glxgears") is None:
            self.skipTest("glxgears is not installed")
        for words, part in ((["--frame", "1000000"], "before frame 1000000"),
                            (["--after", "60"], "before the 60 s of --after; --frame 1 takes the first frame")):
            done = capture("--list", *words, "--", "timeout", "3", "glxgears")
            self.assertRegex(done.stderr, rf"\Abeampipe: error: timeout ended with exit code 124 after [34]\.\d s, {part}\b")

    def test_a_program_that_draws_nothing_is_one_line(self):
        start = time.monotonic()
        done = capture("--frame", "1", "--timeout", "3", "-o", os.path.join(self.folder, "a.json"), "--", "sleep", "1000")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"\Abeampipe: error: sleep: no picture shown within the time limit "
                                      r"\(0 frames were presented; see --timeout\)[^\n]*\n\Z")
        self.assertLess(time.monotonic() - start, 60)

    def test_wrong_usage_is_exit_code_2(self):
        out = os.path.join(self.folder, "a.json")
        for words in ([], ["--", "true"], ["-o", out], ["-o", out, "true"], ["-o", "a.txt", "--", "true"],
                      ["-o", out, "--frame", "0", "--", "true"], ["-o", out, "--frame", "1", "--after", "1", "--", "x"],
                      ["-o", out, "--nonsense", "--", "true"]):
            done = capture(*words)
            self.assertEqual(done.returncode, 2, words)
            self.assertRegex(done.stderr, r"\Abeampipe: error: [^\n]*\n\Z")

    def test_files_that_are_no_captures(self):
        path = os.path.join(self.folder, "no.rdc")
        with open(path, "wb") as file:
            file.write(b"nonsense")
        # Several times, because RenderDoc's threads did not always end.
        for name, part in 8 * [(path, "not a RenderDoc capture")] + [(os.path.join(self.folder, "none.rdc"), "no such file")]:
            done = capture("-o", os.path.join(self.folder, "a.json"), name)
            self.assertEqual(done.returncode, 1)
            self.assertIn(part, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1)

    def start(self, *program):
        return subprocess.Popen([BEAMPIPE, "capture", "--after", "900", "--timeout", "1000", "-o",
                                 os.path.join(self.folder, "a.json"), "--", *program],
                                env=environment(), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                stderr=subprocess.PIPE, text=True)

    def check_interrupted(self, running, children):
        _, error = running.communicate(timeout=60)
        self.assertEqual((running.returncode, error), (130, "beampipe: interrupted\n"))
        for child in children:
            self.assertFalse(os.path.exists(f"/proc/{child}"), child)
        self.assertEqual(os.listdir(self.folder), [])

    def test_an_interrupt_ends_everything_that_was_started(self):
        if shutil.which("glxgears") is None:
            self.skipTest("glxgears is not installed")
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(number.name):
                running = self.start("glxgears")
                children = []
                for _ in range(200):
                    time.sleep(0.05)
                    children = self.children_of(running.pid)
                    if len(children) >= 2 or running.poll() is not None:
                        break
                self.assertGreaterEqual(len(children), 2)
                running.send_signal(number)
                self.check_interrupted(running, children)

    def test_more_interrupts_do_not_save_a_program_that_ignores_them(self):
        """The program has also started one in a session of its own."""
        with tempfile.TemporaryDirectory() as notes:
            path = os.path.join(notes, "numbers")
            script = f"trap '' TERM HUP INT; setsid sleep 1000 & echo $$ $! > {path}.part; mv {path}.part {path}; wait"
            running = self.start("sh", "-c", script)
            for _ in range(400):
                time.sleep(0.05)
                if os.path.exists(path) or running.poll() is not None:
                    break
            with open(path) as file:
                children = [int(word) for word in file.read().split()] + self.children_of(running.pid)
            time.sleep(0.2)  # setsid has run
            for _ in range(3):  # the first during the wait for the program, the others during the clean-up
                running.send_signal(signal.SIGINT)
                time.sleep(0.5)
            self.check_interrupted(running, children)

    def children_of(self, parent):
        found = []
        for name in os.listdir("/proc"):
            try:
                with open(f"/proc/{name}/stat") as file:
                    if int(file.read().rpartition(")")[2].split()[1]) == parent:
                        found.append(int(name))
            except (OSError, ValueError, IndexError):
                pass
        return found


if __name__ == "__main__":
    missing = [f"python3-{name}" for name in ("renderdoc", "numpy") if importlib.util.find_spec(name) is None]
    missing += [] if shutil.which("Xvfb") else ["xvfb"]
    if missing:
        print(f"Skipped: these Debian packages are not installed: {' '.join(missing)}")
        sys.exit(77)
    unittest.main()
