#!/usr/bin/env python3
"""Tests the report page in a browser, headless Chromium, through chromedriver.

usage: report_page_test.py BEAMPIPE CHROMIUM CHROMEDRIVER [SECONDS]

Chromedriver, and then Chromium, may each take SECONDS to start (60 by default). If one does not start, the test ends with
one line that says why.
"""

import base64
import csv
import functools
import http.client
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.error
import urllib.request

BEAMPIPE, CHROMIUM, CHROMEDRIVER = sys.argv[1:4]
START_LIMIT = float(sys.argv[4]) if len(sys.argv) > 4 else 60
MEASURES = ["rmse", "bias", "p99", "max", "p999", "mae", "rel_mse", "srgb_rmse", "psnr", "ssim", "flip", "hdr_flip"]
TECHNIQUES = ["beam:order=sorted", "alpha", "msaa:1", "msaa:8"]
KEYS = {"left": "\ue012", "right": "\ue014", "end": "\ue010", "home": "\ue011"}  # WebDriver's names of keys


class CannotStart(Exception):
    """Chromedriver or Chromium does not start; the message is one line."""


class Browser:
    """One window, over the WebDriver protocol."""

    def __init__(self):
        self.folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)  # processes that are ending may still write
        # The driver writes to a file, because a pipe stays open for as long as any process that the driver started. It
        # leads a process group of its own, so that end_processes() ends what was started here and nothing else.
        self.log = pathlib.Path(self.folder.name) / "chromedriver.log"
        try:
            with open(self.log, "w") as log:
                self.driver = subprocess.Popen([CHROMEDRIVER, "--port=0"], stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                                               env={**os.environ, "TMPDIR": self.folder.name}, start_new_session=True)
        except OSError as error:
            raise CannotStart(f"chromedriver does not start: {error}")
        try:
            self.url = f"http://127.0.0.1:{self.wait_for_port()}"
            self.url += "/session/" + self.start_session()
        except BaseException:
            self.end_processes()
            raise

    def wait_for_port(self):
        end = time.monotonic() + START_LIMIT
        while time.monotonic() < end:
            # Looks without reaping the process, so that its number cannot become that of another one.
            ended = os.waitid(os.P_PID, self.driver.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT)
            output = self.log.read_text()
            if started := re.search(r"started successfully on port (\d+)", output):
                return started[1]
            if ended:
                last_line = (output.splitlines() or ["it printed nothing"])[-1]
                raise CannotStart(f"chromedriver does not start: it ended with status {ended.si_status} ({last_line})")
            time.sleep(0.02)
        raise CannotStart(f"chromedriver does not start: it named no port within {START_LIMIT:g} s")

    def start_session(self):
        arguments = ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"]
        options = {"goog:chromeOptions": {"binary": CHROMIUM, "args": arguments},
                   "goog:loggingPrefs": {"browser": "ALL"}}
        try:
            return self.send("POST", "/session", {"capabilities": {"alwaysMatch": options}}, START_LIMIT)["sessionId"]
        except urllib.error.HTTPError as error:
            reason = json.load(error)["value"]["message"].splitlines()[0]
        except TimeoutError:
            reason = f"it gave no answer within {START_LIMIT:g} s"
        except (OSError, http.client.HTTPException) as error:
            reason = f"chromedriver failed: {error}"
        raise CannotStart(f"Chromium does not start: {reason}")

    def send(self, method, path, body=None, limit=120):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.url + path, data, {"Content-Type": "application/json"}, method=method)
        with urllib.request.build_opener(urllib.request.ProxyHandler({})).open(request, timeout=limit) as answer:
            return json.load(answer)["value"]

    def close(self):
        try:
            self.send("DELETE", "")
        finally:
            self.end_processes()

    def end_processes(self):
        os.killpg(self.driver.pid, signal.SIGKILL)
        self.driver.wait()
        self.folder.cleanup()

    def open(self, file):
        self.send("POST", "/url", {"url": file.as_uri()})
        self.wait_until("return document.documentElement.dataset.ready === 'yes'")

    def run(self, script, *arguments):
        return self.send("POST", "/execute/sync", {"script": script, "args": arguments})

    def wait_until(self, script):
        done = self.send("POST", "/execute/async", {"args": [], "script": """
            const done = arguments[arguments.length - 1], holds = () => { %s }, end = performance.now() + 20000;
            (function look() { holds() || performance.now() > end ? done(holds()) : setTimeout(look, 20); })();""" % script})
        if not done:
            raise AssertionError("never came true: " + script)

    def press(self, selector, keys):
        [element] = self.send("POST", "/elements", {"using": "css selector", "value": selector})[0].values()
        self.send("POST", f"/element/{element}/value", {"text": keys})

    def click(self, selector):
        self.run("document.querySelector(arguments[0]).click()", selector)

    def resize(self, width, height):
        self.send("POST", "/goog/cdp/execute", {"cmd": "Emulation.setDeviceMetricsOverride", "params": {
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500}})

    def color_scheme(self, scheme):
        self.send("POST", "/goog/cdp/execute", {"cmd": "Emulation.setEmulatedMedia", "params": {
            "features": [{"name": "prefers-color-scheme", "value": scheme}]}})

    def console(self):
        return [entry["message"] for entry in self.send("POST", "/se/log", {"type": "browser"})]


def table_rows(browser, name):
    """The rows of a table on the page: {column: (exact value as text, text that is read)}."""
    rows = browser.run("""
        return [...document.querySelectorAll(`#table-${arguments[0]} tbody tr`)].map((row) =>
            [...row.children].map((cell) => [cell.dataset.key, cell.dataset.value, cell.textContent]))""", name)
    return [{key: (value, text) for key, value, text in row} for row in rows]


def column_sizes(browser, name):
    """How much 1 stands for in each column of a table, and the unit in its head: {column: (size, unit)}."""
    return {key: (float(size), unit) for key, size, unit in browser.run("""
        const table = document.querySelector(`#table-${arguments[0]}`), row = table.querySelector("tbody tr");
        return [...table.querySelectorAll("thead th")].map((head, i) =>
            [row.children[i].dataset.key, head.dataset.size, head.querySelector(".unit").textContent])""", name)}


def limit(unit, rate):
    """The unit, and the rate that limits it where that is not the unit's own."""
    name = rate.removeprefix("core_").removesuffix("_per_clk")
    return unit if name.startswith(unit) else f"{unit}: {name}"


def mean(result, value):
    """Over the frames of a result."""
    return sum(value(frame) for frame in result["frames"]) / len(result["frames"])


