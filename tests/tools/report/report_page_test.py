#!/usr/bin/env python3
"""Tests the report page in a browser, headless Chromium, through chromedriver.

usage: report_page_test.py BEAMPIPE CHROMIUM CHROMEDRIVER [SECONDS]

Chromedriver, and then Chromium, may each take SECONDS to start (60 by default). If one does not start, the test ends with
one line that says why.
"""

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

    def send(self, method, path, body=None, limit=60):
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


class ReportPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.folder = pathlib.Path(cls.scratch.name) / "out"
        trace = str(cls.folder.parent / "fence.json")
        for arguments in [["make", "fence", "--width", "96", "--height", "54", "--frames", "2", "--orbit", "3", "-o", trace],
                          ["compare", trace, "-o", str(cls.folder), "--ladder", "1,8", "--inspect", "48,27",
                           "--inspect-worst", "2", "-t", *TECHNIQUES],
                          ["report", str(cls.folder)]]:
            subprocess.run([BEAMPIPE, *arguments], check=True, stdout=subprocess.DEVNULL)
        cls.report = json.loads((cls.folder / "report.json").read_text())

    def setUp(self):
        self.browser.resize(1280, 900)
        self.browser.color_scheme("light")
        self.browser.open(self.folder / "report.html")

    def tearDown(self):
        self.assertEqual(self.browser.console(), [], "messages in the browser's console")

    def pixel(self, x, y):
        """The colour of a place on the canvas; x and y are parts of its width and height."""
        return self.browser.run("""
            const canvas = document.getElementById("compare"), copy = make("canvas", { width: 1, height: 1 });
            copy.getContext("2d").drawImage(canvas, -arguments[0] * canvas.width, -arguments[1] * canvas.height);
            return [...copy.getContext("2d").getImageData(0, 0, 1, 1).data].slice(0, 3)""", x, y)

    def wait_for_frame(self):
        self.browser.send("POST", "/execute/async", {"args": [], "script": """
            const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done()))"""})

    def test_needs_no_network(self):
        page = (self.folder / "report.html").read_text()
        self.assertEqual(re.findall(r"""(?:src|href)\s*=\s*["'](?!#|data:)[^"']*""", page[:page.index("<script>")]), [])
        self.assertEqual(self.browser.run("return performance.getEntriesByType('resource')"
                                          ".map((entry) => entry.name).filter((name) => !name.startsWith('data:'))"), [])

    def test_technique_numbers_equal_the_report(self):
        rows = {row["technique"][0]: row for row in table_rows(self.browser, "techniques")}
        self.assertEqual(list(rows), TECHNIQUES + ["reference"])
        for result in self.report["results"]:
            row = rows[result["technique"]]
            for key, expected in [("rmse", result["error"]["rmse"]), ("bias", result["error"]["bias"]),
                                  ("p99", result["error"]["p99"]), ("max", result["error"]["max"]),
                                  ("emr", result["equivalent_msaa"]),
                                  ("framebuffer_bytes_per_pixel", result["framebuffer_bytes_per_pixel"]),
                                  ("peak_bytes_per_pixel", result["peak_bytes_per_pixel"]),
                                  ("a_buffer_peak_bytes", result["a_buffer_peak_bytes"])]:
                value, text = row[key]
                self.assertEqual(float(value), expected, key)
                shown = float(text.replace("\u202f", ""))
                self.assertLessEqual(abs(shown - expected), 0.0005 * abs(expected), f"{key} is shown as {text}")
            bound = "at least" if result["equivalent_msaa_is_lower_bound"] else "exact"
            self.assertEqual(row["emr_bound"][0], bound)
            mean = lambda value: sum(value(frame) for frame in result["frames"]) / len(result["frames"])
            self.assertAlmostEqual(float(row["wall_ms"][0]), mean(lambda frame: frame["wall_ms"]["median"]), 9)
            if result["technique"] == "reference":
                self.assertEqual(row["dram_bytes"], ("", "–"), "it is not for hardware")
            else:
                self.assertEqual(float(row["dram_bytes"][0]), mean(lambda frame: frame["dram_bytes"]))
            for way in ["shaders", "fixed_function"]:
                for kind in ["overlap", "sum"]:
                    value, text = row[f"modelled_ms_{way}_{kind}"]
                    if result["technique"] == "reference":
                        self.assertEqual((value, text), ("", "–"), "it is not for hardware")
                    else:
                        self.assertAlmostEqual(float(value), mean(lambda frame: frame["modelled_ms"][way][kind]), 12)

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

    def test_frames_framebuffers_and_claims_equal_the_report(self):
        members = lambda key: [{**member, "technique": result["technique"]}
                               for result in self.report["results"] for member in result[key]]
        plain = lambda *keys: {key: lambda record, key=key: record.get(key) for key in keys}
        self.assert_rows("framebuffer", members("framebuffer"),
                         {**plain("technique", "format", "bytes_per_pixel"), "surface": lambda record: record["name"]})
        self.assert_rows("claims", self.report["claims"],
                         {**plain("unit", "published_low", "published_high", "ours", "difference", "kind", "source", "beside",
                                  "command"), "claim": lambda record: record["name"]})
        of = lambda *path: lambda record: functools.reduce(lambda at, key: (at or {}).get(key), path, record)
        self.assert_rows("frames", members("frames"), {
            **plain("technique", "a_buffer_peak_bytes", "logical_bytes", "sector_bytes", "l2_bytes", "dram_bytes", "flicker"),
            "frame": of("index"), "wall_ms": of("wall_ms", "median"), "wall_ms_min": of("wall_ms", "min"),
            "wall_ms_max": of("wall_ms", "max"), "runs": of("wall_ms", "runs"), "rmse": of("error", "rmse"),
            "bias": of("error", "bias"),
            **{f"modelled_ms_{way}_{kind}": of("modelled_ms", way, kind)
               for way in ["shaders", "fixed_function"] for kind in ["overlap", "sum"]}})

    def test_memory_of_headline_and_frontier_has_the_a_buffer_in_it(self):
        results = {result["technique"]: result for result in self.report["results"] if result["technique"] != "reference"}
        for result in results.values():
            pixels = 96 * 54
            most = max(frame["a_buffer_peak_bytes"] for frame in result["frames"])
            surfaces = sum(surface["bytes_per_pixel"] for surface in result["framebuffer"])
            self.assertAlmostEqual(result["peak_bytes_per_pixel"], surfaces + most / pixels, 9)
        self.assertGreater(results["beam:order=sorted"]["a_buffer_peak_bytes"], 0)

        cards = self.browser.run("return [...document.querySelectorAll('#summary .card')].map((card) => card.textContent)")
        number = lambda value: self.browser.run("return numberText(arguments[0])", value)
        best = lambda of: min(of, key=lambda result: result["error"]["rmse"])
        frugal = best([result for result in results.values() if result["peak_bytes_per_pixel"] <= 80])
        for card, result in [(cards[0], best(results.values())), (cards[-1], frugal)]:
            self.assertIn(result["technique"], card)
            self.assertIn(f"Takes {number(result['peak_bytes_per_pixel'])} bytes per pixel", card)

        points = dict(self.browser.run("""return [...document.querySelectorAll("[data-plot=frontier] .point")]
                                              .map((point) => [point.dataset.tip.split("\\n")[0], point.__data__.x])"""))
        self.assertEqual(points, {spec: result["peak_bytes_per_pixel"] for spec, result in results.items()})

    def test_stage_numbers_equal_the_sums_of_the_report(self):
        def add(sums, record, prefix=""):
            for key, value in record.items():
                if isinstance(value, dict):
                    add(sums, value, "" if key == "ops" else key + "_")
                elif key != "stage":
                    name = "ops" if key == "total" else prefix + key
                    sums[name] = sums.get(name, 0) + value

        expected = {}
        for result in self.report["results"]:
            for frame in result["frames"]:
                for stage in frame["stages"]:
                    add(expected.setdefault((result["technique"], stage["stage"]), {}), stage)
        quotient = lambda a, b: a / b if b else None
        for sums in expected.values():
            sums["ops_per_byte"] = quotient(sums["ops"], sums["logical_bytes"])
            sums["lane_use"] = quotient(sums["lanes_used"], sums["lanes_issued"])
        rows = table_rows(self.browser, "stages")
        self.assertEqual([(row["technique"][0], row["stage"][0]) for row in rows], list(expected))
        for row, sums in zip(rows, expected.values()):
            self.assertEqual({key: float(value) if value else None for key, (value, _) in row.items()
                              if key not in ["technique", "stage"]},
                             {key: sums.get(key) for key in row if key not in ["technique", "stage"]})

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
        self.assertEqual({key: int(rows["beam:order=sorted"][key][0]) for key in expected}, expected)
        self.assertGreater(min(expected.values()), 0)

    def test_csv_files_hold_the_same(self):
        for name in ["techniques", "framebuffer", "stages", "saved", "frames", "claims"]:
            with open(self.folder / "tables" / f"{name}.csv", newline="") as file:
                lines = list(csv.DictReader(file))
            rows = table_rows(self.browser, name)
            self.assertEqual(len(lines), len(rows))
            for line, row in zip(lines, rows):
                self.assertEqual(list(line), list(row))
                for key, text in line.items():
                    value = row[key][0]
                    self.assertTrue(text == value or float(text) == float(value), f"{name} {key}: {text} and {value}")

    def test_plots_hold_every_technique(self):
        for name in ["frontier", "speed"]:
            tips = self.browser.run("""return [...document.querySelectorAll(`[data-plot=${arguments[0]}] .point`)]
                                           .map((point) => point.dataset.tip.split("\\n")[0])""", name)
            self.assertEqual(sorted(tips), sorted(TECHNIQUES))
        self.assertEqual(self.browser.run("""return [...document.querySelectorAll("[data-plot=logical_bytes] .bar")]
                                                 .map((bar) => bar.dataset.tip.split(":").slice(0, -1).length)""").__len__(),
                         len(TECHNIQUES))
        plots = {path.stem for path in (self.folder / "plots").iterdir()}
        self.assertLessEqual({"frontier", "speed", "logical_bytes", "roofline_beam_order=sorted", "roofline_msaa_8"}, plots)
        self.assertIn(">msaa:8<", (self.folder / "plots" / "frontier.svg").read_text())

    def test_plots_hold_the_numbers_of_the_report(self):
        results = {result["technique"]: result for result in self.report["results"] if result["technique"] != "reference"}
        mean = lambda result, value: sum(value(frame) for frame in result["frames"]) / len(result["frames"])
        figures = {choice["plot"]["name"]: choice["plot"] for choice in
                   self.browser.run("return data.figures.flatMap((figure) => figure.choices)")}
        points = lambda name: {point["label"]: (point["x"], point["y"])
                               for series in figures[name]["series"] for point in series["points"]}
        times = {"speed": lambda frame: frame["wall_ms"]["median"],
                 "speed_shaders": lambda frame: frame["modelled_ms"]["shaders"]["overlap"],
                 "speed_fixed_function": lambda frame: frame["modelled_ms"]["fixed_function"]["overlap"]}
        for name, time in times.items():
            found = points(name)
            self.assertEqual(set(found), set(results))
            for technique, result in results.items():
                self.assertAlmostEqual(found[technique][0], mean(result, time), 9, f"{name} {technique}")
                self.assertEqual(found[technique][1], result["error"]["rmse"], f"{name} {technique}")
        for name in ["logical", "sector", "dram"]:
            plot = figures[name + "_bytes"]
            self.assertEqual(plot["categories"], list(results))
            for i, result in enumerate(results.values()):
                self.assertAlmostEqual(sum(part["values"][i] for part in plot["parts"]),
                                       mean(result, lambda frame: frame[name + "_bytes"]) / 1e6, 9, f"{name} {i}")
        for technique, result in results.items():
            found = points("roofline_" + technique.replace(":", "_"))
            for at, stage in enumerate(result["frames"][0]["stages"]):
                total = lambda value: sum(value(frame["stages"][at]) for frame in result["frames"])
                ops, dram = total(lambda s: s["ops"]["total"]), total(lambda s: s["dram_bytes"])
                ms = total(lambda s: s["modelled_ms"]["shaders"])
                if ops and dram and ms:
                    self.assertAlmostEqual(found[stage["stage"]][0] / (ops / dram), 1, 9)
                    self.assertAlmostEqual(found[stage["stage"]][1] / (ops / ms / 1e6), 1, 9)
                else:
                    self.assertNotIn(stage["stage"], found)

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
        self.assertEqual(self.browser.run("return document.getElementById('divider').value"), "3")

        box = self.browser.run("const b = document.getElementById('compare').getBoundingClientRect();"
                               "return [b.left, b.top + window.scrollY, b.width, b.height]")
        self.browser.run("window.scrollTo(0, arguments[0])", box[1] - 100)
        x, y = round(box[0] + 0.003 * box[2]), round(100 + box[3] / 2)
        move = lambda to: {"type": "pointerMove", "x": to, "y": y, "duration": 0}
        self.browser.send("POST", "/actions", {"actions": [{"type": "pointer", "id": "mouse", "actions": [
            move(x), {"type": "pointerDown", "button": 0}, move(x + 50), move(round(box[0] + 0.6 * box[2])),
            {"type": "pointerUp", "button": 0}]}]})
        self.assertAlmostEqual(float(self.browser.run("return document.getElementById('divider').value")), 600, delta=5)
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

    def test_heatmap_values_are_those_of_the_counters(self):
        kinds = self.browser.run("return [...document.getElementById('map-kind').options].map((option) => option.value)")
        self.assertEqual(kinds[:4], ["error", "fragments", "bytes", "merges"])
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

    def test_fits_a_phone(self):
        self.browser.resize(360, 740)
        self.wait_for_frame()
        self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), 360)
        self.assertGreaterEqual(self.browser.run("return parseFloat(getComputedStyle(document.querySelector('svg text'))"
                                                 ".fontSize) * document.querySelector('svg').clientWidth /"
                                                 " document.querySelector('svg').viewBox.baseVal.width"), 10)

    def test_first_columns_leave_room_on_a_phone(self):
        self.browser.resize(360, 740)
        self.wait_for_frame()
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


def main():
    try:
        ReportPage.browser = Browser()
    except CannotStart as error:
        sys.exit(f"report_page_test.py: {error}")
    try:
        unittest.main(argv=sys.argv[:1])
    finally:
        ReportPage.browser.close()


if __name__ == "__main__":
    main()