class PageTest(unittest.TestCase):
    """A page of a scene: `scene` and `command` are arguments of beampipe; `command` lacks the trace and the folder."""

    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.folder = pathlib.Path(cls.scratch.name) / "out"
        cls.trace = str(cls.folder.parent / f"{cls.scene[0]}.json")
        verb, *options = cls.command
        for arguments in [["make", *cls.scene, "-o", cls.trace], [verb, cls.trace, "-o", str(cls.folder), *options],
                          ["report", str(cls.folder)]]:
            subprocess.run([BEAMPIPE, *arguments], check=True, stdout=subprocess.DEVNULL)
        cls.report = json.loads((cls.folder / "report.json").read_text())
        cls.results = {result["technique"]: result for result in cls.report["results"] if result["technique"] != "reference"}

    def setUp(self):
        self.browser.resize(1280, 900)
        self.browser.color_scheme("light")
        self.browser.open(self.folder / "report.html")

    def tearDown(self):
        self.assertEqual(self.browser.console(), [], "messages in the browser's console")

    def texts(self, selector):
        return self.browser.run("return [...document.querySelectorAll(arguments[0])].map((one) => one.textContent)", selector)

    def value_of(self, control):
        return self.browser.run("return document.getElementById(arguments[0]).value", control)

    def plots(self):
        return self.browser.run("return [...document.querySelectorAll('svg[data-plot]')].map((svg) => svg.dataset.plot)")

    def csv_table(self, name):
        with open(self.folder / "tables" / f"{name}.csv", newline="") as file:
            return list(csv.DictReader(file))

    def card(self, technique):
        """{name: [value, multiple of the baseline's, more...]}"""
        return dict(self.browser.run("""return [...document.querySelectorAll(`.card[data-technique="${arguments[0]}"] dl div`)]
            .map((row) => [row.dataset.name, [...row.querySelectorAll("dd")].map((each) => each.textContent)])""", technique))

    def short(self, value):
        return self.browser.run("return shortText(arguments[0])", value)

    def set_value(self, selector, value, event="change"):
        """Sets a control, as a user would, and waits until the pictures are loaded."""
        self.browser.send("POST", "/execute/async", {"args": [selector, value, event], "script": """
            const [selector, value, event, done] = arguments, control = document.querySelector(selector);
            control.value = value;
            control.dispatchEvent(new Event(event, { bubbles: true }));
            setTimeout(() => reload().then(() => requestAnimationFrame(() => requestAnimationFrame(() => done()))), 50);"""})

    def click_pixel(self, x, y):
        """Clicks the middle of a pixel of the large picture."""
        px, py = self.browser.run("""
            const canvas = document.getElementById("compare"), layer = view.panes[0].layer();
            canvas.scrollIntoView({ block: "center" });
            const box = canvas.getBoundingClientRect(), size = box.width / layer.width;
            return [box.left + (arguments[0] + 0.5) * size, box.top + (arguments[1] + 0.5) * size]""", x, y)
        self.browser.send("POST", "/actions", {"actions": [{"type": "pointer", "id": "mouse", "actions": [
            {"type": "pointerMove", "x": round(px), "y": round(py), "duration": 0}, {"type": "pointerDown", "button": 0},
            {"type": "pointerUp", "button": 0}]}]})

    def pixel(self, x, y):
        """The colour of a place on the canvas; x and y are parts of its width and height."""
        return self.browser.run("""
            const canvas = document.getElementById("compare"), copy = make("canvas", { width: 1, height: 1 });
            copy.getContext("2d").drawImage(canvas, -arguments[0] * canvas.width, -arguments[1] * canvas.height);
            return [...copy.getContext("2d").getImageData(0, 0, 1, 1).data].slice(0, 3)""", x, y)

    def wait_for_frame(self):
        self.browser.send("POST", "/execute/async", {"args": [], "script": """
            const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done()))"""})

    def assert_fits(self, width):
        """Neither the page nor a view of a table is wider than the window."""
        self.browser.resize(width, 900)
        self.wait_for_frame()
        self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), width)
        for wide in self.browser.run("""
                const tables = [...document.querySelectorAll(".table")], wide = [];
                for (const table of tables)
                  for (const button of [...table.querySelectorAll(".views button"), null]) {
                    button?.click();
                    const box = table.querySelector(".scroll");
                    if (box.scrollWidth > box.clientWidth)
                      wide.push([table.id, button?.textContent ?? "", box.scrollWidth, box.clientWidth]);
                  }
                return wide"""):
            self.fail(f"at {width} px: {wide}")


class ReportPage(PageTest):
    scene = ["fence", "--width", "96", "--height", "54", "--frames", "2", "--orbit", "3"]
    command = ["compare", "--causes", "--ladder", "1,8", "--inspect", "48,27", "--inspect-worst", "2", "-t", *TECHNIQUES]

    def test_needs_no_network(self):
        page = (self.folder / "report.html").read_text()
        self.assertEqual(re.findall(r"""(?:src|href)\s*=\s*["'](?!#|data:)[^"']*""", page[:page.index("<script>")]), [])
        self.assertEqual(self.browser.run("return performance.getEntriesByType('resource')"
                                          ".map((entry) => entry.name).filter((name) => !name.startsWith('data:'))"), [])

    def test_technique_numbers_equal_the_report(self):
        rows = {row["technique"][0]: row for row in table_rows(self.browser, "techniques")}
        sizes = column_sizes(self.browser, "techniques")
        self.assertEqual(list(rows), TECHNIQUES + ["reference"])
        self.assertEqual(sizes["dram_bytes"], (1e6, "MB per frame"))
        self.assertEqual(sizes["a_buffer_peak_bytes"], (1e6, "MB"))
        self.assertEqual(sizes["peak_bytes_per_pixel"], (1, "bytes per pixel"))
        for result in self.report["results"]:
            row = rows[result["technique"]]
            for key, expected in [*((key, result["error"][key]) for key in MEASURES if key in result["error"]),
                                  ("emr", result["equivalent_msaa"]),
                                  ("framebuffer_bytes_per_pixel", result["framebuffer_bytes_per_pixel"]),
                                  ("peak_bytes_per_pixel", result["peak_bytes_per_pixel"]),
                                  ("a_buffer_peak_bytes", result["a_buffer_peak_bytes"])]:
                value, text = row[key]
                self.assertEqual(float(value), expected, key)
                shown = float(text.replace("\u202f", "")) * sizes[key][0]
                self.assertLessEqual(abs(shown - expected), 0.0005 * abs(expected), f"{key} is shown as {text}")
            bound = "at least" if result["equivalent_msaa_is_lower_bound"] else "estimate"
            self.assertEqual(row["emr_bound"][0], bound)
            self.assertAlmostEqual(float(row["wall_ms"][0]), mean(result, lambda frame: frame["wall_ms"]["median"]), 9)
            if result["technique"] == "reference":
                self.assertEqual(row["dram_bytes"], ("", "–"), "it is not for hardware")
            else:
                self.assertEqual(float(row["dram_bytes"][0]), mean(result, lambda frame: frame["dram_bytes"]))
            for way in ["shaders", "fixed_function"]:
                for kind in ["at_once", "on_cores", "in_turn"]:
                    value, text = row[f"modelled_ms_{way}_{kind}"]
                    if result["technique"] == "reference":
                        self.assertEqual((value, text), ("", "–"), "it is not for hardware")
                    else:
                        self.assertAlmostEqual(float(value), mean(result, lambda frame: frame["modelled_ms"][way][kind]), 12)

    def assert_rows(self, table, records, keys):
        """The table's rows hold the values that `keys`, {column: function of a record}, find in the records."""
        rows = table_rows(self.browser, table)
        self.assertEqual(len(rows), len(records))
        for row, record in zip(rows, records):
            for key, find in keys.items():
                expected, shown = find(record), row[key][0]
                if expected is None:
                    self.assertEqual(row[key], ("", "–"), f"{table} {key}")
                elif isinstance(expected, str):
                    self.assertEqual(shown, expected, f"{table} {key}")
                else:
                    self.assertEqual(float(shown), expected, f"{table} {key}")
            self.assertLessEqual(set(row), set(keys), f"{table}: columns that are not compared")

    def test_frames_and_framebuffers_equal_the_report(self):
        members = lambda key: [{**member, "technique": result["technique"]}
                               for result in self.report["results"] for member in result[key]]
        plain = lambda *keys: {key: lambda record, key=key: record.get(key) for key in keys}
        self.assert_rows("framebuffer", members("framebuffer"),
                         {**plain("technique", "format", "bytes_per_pixel"), "surface": lambda record: record["name"]})
        self.assertEqual(self.texts("#table-claims"), [], "no published figure is about this trace")
        of = lambda *path: lambda record: functools.reduce(lambda at, key: (at or {}).get(key), path, record)
        self.assert_rows("frames", members("frames"), {
            **plain("technique", "a_buffer_peak_bytes", "logical_bytes", "sector_bytes", "l2_bytes", "dram_bytes", "flicker"),
            "frame": of("index"), "wall_ms": of("wall_ms", "median"), "wall_ms_min": of("wall_ms", "min"),
            "wall_ms_max": of("wall_ms", "max"), "runs": of("wall_ms", "runs"), "rmse": of("error", "rmse"),
            **{key: of("error", key) for key in MEASURES},
            **{f"modelled_ms_{way}_{kind}": of("modelled_ms", way, kind)
               for way in ["shaders", "fixed_function"] for kind in ["at_once", "on_cores", "in_turn"]},
            **{f"energy_mj_{part}_{end}": of("energy_mj", part, end)
               for part in ["operations", "on_chip", "l2", "dram"] for end in ["low", "high"]},
            **{f"energy_mj_{part}_{way}_{end}": of("energy_mj", part, way, end) for part in ["instructions", "total"]
               for way in ["shaders", "fixed_function"] for end in ["low", "high"]}})

    def test_memory_of_cards_and_frontier_has_the_a_buffer_in_it(self):
        for result in self.results.values():
            pixels = 96 * 54
            most = max(frame["a_buffer_peak_bytes"] for frame in result["frames"])
            surfaces = sum(surface["bytes_per_pixel"] for surface in result["framebuffer"])
            self.assertAlmostEqual(result["peak_bytes_per_pixel"], surfaces + most / pixels, 9)
        self.assertGreater(self.results["beam:order=sorted"]["a_buffer_peak_bytes"], 0)

        for spec, result in self.results.items():
            self.assertEqual(self.card(spec)["off chip"][0], f"{self.short(result['peak_bytes_per_pixel'])} B/pixel")

        points = dict(self.browser.run("""return [...document.querySelectorAll("[data-plot=storage] .point")]
                                              .map((point) => [point.dataset.tip.split("\\n")[0], point.__data__.x])"""))
        self.assertEqual(points, {spec: result["peak_bytes_per_pixel"] + result["on_chip_bytes_per_pixel"]
                                  for spec, result in self.results.items()})

    def test_cards_hold_each_technique_against_msaa_8(self):
        self.assertEqual([title.split()[0] for title in self.texts(".card h3")], ["msaa:8", *[s for s in TECHNIQUES if s != "msaa:8"]])
        self.assertEqual(self.card("msaa:8")["DRAM"][1], "", "the baseline has no multiples")
        self.assertIn("multiples are of msaa:8", self.texts("#cost-note")[0])
        said = subprocess.run([BEAMPIPE, "model", self.folder, "--json"], check=True, capture_output=True, text=True).stdout
        times = {(row["technique"], row["implementation"]): row for row in json.loads(said)[0]["times"]}
        for way in ["shaders", "fixed_function"]:
            self.browser.run("const s = document.getElementById('implementation'); s.value = arguments[0];"
                             "s.dispatchEvent(new Event('change'))", way)
            for spec, result in self.results.items():
                card = self.card(spec)
                for name, unit, value in [
                        ("DRAM", " MB", lambda result: mean(result, lambda frame: frame["dram_bytes"]) / 1e6),
                        ("on chip", " B/pixel", lambda result: result["on_chip_bytes_per_pixel"]),
                        ("time", " ms", lambda result: mean(result, lambda frame: frame["modelled_ms"][way]["at_once"])),
                        ("RMSE", "", lambda result: result["error"]["rmse"]),
                        ("EMR", "", lambda result: result["equivalent_msaa"])]:
                    bound = "≥ " if name == "EMR" and result["equivalent_msaa_is_lower_bound"] else ""
                    self.assertEqual(card[name][0], bound + self.short(value(result)) + unit, f"{spec} {name}")
                    if spec != "msaa:8":
                        ratio = float(card[name][1].rstrip("×").replace("\u202f", ""))
                        self.assertLessEqual(abs(ratio * value(self.results["msaa:8"]) / value(result) - 1), 0.06, f"{spec} {name}")
                units = [limit(frame["modelled_ms"][way]["busiest"], frame["modelled_ms"][way]["busiest_rate"])
                         for frame in result["frames"]]
                self.assertEqual(card["time"][2], "bottleneck: " + ", ".join(dict.fromkeys(units)))
                low, high = times[spec, way]["at_once_interval"]
                self.assertEqual(card["time"][3], f"range: {self.short(low)} to {self.short(high)} ms")
                low, high = times[spec, way]["in_turn_interval"]
                self.assertIn(f"({self.short(low)} to {self.short(high)})", card["time"][5])
            self.assertLessEqual({f"time_{way}", f"speed_{way}"}, set(self.plots()), "the choice holds for the plots as well")

    def test_conditions_tell_what_was_drawn_and_how(self):
        found = dict(self.browser.run("return [...document.querySelectorAll('#conditions div')]"
                                      ".map((row) => [...row.children].map((each) => each.textContent))"))
        self.assertEqual(found["picture"], "96 × 54 pixels, 2 frames")
        [triangles] = {frame["triangles"] for frame in self.report["frames"]}
        self.assertEqual(found["scene"].replace("\u202f", ""), f"{triangles} triangles, 3 draws, 1 light")
        self.assertEqual(found["command"], f"beampipe compare {self.trace} -o {self.folder} {' '.join(self.command[1:])}")
        self.assertEqual(found["hardware"], "titan_v (Titan V class, 1455 MHz) save description")
        self.assertEqual(json.loads(self.browser.run("""const link = document.querySelector("#conditions a");
                                                        return link.download === "titan_v.json"
                                                          ? decodeURIComponent(link.href.split(",").slice(1).join(","))
                                                          : "null";""")), self.report["hardware"])
        self.assertRegex(found["memory system"], r"^L2 4\.5 MiB, .*compression on")

    def test_stages_add_up_to_techniques_and_these_are_means_of_frames(self):
        number = lambda text: float(text or "0")
        for technique in self.csv_table("techniques"):
            of = lambda rows: [row for row in rows if row["technique"] == technique["technique"]]
            stages, frames = of(self.csv_table("stages")), of(self.csv_table("frames"))
            if technique["technique"] == "reference":
                continue
            for key in ["logical_bytes", "sector_bytes", "l2_bytes", "dram_bytes"]:
                self.assertAlmostEqual(sum(number(stage[key]) for stage in stages) / number(technique[key]), 1, 12, key)
            for way in ["shaders", "fixed_function"]:
                total = sum(number(stage[f"modelled_ms_{way}"]) for stage in stages)
                self.assertAlmostEqual(total / number(technique[f"modelled_ms_{way}_in_turn"]), 1, 12, way)
            for key in ["logical_bytes", "sector_bytes", "l2_bytes", "dram_bytes", "modelled_ms_shaders_in_turn",
                        "modelled_ms_fixed_function_at_once"]:
                self.assertAlmostEqual(sum(number(frame[key]) for frame in frames) / len(frames) / number(technique[key]), 1, 12, key)

    def test_stage_numbers_equal_the_means_of_the_report(self):
        def add(sums, record, prefix=""):
            for key, value in record.items():
                if isinstance(value, dict):
                    add(sums, value, "" if key == "ops" else prefix + key + "_")
                elif not isinstance(value, str):
                    name = "ops" if key == "total" else prefix + key
                    sums[name] = sums.get(name, 0) + value

        expected = {}
        for result in self.report["results"]:
            for frame in result["frames"]:
                for stage in frame["stages"]:
                    add(expected.setdefault((result["technique"], stage["stage"]), {}), stage)
        for sums in expected.values():
            for key in sums:
                sums[key] /= 2  # frames
        quotient = lambda a, b: a / b if b else None
        for sums in expected.values():
            sums["ops_per_byte"] = quotient(sums["ops"], sums["logical_bytes"])
            sums["lane_use"] = quotient(sums["lanes_used"], sums["lanes_issued"])
        rows = table_rows(self.browser, "stages")
        self.assertEqual([(row["technique"][0], row["stage"][0]) for row in rows], list(expected))
        for row, sums in zip(rows, expected.values()):
            numbers = {key: float(value) if value else None for key, (value, _) in row.items()
                       if key not in ["technique", "stage"] and not key.startswith("busiest_unit_")}
            self.assertEqual(numbers, {key: sums.get(key) for key in numbers})
        last = {(result["technique"], stage["stage"]): stage
                for result in self.report["results"] for stage in result["frames"][-1]["stages"]}
        for row in rows:
            stage = last[row["technique"][0], row["stage"][0]]
            for way in ["shaders", "fixed_function"]:
                expected = limit(stage["busiest_unit"][way], stage["busiest_rate"][way]) if "busiest_unit" in stage else ""
                self.assertEqual(row[f"busiest_unit_{way}"][0], expected)

    def test_saved_work_is_that_of_the_stages(self):
        rows = {row["technique"][0]: row for row in table_rows(self.browser, "saved")}
        beam = next(result for result in self.report["results"] if result["technique"] == "beam:order=sorted")
        stages = {}
        for frame in beam["frames"]:
            for stage in frame["stages"]:
                of = stages.setdefault(stage["stage"], {"items_in": 0, "items_out": 0, "lanes_used": 0})
                for key in of:
                    of[key] += stage[key]
        raster, fragment = stages["conservative_raster"], stages["beam_fragment"]
        whole = stages["compose"]["items_in"] - fragment["items_out"]
        expected = {"hidden_pairs": raster["lanes_used"] - raster["items_out"], "whole_pixels": whole,
                    "pairs_behind_closed": stages["a_buffer"]["items_out"] - fragment["items_in"] - whole}
        self.assertEqual({key: 2 * float(rows["beam:order=sorted"][key][0]) for key in expected}, expected, "two frames")
        self.assertGreater(min(expected.values()), 0)

    def test_csv_files_hold_the_same(self):
        for name in ["techniques", "framebuffer", "stages", "saved", "frames"]:
            lines, rows = self.csv_table(name), table_rows(self.browser, name)
            self.assertEqual(len(lines), len(rows))
            for line, row in zip(lines, rows):
                self.assertEqual(list(line), list(row))
                for key, text in line.items():
                    value = row[key][0]
                    self.assertTrue(text == value or float(text) == float(value), f"{name} {key}: {text} and {value}")

    def test_plots_hold_every_technique(self):
        for name in ["storage", "speed_shaders"]:
            tips = self.browser.run("""return [...document.querySelectorAll(`[data-plot=${arguments[0]}] .point`)]
                                           .map((point) => point.dataset.tip.split("\\n")[0])""", name)
            self.assertEqual(sorted(tips), sorted(TECHNIQUES))
        self.assertEqual(self.browser.run("""return [...document.querySelectorAll("[data-plot=dram_bytes] .bar")]
                                                 .map((bar) => bar.dataset.tip.split(":").slice(0, -1).length)""").__len__(),
                         len(TECHNIQUES))
        tips = self.browser.run("""return [...document.querySelectorAll("[data-plot=time_shaders] .part")]
                                       .map((part) => part.dataset.tip)""")
        self.assertTrue(tips and all("\nlimited by " in tip for tip in tips), tips)
        plots = {path.stem for path in (self.folder / "plots").iterdir()}
        self.assertLessEqual({"frontier", "storage", "speed", "time_shaders", "causes", "logical_bytes", "roofline_beam_order=sorted", "roofline_msaa_8"}, plots)
        self.assertIn(">msaa:8<", (self.folder / "plots" / "frontier.svg").read_text())

    def test_plots_hold_the_numbers_of_the_report(self):
        figures = {choice["plot"]["name"]: choice["plot"] for choice in
                   self.browser.run("return data.figures.flatMap((figure) => figure.choices)")}
        points = lambda name: {point["label"]: (point["x"], point["y"])
                               for series in figures[name]["series"] for point in series["points"]}
        times = {"speed": lambda frame: frame["wall_ms"]["median"],
                 "speed_shaders": lambda frame: frame["modelled_ms"]["shaders"]["at_once"],
                 "speed_fixed_function": lambda frame: frame["modelled_ms"]["fixed_function"]["at_once"]}
        for name, time in times.items():
            found = points(name)
            self.assertEqual(set(found), set(self.results))
            for technique, result in self.results.items():
                self.assertAlmostEqual(found[technique][0], mean(result, time), 9, f"{name} {technique}")
                self.assertEqual(found[technique][1], result["error"]["rmse"], f"{name} {technique}")
        for name in ["logical", "sector", "dram"]:
            plot = figures[name + "_bytes"]
            self.assertEqual(plot["categories"], list(self.results))
            for i, result in enumerate(self.results.values()):
                self.assertAlmostEqual(sum(part["values"][i] for part in plot["parts"]),
                                       mean(result, lambda frame: frame[name + "_bytes"]) / 1e6, 9, f"{name} {i}")
        for way in ["shaders", "fixed_function"]:
            plot = figures["time_" + way]
            self.assertEqual(plot["categories"], list(self.results))
            for i, result in enumerate(self.results.values()):
                self.assertAlmostEqual(sum(part["values"][i] for part in plot["parts"]),
                                       mean(result, lambda frame: frame["modelled_ms"][way]["in_turn"]), 12)
                self.assertAlmostEqual(plot["marks"]["values"][i],
                                       mean(result, lambda frame: frame["modelled_ms"][way]["at_once"]), 12)
        split = figures["causes"]
        for i, spec in enumerate(split["categories"]):
            self.assertEqual({part["name"]: part["values"][i] for part in split["parts"]},
                             {cause: 100 * part for cause, part in self.results[spec]["error_causes"].items()})
        for technique, result in self.results.items():
            found = points("roofline_" + technique.replace(":", "_"))
            for at, stage in enumerate(result["frames"][0]["stages"]):
                total = lambda value: sum(value(frame["stages"][at]) for frame in result["frames"])
                ops, dram = total(lambda s: s["ops"]["total"]), total(lambda s: s["dram_bytes"])
                ms = total(lambda s: s["modelled_ms"]["shaders"])
                units = self.report["hardware"]["implementations"]["shaders"]["units"]
                is_in_shaders = {"shader", "shading"} & set(units[stage["stage"].removeprefix("prepass_")])
                if ops and ms and is_in_shaders:
                    if dram:
                        self.assertAlmostEqual(found[stage["stage"]][0] / (ops / dram), 1, 9)
                    self.assertAlmostEqual(found[stage["stage"]][1] / (ops / ms / 1e6), 1, 9)
                else:
                    self.assertNotIn(stage["stage"], found)

    def test_each_stage_and_technique_has_one_colour(self):
        stages, techniques = {}, {}
        for card in self.browser.run("return data.summary.cards"):
            techniques.setdefault(card["technique"], set()).add(card["color"])
        for plot in self.browser.run("return data.figures.flatMap((figure) => figure.choices.map((choice) => choice.plot))"):
            is_stage = plot["kind"] == "bars" and plot["name"] != "causes" or plot["name"].startswith("roofline")
            if plot["name"] == "causes":
                continue
            for item in plot.get("parts", plot.get("series")):
                if item["name"].startswith("roof:"):
                    continue
                name = item["name"] if item["name"] != "msaa" else "msaa:8"
                (stages if is_stage else techniques).setdefault(name, set()).add(item["color"])
        self.assertGreater(len(stages), 8)
        for found in [stages, techniques]:
            for name, colors in found.items():
                self.assertEqual(len(colors), 1, name)
        self.assertEqual(len({color for colors in stages.values() for color in colors}), len(stages))

    def test_divider_moves_by_keyboard_and_pointer(self):
        left, right = [self.pixel(x, 0.5) for x in (0.48, 0.52)]
        self.browser.press("#divider", KEYS["end"])
        self.wait_for_frame()
        all_left = self.pixel(0.25, 0.5), self.pixel(0.75, 0.5)
        self.browser.press("#divider", KEYS["home"])
        self.wait_for_frame()
        all_right = self.pixel(0.25, 0.5), self.pixel(0.75, 0.5)
        self.assertNotEqual(all_left, all_right)
        self.browser.press("#divider", KEYS["right"] * 3)
        self.assertEqual(self.value_of("divider"), "3")

        box = self.browser.run("const b = document.getElementById('compare').getBoundingClientRect();"
                               "return [b.left, b.top + window.scrollY, b.width, b.height]")
        self.browser.run("window.scrollTo(0, arguments[0])", box[1] - 100)
        x, y = round(box[0] + 0.003 * box[2]), round(100 + box[3] / 2)
        move = lambda to: {"type": "pointerMove", "x": to, "y": y, "duration": 0}
        self.browser.send("POST", "/actions", {"actions": [{"type": "pointer", "id": "mouse", "actions": [
            move(x), {"type": "pointerDown", "button": 0}, move(x + 50), move(round(box[0] + 0.6 * box[2])),
            {"type": "pointerUp", "button": 0}]}]})
        self.assertAlmostEqual(float(self.value_of("divider")), 600, delta=5)
        self.assertEqual(self.browser.run("return view.k"), 1, "the divider moves, not the picture")

    def test_all_pictures_zoom_together_down_to_single_pixels(self):
        self.browser.press("#compare", "+" * 12)
        self.wait_for_frame()
        zooms = self.browser.run("return [...document.querySelectorAll('main canvas')].map((canvas) => canvas.__zoom.k)")
        self.assertEqual(len(zooms), 1 + len(TECHNIQUES))
        self.assertEqual(len(set(zooms)), 1, zooms)
        size = self.browser.run("return document.getElementById('compare').clientWidth") * zooms[0] / 96
        self.assertGreaterEqual(size, 32, "CSS pixels that one pixel takes")
        self.browser.press("#compare", KEYS["left"] + KEYS["right"] * 2)
        self.assertRegex(self.browser.run("return document.getElementById('readout').textContent"),
                         r"^pixel \(49, 27\).*beam:order=sorted: picture sRGB \d+ \d+ \d+.*reference: picture sRGB")
        self.browser.press("#compare", "0")
        self.assertEqual(self.browser.run("return view.k"), 1)

    def test_pictures_are_those_of_the_files_and_have_more_levels(self):
        for result in self.report["results"]:
            png = base64.b64encode((self.folder / result["frames"][0]["picture"]).read_bytes()).decode()
            off, levels = self.browser.send("POST", "/execute/async", {"args": [result["technique"], png], "script": """
                const [technique, png, done] = arguments;
                Promise.all([loadPicture(technique, 0), decode("data:image/png;base64," + png)]).then(([layer, file]) => {
                  const shown = layer.canvas.getContext("2d").getImageData(0, 0, layer.width, layer.height).data, levels = new Set();
                  let off = 0;
                  for (let i = 0; i < shown.length; ++i) off = Math.max(off, Math.abs(shown[i] - file.rgba[i]));
                  for (let i = 0; i < layer.width * layer.height; ++i) levels.add(layer.linearAt(i, 0));
                  done([off, levels.size]);
                })"""})
            self.assertLessEqual(off, 1, result["technique"])
            if result["technique"] == "reference":
                self.assertGreater(levels, 256)

    def test_exposure_makes_pictures_brighter(self):
        before = self.pixel(0.25, 0.1)
        self.set_value("#exposure", 1, "input")
        self.assertEqual(self.texts("#exposure-text"), ["+1 EV"])
        linear = lambda byte: byte / 255 / 12.92 if byte <= 10 else ((byte / 255 + 0.055) / 1.055) ** 2.4
        for was, now in zip(before, self.pixel(0.25, 0.1)):
            self.assertAlmostEqual(linear(now), min(1, 2 * linear(was)), delta=0.02)
        self.browser.press("#compare", "EEEE")
        self.assertEqual(self.value_of("exposure"), "-1")

    def test_difference_shows_the_error(self):
        self.set_value("#left-technique", "msaa:8")
        self.set_value("#mode", "absolute")
        mean = self.browser.run("""
            const [left, right] = ["msaa:8", "reference"];
            return Promise.all([loadPicture(left, 0), loadPicture(right, 0)]).then(([a, b]) => {
              let squares = 0;
              for (let i = 0; i < a.width * a.height; ++i)
                for (let c = 0; c < 3; ++c) squares += (a.linearAt(i, c) - b.linearAt(i, c)) ** 2;
              return squares / (3 * a.width * a.height);
            })""")
        frame = self.report["results"][TECHNIQUES.index("msaa:8")]["frames"][0]
        self.assertAlmostEqual(mean ** 0.5, frame["error"]["rmse"], delta=1e-4 * frame["error"]["rmse"] + 1e-5)
        self.assertTrue(self.browser.run("return document.getElementById('divider').disabled"))
        self.set_value("#exposure", 10, "input")
        bright = [self.pixel((x + 0.5) / 96, 27.5 / 54) for x in range(96)]
        self.assertIn([255, 255, 255], bright, "edges are wrong")
        self.set_value("#mode", "signed")
        self.assertRegex(self.texts("#side-legends")[0], r"^left − right.*Red: the left picture is brighter\.")
        self.browser.press("#compare", KEYS["left"])
        self.assertRegex(self.texts("#readout")[0], r"left − right: -?\d\.\d{5} -?\d\.\d{5} -?\d\.\d{5}$")

    def test_frames_are_chosen_by_a_slider(self):
        self.assertEqual(self.browser.run("return [document.getElementById('frame').max, currentFrame().frame]"), ["1", 0])
        first = [self.pixel(x / 20, 0.5) for x in range(1, 20)]
        self.set_value("#frame", 1, "input")
        self.assertEqual(self.texts("#frame-text"), ["1"])
        self.assertNotEqual([self.pixel(x / 20, 0.5) for x in range(1, 20)], first)
        frame = self.report["results"][0]["frames"][1]
        mean = self.browser.run("return loadLayer(arguments[0], 'fragments').then((layer) => layer.mean)", TECHNIQUES[0])
        self.assertAlmostEqual(mean, frame["pixel_counters"]["fragments"]["mean"], 6)

    def test_a_click_opens_the_record_of_a_pixel_or_says_how_to_get_it(self):
        self.click_pixel(48 - 20, 27)
        command = f"beampipe inspect {self.trace} --pixel 28,27 -t {TECHNIQUES[0]}"
        self.assertIn("was not recorded", self.texts("#picture-record")[0])
        self.assertEqual(self.texts("#picture-record code"), [command])
        output = subprocess.run([BEAMPIPE, *command.split()[1:]], check=True, stdout=subprocess.PIPE, text=True).stdout
        self.assertIn("pixel 28,27", output)

        self.set_value("#divider", 1000, "input")
        self.click_pixel(48, 27)
        self.browser.wait_until("return document.querySelector('#picture-record #inspection img')?.naturalWidth > 500")
        self.assertIn(f"pixel 48,27 of {TECHNIQUES[0]}, frame 0", self.texts("#inspection figcaption")[0])
        self.set_value("#divider", 0, "input")
        self.click_pixel(48, 27)
        self.assertIn("has no histories of reference", self.texts("#picture-record")[0])

        self.set_value("#frame", 1, "input")
        self.set_value("#divider", 1000, "input")
        self.click_pixel(10, 10)
        self.assertEqual(self.texts("#picture-record code"),
                         [f"beampipe inspect {self.trace} --frame 1 --pixel 10,10 -t {TECHNIQUES[0]}"])

    def test_maps_of_causes_have_two_sides_and_one_scale(self):
        causes = [kind for kind in self.browser.run("return currentFrame().kinds.map((kind) => kind.name)") if kind.startswith("cause_")]
        self.assertEqual(len(causes), 7)
        most = max(abs(end) for frame in self.browser.run("return data.layers") for technique in frame["techniques"]
                   for each in technique["maps"] if each["name"] in causes for end in [each["low"], each["high"]])
        for log in [True, False]:
            self.browser.run("document.getElementById('map-log').checked = arguments[0]", log)
            for kind in causes:
                ends = self.browser.run("const s = scaleOf(arguments[0]); return [0, 0.5, 1].map((part) => s.value(part))", kind)
                for found, expected in zip(ends, [-most, 0, most]):
                    self.assertAlmostEqual(found, expected, delta=1e-9 * most)
        parts = self.browser.run("const s = (document.getElementById('map-log').checked = true, scaleOf('cause_mask'));"
                                 "return [0.01, 0.1, 1].map((part) => s.part(part * arguments[0]))", most)
        self.assertGreater(parts[1] - parts[0], 0.1, "logarithmic")
        self.set_value("#map-kind", "cause_mask")
        self.assertEqual(self.texts("#map-grid figcaption b"), ["beam:order=sorted", "alpha"])
        self.assertEqual(self.browser.run("return document.querySelectorAll('#maps [data-plot=causes] .bar').length"), 2,
                         "the split is beside the maps")

    def test_heatmap_values_are_those_of_the_counters(self):
        kinds = self.browser.run("return [...document.getElementById('map-kind').options].map((option) => option.value)")
        self.assertEqual([kind for kind in kinds if not kind.startswith("cause_")][:4], ["error", "fragments", "bytes", "merges"])
        mean, high = self.browser.run("""
            return loadLayer("msaa:8", "error").then((layer) => {
              let squares = 0, high = 0;
              for (let y = 0; y < layer.height; ++y) for (let x = 0; x < layer.width; ++x) {
                const value = Number(layer.valueAt(x, y));
                squares += value * value;
                high = Math.max(high, value);
              }
              return [squares / (layer.width * layer.height), high];
            })""")
        frame = self.report["results"][TECHNIQUES.index("msaa:8")]["frames"][0]
        self.assertAlmostEqual(mean ** 0.5, frame["error"]["rmse"], delta=1e-5 + 1e-3 * frame["error"]["rmse"])
        self.assertLessEqual(high, frame["error"]["max"])
        for result in self.report["results"]:
            for name, stats in result["frames"][0].get("pixel_counters", {}).items():
                layer = self.browser.run("return loadLayer(arguments[0], arguments[1]).then(({ mean, high }) => [mean, high])",
                                         result["technique"], name)
                for found, expected in zip(layer, [stats["mean"], stats["max"]]):
                    self.assertAlmostEqual(found, expected, delta=stats["max"] / 65535, msg=f"{result['technique']} {name}")

    def test_worst_pixels_open_their_histories(self):
        recorded = [pixel for result in self.report["results"] if "inspections" in result
                    for pixel in json.loads((self.folder / result["inspections"]).read_text())["pixels"]]
        self.assertEqual([pixel["technique"] for pixel in recorded], [spec for spec in TECHNIQUES for _ in range(4)],
                         "the two worst pixels, and the one that was asked for in both frames")
        rows = self.browser.run("""return [...document.querySelectorAll("#inspections tbody tr")]
                                       .map((row) => [...row.children].map((cell) => cell.textContent))""")
        self.assertEqual([row[:3] for row in rows],
                         [[f"{pixel['x']}, {pixel['y']}", pixel["technique"], str(pixel["frame"])] for pixel in recorded])
        for i in [0, len(rows) - 1]:
            self.browser.run("document.querySelectorAll('#inspections tbody button')[arguments[0]].click()", i)
            self.browser.wait_until("return document.querySelector('#inspection img').naturalWidth > 500")
            text = self.browser.run("return document.querySelector('#inspection pre').textContent")
            self.assertIn(f"pixel {recorded[i]['x']},{recorded[i]['y']} of fence.json", text)
            self.assertIn(f"with {recorded[i]['technique']}\n", text)
            self.assertEqual(self.browser.run("return document.querySelectorAll('#inspections [aria-pressed=true]').length"), 1)
        self.assertLessEqual(max(pixel["error"] for pixel in recorded),
                             max(frame["error"]["max"] for result in self.report["results"] for frame in result["frames"]))

    def test_tables_sort(self):
        values = lambda: [float(row["rmse"][0]) for row in table_rows(self.browser, "techniques")]
        title = "#table-techniques thead th:nth-child(%d) button" % (
            1 + list(table_rows(self.browser, "techniques")[0]).index("rmse"))
        self.browser.click(title)
        self.assertEqual(values(), sorted(values()))
        self.browser.click(title)
        self.assertEqual(values(), sorted(values(), reverse=True))

    def test_every_column_tells_unit_and_meaning(self):
        tips = self.browser.run("return [...document.querySelectorAll('thead button')].map((button) => button.dataset.tip)")
        self.assertGreater(len(tips), 20)
        for tip in tips:
            self.assertRegex(tip, r"^[A-Z].{10,}\.(\nUnit: .+)?$")
        self.browser.run("document.querySelector('#table-techniques thead th:nth-child(2) button').focus()")
        self.assertEqual(self.browser.run("const tip = document.getElementById('tip');"
                                          "return [tip.hidden, tip.textContent]"), [False, tips[1]])

    def test_tables_fit_the_window(self):
        for width in [1440, 390]:
            self.assert_fits(width)

    def test_tables_show_one_view_at_a_time(self):
        shown = lambda: self.browser.run("""return [...document.querySelectorAll("#table-techniques thead th")]
                                                .filter((head) => head.checkVisibility()).map((head) => head.dataset.view)""")
        self.assertEqual(set(shown()), {"", "accuracy"})
        self.browser.run("document.querySelectorAll('#table-techniques .views button')[1].click()")
        self.assertEqual(set(shown()), {"", "memory"})
        self.assertEqual(self.browser.run("return document.querySelectorAll('#table-techniques .views [aria-pressed=true]').length"), 1)

    def test_fits_a_phone(self):
        self.browser.resize(360, 740)
        self.wait_for_frame()
        self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), 360)
        self.assertGreaterEqual(self.browser.run("return parseFloat(getComputedStyle(document.querySelector('svg text'))"
                                                 ".fontSize) * document.querySelector('svg').clientWidth /"
                                                 " document.querySelector('svg').viewBox.baseVal.width"), 10)
        for table, (head, box) in self.browser.run(
                "return Object.fromEntries([...document.querySelectorAll('table')].map((table, i) =>"
                " [table.id || i, [table.querySelector('tbody th')?.clientWidth ?? 0, table.parentElement.clientWidth]]))"
        ).items():
            self.assertLessEqual(head, 0.6 * box, table)

    def test_light_and_dark(self):
        paper = lambda: self.browser.run("return getComputedStyle(document.body).backgroundColor")
        self.assertEqual(paper(), "rgb(255, 255, 255)")
        self.browser.color_scheme("dark")
        dark = paper()
        self.assertLess(max(int(c) for c in re.findall(r"\d+", dark)), 60)
        self.browser.click("#theme")
        self.assertEqual(paper(), "rgb(255, 255, 255)", "light by choice")


class RunPage(PageTest):
    """A run without errors, of a trace that published figures are about."""
    scene = ["classroom", "--width", "1280", "--height", "720"]
    command = ["run", "-t", "msaa:1,prepass", "-t", "msaa:8,color=rgba16f,prepass", "-t", "acaa:8"]

    def test_has_costs_stages_pictures_and_counters(self):
        self.assertEqual(self.texts(".card h3"), ["msaa:1,prepass baseline", "msaa:8,color=rgba16f,prepass", "acaa:8"])
        self.assertEqual(list(self.card("acaa:8")), ["DRAM", "on chip", "off chip", "time"])
        self.assertEqual(self.plots(), ["time_shaders", "dram_bytes", "roofline_msaa_1_prepass"])
        self.assertEqual(self.value_of("right-technique"), "msaa:8,color=rgba16f,prepass")
        self.assertEqual(self.texts("#maps h2"), ["What happens in each pixel?"])
        self.assertEqual(self.texts("#inspections"), [])
        self.assertEqual(self.texts("nav a"), ["Cost", "Time", "Pictures", "Maps", "Tables"])
        self.assertFalse(self.browser.run("return document.getElementById('frames').checkVisibility()"), "there is one frame")
        self.click_pixel(20, 20)
        [command] = self.texts("#picture-record code")
        hit = re.fullmatch(f"beampipe inspect {re.escape(str(self.trace))} --pixel (\\d+),(\\d+) -t msaa:1,prepass", command)
        self.assertTrue(hit, command)
        for at in hit.groups():  # pixels are smaller than those of the screen
            self.assertLessEqual(abs(int(at) - 20), 2)

    def test_claims_are_those_about_this_trace(self):
        rows = [{key: value for key, (value, _) in row.items()} for row in table_rows(self.browser, "claims")]
        rendered = [claim for claim in self.report["claims"] if claim["kind"] == "rendered"]
        self.assertEqual(len(rows), 7)
        self.assertEqual([row["claim"] for row in rows], [claim["name"] for claim in rendered])
        for row, claim in zip(rows, rendered):
            self.assertIn("ACAA", row["claim"])
            self.assertEqual(float(row["ours"]), claim["ours"])
            for key in ["unit", "published_low", "published_high", "per_cent", "source", "beside", "command"]:
                self.assertEqual(row[key], str(claim[key]) if isinstance(claim[key], str) else row[key])
                if not isinstance(claim[key], str):
                    self.assertEqual(float(row[key]), claim[key])
        self.assertEqual([line["claim"] for line in self.csv_table("claims")], [row["claim"] for row in rows])

    def test_tables_fit_the_window(self):
        for width in [1440, 390]:
            self.assert_fits(width)


class ComparisonWithoutMsaa(PageTest):
    scene = ["fence", "--width", "64", "--height", "36"]
    command = ["compare", "--ladder", "1,8", "-t", "alpha", "beam"]

    def test_the_first_technique_is_the_baseline(self):
        self.assertEqual(self.texts(".card h3"), ["alpha baseline", "beam"])
        self.assertIn("multiples are of alpha", self.texts("#cost-note")[0])
        self.assertEqual(self.value_of("right-technique"), "reference")


class ComparisonOfOneTechnique(PageTest):
    scene = ["fence", "--width", "64", "--height", "36"]
    command = ["compare", "--ladder", "1,8", "--no-memory-model", "-t", "beam"]

    def test_has_neither_multiples_nor_modelled_times(self):
        self.assertEqual(self.texts(".card h3"), ["beam baseline"])
        self.assertEqual(list(self.card("beam")), ["on chip", "off chip", "RMSE", "EMR"])
        self.assertNotIn("multiples", self.texts("#cost-note")[0])
        self.assertFalse(self.browser.run("return document.getElementById('implementations').checkVisibility()"))
        self.assertEqual(self.plots(), ["storage", "speed", "logical_bytes", "roofline_beam"])


class OverviewPage(PageTest):
    scene = ["fence", "--width", "64", "--height", "36"]
    command = ["run", "-t", "msaa:8", "beam"]

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        for command in [["run", cls.trace, "-t", "beam", "alpha", "-o", f"{cls.scratch.name}/a #2"],
                        ["report", f"{cls.scratch.name}/a #2"],
                        ["report", f"{cls.scratch.name}/a #2", str(cls.folder), "-o", f"{cls.scratch.name}/all.html"]]:
            subprocess.run([BEAMPIPE, *command], check=True, stdout=subprocess.DEVNULL)

    def setUp(self):
        super().setUp()
        self.browser.open(self.folder.parent / "all.html")

    def test_has_what_several_runs_share(self):
        self.assertEqual(self.texts("h1"), ["Overview of 2 runs beampipe report"])
        self.assertEqual(self.texts("nav a"), ["Cost", "Tables"])
        self.assertEqual(self.plots(), ["times_shaders"])
        links = self.browser.run("return [...document.querySelectorAll('#table-runs a')].map((link) => link.href)")
        self.assertEqual(links, [(self.folder.parent / name / "report.html").as_uri() for name in ["a #2", "out"]])

    def test_times_sort_by_number(self):
        beam, alpha, msaa = table_rows(self.browser, "time_shaders")
        self.assertEqual((alpha["in_turn_1"][1], msaa["in_turn_0"][1], alpha["in_turn_mean_0"][1]), ("–", "–", "–"))
        self.assertRegex(beam["in_turn_0"][1], r"^[\d.]+ \([\d.]+ to [\d.]+\)$")
        self.browser.run("document.querySelectorAll('#table-time_shaders thead button')[1].click()")
        values = [row["in_turn_0"][0] for row in table_rows(self.browser, "time_shaders")]
        self.assertEqual(values[2], "", "empty cells come last")
        self.assertLess(float(values[0]), float(values[1]))

    def test_fits_a_telephone(self):
        self.assert_fits(390)


def main():
    try:
        PageTest.browser = Browser()
    except CannotStart as error:
        sys.exit(f"report_page_test.py: {error}")
    try:
        unittest.main(argv=sys.argv[:1])
    finally:
        PageTest.browser.close()


if __name__ == "__main__":
    main()
