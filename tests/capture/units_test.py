"""Unit tests of tools/capture that need numpy and nothing else: `python3 units_test.py FOLDER_OF_TOOLS_CAPTURE`."""
import contextlib
import importlib.util
import io
import os
import pickle
import struct
import sys
import tempfile
import types
import unittest
import zlib
from unittest import mock

import numpy as np

sys.path.insert(0, sys.argv.pop(1) if len(sys.argv) > 1 else
                os.path.join(os.path.dirname(__file__), "../../tools/capture"))
sys.dont_write_bytecode = True
import api_state
import attempts
import clears
import failure
import frame
import geometry
import images
import meshes
import motion
import passes
import png
import spirv
import srgb
import state
import trace_file
import wide


class Attempts(unittest.TestCase):
    def outcome(self, *outcomes):
        """Of attempts that end so: the last one that is made, and how many there are."""
        left = list(outcomes)

        def attempt():
            end = left.pop(0)
            if isinstance(end, Exception):
                raise end
            return end
        try:
            return attempts.first_success(attempt), len(outcomes) - len(left)
        except attempts.Failure as error:
            return error, len(outcomes) - len(left)

    def test_early_crashes_are_tried_again_twice(self):
        crash, other = attempts.EarlyCrash("signal 11"), attempts.Failure("exit code 1")
        self.assertEqual(self.outcome("frame"), ("frame", 1))
        self.assertEqual(self.outcome(crash, crash, "frame"), ("frame", 3))
        self.assertEqual(self.outcome(crash, crash, crash, "frame"), (crash, 3))
        self.assertEqual(self.outcome(crash, other, "frame"), (other, 2))


def load_program():
    """tools/capture/__main__.py as a module."""
    spec = importlib.util.spec_from_file_location("capture_main", os.path.join(sys.path[0], "__main__.py"))
    program = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(program)
    return program


class Errors(unittest.TestCase):
    WORDS = ["-o", "a.json", "--", "true"]

    def outcome(self, error, debug=""):
        """(exit code, standard error) of a run that raises."""
        program = load_program()
        with (contextlib.redirect_stderr(io.StringIO()) as text, mock.patch.dict(os.environ, {program.DEBUG: debug}),
              mock.patch.object(program, "run", side_effect=error)):
            return program.main(self.WORDS), text.getvalue()

    def test_an_internal_error_is_one_line_unless_it_is_looked_for(self):
        code, text = self.outcome(ValueError("two\nlines"))
        self.assertEqual(code, 1)
        self.assertRegex(text, r"\Abeampipe: error: internal error: ValueError: two lines \([^\n]*\n\Z")
        with self.assertRaises(ValueError):
            self.outcome(ValueError("two\nlines"), debug="1")

    def test_what_is_expected_is_one_line_and_its_exit_code(self):
        for error, code in ((failure.Failure, 1), (attempts.EarlyCrash, 1), (failure.WrongUsage, 2),
                            (failure.MissingPackages, 3)):
            self.assertEqual(self.outcome(error("why\n not")), (code, "beampipe: error: why not\n"), error)


class Summaries(unittest.TestCase):
    """What is printed of a trace counts what is in it, in all of its frames."""

    def lines(self, frames, first=None):
        trace = {"source": {} if first is None else {"frame": first}, "images": {"captured": {}}, "programs": [{}],
                 "program_images": [{}], "meshes": {"quad": {"indices": {"count": 6}}, "one": {"indices": {"count": 3}}},
                 "frames": frames}
        return list(load_program().summary("a.json", trace, 1260000))

    def test_of_one(self):
        frame = {"width": 4, "height": 3, "draws": [{"mesh": "one"}], "left_out": []}
        self.assertEqual(self.lines([frame], 20), [
            "a.json: frame 20, 4 x 3 pixels, 1 draw, 1 triangle, 2 meshes, 1 fragment shader, 1 image, 1.3 MB"])

    def test_of_several(self):
        left_out = {"reason": "smooth lines", "draws": 1, "primitives": 1}
        frames = [{"width": 4, "height": 3, "draws": [{"mesh": "one"}, {"mesh": "quad"}], "left_out": left}
                  for left in ([left_out], [], [left_out])]
        self.assertEqual(self.lines(frames, 20), [
            "a.json: frames 20 to 22, 4 x 3 pixels, 6 draws, 9 triangles, 2 meshes, 1 fragment shader, 1 image, 1.3 MB",
            "left out: 2 draws, 2 primitives: smooth lines"])

    def test_of_what_are_no_draws(self):
        left_out = [{"reason": reason, "draws": 2, "primitives": 0} for reason in (
            "a clear of a part of the target", "depth is not cleared before the first draw", "nothing is written")]
        self.assertEqual(self.lines([{"width": 4, "height": 3, "draws": [], "left_out": left_out}])[1:], [
            "left out: 2 clears: of a part of the target",
            "left out: 2 earlier pictures: depth is not cleared before the first draw",
            "left out: 2 draws, 0 primitives: nothing is written"])

    def test_of_a_file_whose_frame_has_no_number(self):
        frame = {"width": 4, "height": 3, "draws": [], "left_out": []}
        self.assertTrue(self.lines([frame])[0].startswith("a.json: 1 frame, 4 x 3 pixels, 0 draws, "))


class Wishes(unittest.TestCase):
    def test_a_time_limit_before_the_frame_is_wrong_usage(self):
        parse = load_program().parse
        for words in (["--after", "8", "--timeout", "5", "--", "true"], ["--timeout", "5", "--", "true"],
                      ["--timeout", "5", "a.trace"]):
            with self.assertRaisesRegex(failure.WrongUsage, "--timeout 5 .*--after [58]", msg=words):
                parse(["--list", *words])
        for words in (["--after", "4", "--timeout", "5", "--", "true"], ["--frame", "9", "--timeout", "5", "--", "true"],
                      ["--timeout", "5", "a.rdc"]):
            self.assertEqual(parse(["--list", *words]).timeout, 5)


class Primitives(unittest.TestCase):
    def test_topologies(self):
        for why, topology, indices, restart, expected in [
                ("a strip turns every second one", "TriangleStrip", [5, 6, 7, 8, 9], None, [[5, 6, 7], [6, 8, 7], [7, 8, 9]]),
                ("a fan's first vertex is everywhere", "TriangleFan", [3, 4, 5, 6], None, [[4, 5, 3], [5, 6, 3]]),
                ("a restart begins a strip with a new orientation", "TriangleStrip",
                 [0, 1, 2, 3, 255, 4, 5, 6, 255, 7, 8], 255, [[0, 1, 2], [1, 3, 2], [4, 5, 6]]),
                ("restarts at both ends and in a row", "TriangleFan", [9, 9, 0, 1, 2, 9], 9, [[1, 2, 0]]),
                ("incomplete ones are left out", "TriangleList", range(5), None, [[0, 1, 2]]),
                ("incomplete ones are left out", "TriangleStrip", range(2), None, []),
                ("neighbours are not corners", "TriangleList_Adj", range(6), None, [[0, 2, 4]]),
                ("lines have two corners", "LineList", range(5), None, [[0, 1], [2, 3]]),
                ("a restart begins a line anew", "LineStrip", [0, 1, 2, 9, 3, 9, 4, 5], 9, [[0, 1], [1, 2], [4, 5]]),
                ("neighbours are not ends", "LineStrip_Adj", range(5), None, [[1, 2], [2, 3]]),
                ("neighbours are not ends", "LineList_Adj", range(8), None, [[1, 2], [5, 6]]),
                ("points have one", "PointList", [4, 2], None, [[4], [2]])]:
            with self.subTest(why):
                self.assertEqual(geometry.corners_of(topology, np.array(indices), restart).tolist(), expected)

    def test_patches_are_none(self):
        self.assertIsNone(geometry.corners_of("PatchList", np.arange(6)))
        self.assertEqual(geometry.primitives_of("LineStrip", 6), 5)


class LinesAndPoints(unittest.TestCase):
    """In a window of 16 x 8 pixels."""
    WINDOW = wide.Window([0, 0, 16, 8])

    def clip(self, *places, w=1.0):
        places = np.array(places, np.float64)
        return np.float32(np.concatenate([(places / [8, 4] - 1) * w, np.full((len(places), 1), 0.25) * w,
                                          np.full((len(places), 1), w)], 1))

    def quads(self, clip):
        """(left, top, right, bottom) of each four vertices."""
        places = np.round(self.WINDOW.places(clip).reshape(-1, 4, 2), 6)
        return np.concatenate([places.min(1), places.max(1)], 1).tolist()

    def line(self, start, stop, width=1.0, is_rectangular=False, has_samples=False, front_ccw=True):
        ends = wide.Ends(self.clip(start, stop), np.zeros((2, 0), np.uint32), np.array([[0, 1]]), [])
        return wide.lines_as_triangles(ends, self.WINDOW, width, is_rectangular, has_samples, front_ccw)

    def test_a_line_has_the_pixel_that_it_starts_in_and_not_the_one_that_it_ends_in(self):
        for why, start, stop, width, expected in [
                ("to the right", (2.5, 3.5), (6.5, 3.5), 1, [2, 3, 6, 4]),
                ("to the left", (6.5, 3.5), (2.5, 3.5), 1, [3, 3, 7, 4]),
                ("down, three pixels wide", (4.5, 1.5), (4.5, 5.5), 3, [3, 1, 6, 5]),
                ("up", (4.5, 5.5), (4.5, 1.5), 1, [4, 2, 5, 6]),
                ("wide lines take whole pixels", (2.5, 3.5), (6.5, 3.5), 2.25, [2, 2.5, 6, 4.5]),
                ("ends outside the diamonds stay", (2.0, 3.125), (6.0, 3.125), 1, [2, 2.625, 6, 3.625])]:
            with self.subTest(why):
                self.assertEqual(self.quads(self.line(start, stop, width)[0]), [expected])

    def test_a_line_that_starts_and_ends_in_a_diamond_is_empty(self):
        (left, _, right, _), = self.quads(self.line((2.4, 3.5), (2.6, 3.5))[0])
        self.assertEqual(left, right)
        self.assertEqual(len(self.line((2.5, 3.5), (2.5, 3.5))[2]), 0)

    def test_pixels_of_several_samples_are_whole(self):
        clip, _, triangles = self.line((0.5, 0.5), (4.5, 2.5), has_samples=True)
        # At the centres of columns 0 to 3 the line is at 0.5, 1, 1.5 and 2; halfway the upper pixel has it.
        self.assertEqual(self.quads(clip), [[0, 0, 1, 1], [1, 0, 2, 1], [2, 1, 3, 2], [3, 1, 4, 2]])
        self.assertEqual(len(triangles), 8)
        down, _, _ = self.line((2.5, 4.5), (0.5, 0.5), has_samples=True)
        self.assertEqual(sorted(self.quads(down)), [[0, 1, 1, 2], [1, 2, 2, 3], [1, 3, 2, 4], [2, 4, 3, 5]])

    def test_rectangular_lines_have_sides_at_right_angles(self):
        clip, _, _ = self.line((2, 2), (6, 2), 2, is_rectangular=True)
        self.assertEqual(self.quads(clip), [[2, 1, 6, 3]])
        places = self.WINDOW.places(self.line((2, 2), (5, 6), 5, is_rectangular=True)[0])
        self.assertEqual(sorted(np.round(places, 2).tolist()), [[0, 3.5], [3, 7.5], [4, 0.5], [7, 4.5]])

    def test_all_face_the_viewer(self):
        ways = [((2, 2), (6, 3)), ((6, 3), (2, 2)), ((2, 2), (3, 6)), ((3, 6), (2, 2))]
        for front_ccw in (False, True):
            for start, stop in ways:
                for kind in ((True, False), (False, False), (False, True)):
                    clip, _, triangles = self.line(start, stop, 2, *kind, front_ccw)
                    a, b, c = (self.WINDOW.places(clip)[corner] for corner in triangles.T)
                    (ax, ay), (bx, by) = (b - a).T, (c - a).T
                    self.assertTrue(((ax * by - ay * bx < 0) == front_ccw).all())  # y is down

    def test_varyings_have_perspective_and_flat_ones_those_of_the_first_end(self):
        clip = np.concatenate([self.clip((2.5, 3.5)), self.clip((6.5, 3.5), w=3.0)])
        varyings = np.array([[0.0, 5.0], [8.0, 7.0]], np.float32).view(np.uint32)
        ends = wide.Ends(clip, varyings, np.array([[0, 1]]), [True, False])
        clip, varyings, _ = wide.lines_as_triangles(ends, self.WINDOW, 1, False, True, True)
        found = varyings.view(np.float32).reshape(-1, 4, 2)
        # The third pixel starts halfway between the centres of the first and the fifth, less an eighth: share s, where
        # the line has 8 s / (s + 3 (1 - s)).
        for column, share in ((0, -0.125), (1, 0.125), (2, 0.375)):
            self.assertAlmostEqual(float(found[column, 0, 0]), 8 * share / (share + 3 * (1 - share)), 5)
        np.testing.assert_array_equal(found[..., 1], 5)

    def test_lines_are_cut_where_they_pass_the_near_plane(self):
        clip = np.array([[0, 0, 1, 2], [4, 0, -3, -2]], np.float32)
        varyings = np.array([[0.0], [4.0]], np.float32).view(np.uint32)
        ends = wide.Ends(clip, varyings, np.array([[0, 1], [1, 1]]), [True])
        ends.cut(wide.planes_of(ends.clip, True, True))
        np.testing.assert_allclose(ends.clip[:, 0], [[0, 0, 1, 2], [1, 0, 0, 1]])
        self.assertEqual(ends.varyings.view(np.float32).ravel().tolist(), [0, 1])

    def test_points_are_squares(self):
        varyings = np.array([[7], [8]], np.uint32)
        clip, varyings, triangles, coordinates = wide.points_as_triangles(
            self.clip((4.5, 2.5), (9, 4), w=2.0), varyings, np.array([3.0, 0.5]), self.WINDOW, True)
        self.assertEqual(self.quads(clip), [[3, 1, 6, 4], [8.5, 3.5, 9.5, 4.5]])
        self.assertEqual(varyings.ravel().tolist(), [7] * 4 + [8] * 4)
        for corner, place in zip(self.WINDOW.places(clip)[:4], coordinates[:4]):
            np.testing.assert_allclose((corner - [3, 1]) / 3, place, atol=1e-6)
        self.assertEqual(len(triangles), 4)

    def test_none_at_all(self):
        none = np.zeros(0, np.int64)
        self.assertEqual(wide.points_as_triangles(self.clip((1, 1))[none], np.zeros((0, 3), np.uint32), np.ones(0),
                                                  self.WINDOW, True)[1].shape, (0, 3))


class Welding(unittest.TestCase):
    def test_identical_vertices_are_shared_in_the_order_of_first_use(self):
        clip = np.array([[0, 0, 0, 1], [1, 0, 0, 1], [0, 1, 0, 1], [0, 1, 0, 1], [1, 0, 0, 1], [1, 1, 0, 1]],
                        np.float32)
        (positions,), corners, kept = geometry.weld([clip], np.array([[3, 4, 5], [0, 1, 2]]))
        self.assertEqual(len(positions), 4)
        self.assertEqual(corners.tolist(), [[0, 1, 2], [3, 1, 0]])
        self.assertEqual(kept.tolist(), [0, 1])
        np.testing.assert_array_equal(positions[corners][0], clip[[3, 4, 5]])
        np.testing.assert_array_equal(positions[corners][1], clip[[0, 1, 2]])

    def test_vertices_with_other_attributes_stay_apart(self):
        clip = np.zeros((4, 4), np.float32)
        clip[:, 0] = [0, 1, 2, 2]
        codes = np.array([[1], [1], [1], [2]], np.uint8)
        columns, corners, _ = geometry.weld([clip, codes], np.array([[0, 1, 2], [1, 0, 3]]))
        self.assertEqual([len(column) for column in columns], [4, 4])
        self.assertEqual(columns[1][corners[1, 2], 0], 2)

    def test_triangles_with_equal_corners_go_and_take_their_vertices_along(self):
        clip = np.array([[0, 0, 0, 1], [1, 0, 0, 1], [0, 1, 0, 1], [7, 7, 7, 1]], np.float32)
        (positions,), corners, kept = geometry.weld([clip], np.array([[3, 3, 0], [0, 1, 2]]))
        self.assertEqual((len(positions), corners.tolist(), kept.tolist()), (3, [[0, 1, 2]], [1]))

    def test_minus_zero_is_zero(self):
        clip = np.array([[0, 0, 0, 1], [-0.0, 0, 0, 1], [1, 0, 0, 1], [0, 1, 0, 1]], np.float32)
        (positions,), _, _ = geometry.weld([clip], np.array([[0, 2, 3], [1, 3, 2]]))
        self.assertEqual(len(positions), 3)

    def test_no_triangles(self):
        (positions,), corners, _ = geometry.weld([np.zeros((3, 4), np.float32)], np.zeros((0, 3), np.int64))
        self.assertEqual((positions.shape, corners.shape), ((0, 4), (0, 3)))


class ClipPlanes(unittest.TestCase):
    def test_a_corner_that_is_cut_off_leaves_two_triangles(self):
        clip = np.array([[0, 0, 0, 1], [4, 0, 0, 1], [0, 4, 0, 1]], np.float32)
        (found,), corners = geometry.clip_to_planes([clip], np.array([[0, 1, 2]]),
                                                    np.array([[-1.0], [1.0], [1.0]], np.float32))
        self.assertEqual(len(corners), 2)
        area = sum(abs(np.linalg.det(found[t][:, [0, 1, 3]])) / 2 for t in corners)
        self.assertAlmostEqual(area, 8 - 2)  # the cut halves both edges at the corner
        self.assertEqual(sorted(set(corners.ravel())), [1, 2, 3, 4])

    def test_whole_triangles_stay_and_hidden_ones_go(self):
        clip = np.zeros((6, 4), np.float32)
        distances = np.array([[1], [1], [0], [-1], [-1], [-2]], np.float32)
        _, corners = geometry.clip_to_planes([clip], np.array([[0, 1, 2], [3, 4, 5]]), distances)
        self.assertEqual(corners.tolist(), [[0, 1, 2]])


class Windows(unittest.TestCase):
    WIDTH, HEIGHT = 200, 100

    def place(self, viewport, ndc_x, ndc_y):
        """The formula of the trace format."""
        x, y, width, height = viewport
        return x + width * (1 + ndc_x) / 2, y + height * (1 - ndc_y) / 2

    def test_y_is_down_in_clip_space(self):
        viewport = state.picture_viewport(10, 20, 100, 50)  # y = 20 + 50 * (1 + ndc) / 2 in the framebuffer
        self.assertEqual(self.place(viewport, -1, -1), (10, 20))
        self.assertEqual(self.place(viewport, 1, 1), (110, 70))

    def test_a_negative_height_turns_y_up(self):
        viewport = state.picture_viewport(0, self.HEIGHT, self.WIDTH, -self.HEIGHT)
        self.assertEqual(viewport, [0, 0, self.WIDTH, self.HEIGHT])

    def test_scissors_stay_within_the_target(self):
        self.assertEqual(state.picture_scissor(-5, -5, 20, 20, self.WIDTH, self.HEIGHT), [0, 0, 15, 15])
        self.assertEqual(state.picture_scissor(190, 0, 50, 30, self.WIDTH, self.HEIGHT), [190, 0, 10, 30])
        self.assertEqual(state.picture_scissor(300, 0, 50, 30, self.WIDTH, self.HEIGHT)[2], 0)


class States(unittest.TestCase):
    API = {"viewport": [0, 32, 64, -32], "depth_range": [0, 1], "scissor": None, "depth_test": True, "depth_write": True,
           "depth_function": "Less", "bias": 0, "slope_bias": 0, "bias_clamp": 0, "depth_format": "D24",
           "color_format": "R8G8B8A8_UNORM", "depth_clamp": False, "cull": "NoCull", "front_ccw": True, "blend": None,
           "color_mask": 15, "stencil": None, "alpha_to_coverage": False, "logic_operation": None}

    def of(self, **changes):
        return state.state_of({**self.API, **changes}, 64, 32)

    def test_defaults_are_left_out(self):
        self.assertEqual(self.of(), {})

    def test_depth(self):
        self.assertEqual(self.of(depth_function="GreaterEqual"), {"depth_function": "greater_equal"})
        self.assertEqual(self.of(depth_write=False), {"depth_write": False})
        self.assertEqual(self.of(depth_test=False), {"depth_test": False, "depth_write": False})
        self.assertEqual(self.of(depth_clamp=True), {"depth_clip": False})
        self.assertEqual(self.of(depth_range=[0.1, 1]), {"depth_range": [0.1, 1]})

    def test_a_bias_is_in_units_of_depth(self):
        bias = self.of(bias=2, slope_bias=1.5)["depth_bias"]
        self.assertEqual(bias, {"constant": 2.0**-23, "slope": 1.5, "clamp": 0})
        self.assertEqual(self.of(bias=1, depth_format="D16")["depth_bias"]["constant"], 2.0**-16)

    def test_blending_that_replaces_is_none(self):
        replace = {"source": "One", "destination": "Zero", "operation": "Add"}
        mix = {"source": "SrcAlpha", "destination": "InvSrcAlpha", "operation": "Add"}
        of = lambda color, alpha: self.of(blend={"color": color, "alpha": alpha, "constant": [0, 0.5, 1, 1]})
        self.assertEqual(of(replace, replace), {})
        mixed = {"source": "source_alpha", "operation": "add", "destination": "one_minus_source_alpha"}
        self.assertEqual(of(mix, mix)["blend"], mixed)
        replaced = {"source": "one", "destination": "zero", "operation": "add"}
        self.assertEqual(of(mix, replace)["blend"], {**mixed, "alpha": replaced})
        constant = of({**mix, "source": "FactorRGB"}, mix)["blend"]
        self.assertEqual((constant["source"], constant["constant"]), ("constant", [0, 0.5, 1, 1]))
        for source in ("Src1Col", "InvSrc1Alpha"):
            with self.assertRaisesRegex(ValueError, "^blending with two source colours$"):
                of({"source": source, "destination": "Zero", "operation": "Add"}, replace)

    def test_logic_operations_replace_blending(self):
        mix = {"source": "SrcAlpha", "destination": "InvSrcAlpha", "operation": "Add"}
        blend = {"color": mix, "alpha": mix, "constant": [0, 0, 0, 0]}
        self.assertEqual(self.of(blend=blend, logic_operation="Copy"), {})
        with self.assertRaisesRegex(ValueError, "^logic operation Xor$"):
            self.of(logic_operation="Xor")

    def test_masks_and_faces(self):
        self.assertEqual(self.of(color_mask=7, front_ccw=False), {"color_mask": "rgb", "front_face": "clockwise"})
        self.assertEqual(state.state_of(self.API, 64, 32, has_alpha=False), {"color_mask": "rgb"})
        self.assertEqual(self.of(alpha_to_coverage=True), {"alpha_to_coverage": True})

    def test_stencil_has_8_bits(self):
        face = {"function": "Equal", "reference": 1, "compare_mask": 0xFFFFFFFF, "write_mask": 0xFFFFFFFF,
                "fail": "Keep", "depth_fail": "IncSat", "pass": "Replace"}
        self.assertEqual(self.of(stencil=(face, face)),
                         {"stencil": {"function": "equal", "reference": 1, "mask": 255, "write_mask": 255,
                                      "fail": "keep", "depth_fail": "increment", "pass": "replace"}})

    def test_faces_have_stencils_of_their_own_unless_they_are_culled(self):
        front = {"function": "AlwaysTrue", "reference": 0, "compare_mask": 255, "write_mask": 255, "fail": "Keep",
                 "depth_fail": "IncWrap", "pass": "Keep"}
        both = (front, {**front, "depth_fail": "DecWrap"})
        found = self.of(stencil=both)
        self.assertEqual([found[key]["depth_fail"] for key in ("stencil", "stencil_back")],
                         ["increment_wrap", "decrement_wrap"])
        for cull, kept in (("Back", "increment_wrap"), ("Front", "decrement_wrap")):
            found = self.of(stencil=both, cull=cull)
            self.assertNotIn("stencil_back", found)
            self.assertEqual(found["stencil"]["depth_fail"], kept)


class Views(unittest.TestCase):
    def test_the_view_of_a_target_has_the_format(self):
        attachments = [types.SimpleNamespace(imageResourceId=7, viewFormat="B8G8R8A8_SRGB"),
                       types.SimpleNamespace(imageResourceId=9, viewFormat="D24")]
        controller = mock.Mock()
        controller.GetVulkanPipelineState().currentPass.framebuffer.attachments = attachments
        self.assertEqual(api_state.color_view(controller, 7), "B8G8R8A8_SRGB")
        self.assertIsNone(api_state.color_view(controller, 8))


class Passes(unittest.TestCase):
    def draw(self, event, color, depth, vertices):
        return passes.Action(event, "", True, color, depth, vertices)

    def test_shadow_maps_and_filters_are_passes_of_their_own(self):
        found = passes.group([self.draw(1, 0, 8, 3000), self.draw(2, 5, 6, 900), self.draw(3, 5, 6, 30),
                              self.draw(4, 7, 0, 6)])
        self.assertEqual([(one.color, len(one.draws)) for one in found], [(0, 1), (5, 2), (7, 1)])
        kept = passes.choose(found, 7)
        self.assertEqual(kept.color, 5)
        self.assertIn("depth only", passes.reason_left_out(found[0], kept))
        self.assertIn("no depth", passes.reason_left_out(found[2], kept))

    def test_what_is_presented_comes_first(self):
        found = passes.group([self.draw(1, 5, 6, 1000), self.draw(2, 7, 8, 600)])
        self.assertEqual(passes.choose(found, 7).color, 7)
        self.assertEqual(passes.choose(found, 9).color, 5)

    def test_a_picture_that_is_cleared_again_starts_anew(self):
        clear = passes.Action(2, "", False, 5, 6, 0, passes.Clears(color=True, depth=1.0))
        found = passes.group([self.draw(1, 5, 6, 10), clear, self.draw(3, 5, 6, 20)])
        self.assertEqual([[one.event for one in p.draws] for p in found], [[1], [3]])

    def test_what_is_cleared_between_draws_is_known(self):
        clear = lambda event, *what: passes.Action(event, "", False, 5, 6, 0, passes.Clears(False, *what))
        found = passes.group([clear(1, 1.0, 9), self.draw(2, 5, 6, 10), clear(3, 1.0, 7), clear(4, None, 8),
                              self.draw(5, 5, 6, 20), self.draw(6, 5, 6, 20), clear(7, None, None, True),
                              self.draw(8, 5, 6, 20)])
        self.assertEqual(len(found), 1)
        self.assertEqual({event: (cleared.depth, cleared.stencil, cleared.parts)
                          for event, cleared in found[0].cleared_before.items()},
                         {5: (1.0, 8, False), 8: (None, None, True)})
        self.assertEqual((found[0].cleared_first.depth, found[0].cleared_first.stencil), (1.0, 9))

    def test_names_of_render_passes(self):
        self.assertEqual(passes.clears_of("vkCmdBeginRenderPass(C=Clear, D=Clear)"), (True, True, False))
        self.assertEqual(passes.clears_of("vkCmdBeginRendering(C=Load, DS=Clear)"), (False, True, True))
        self.assertEqual(passes.clears_of("vkCmdBeginRendering(C=Load, D=Load, S=Clear)"), (False, False, True))
        self.assertEqual(passes.clears_of("vkCmdBeginRendering(C=Load, D=Load)"), (False, False, False))


class Parameters:
    """Stands for RenderDoc's record of a command's parameters: dictionaries, lists and numbers."""

    def __init__(self, value):
        self.value = value

    def FindChild(self, name):
        return Parameters(self.value[name]) if name in self.value else None

    def FindChildRecursively(self, name):
        if name in self.value:
            return self.FindChild(name)
        found = (Parameters(each).FindChildRecursively(name) for each in self.value.values() if isinstance(each, dict))
        return next((each for each in found if each is not None), None)

    def NumChildren(self):
        return len(self.value)

    def GetChild(self, number):
        return Parameters(self.value[number])

    def AsInt(self):
        return int(self.value)

    def AsFloat(self):
        return float(self.value)


class ClearCommands(unittest.TestCase):
    @staticmethod
    def value(depth, stencil):
        return {"clearValue": {"depthStencil": {"depth": depth, "stencil": stencil}}}

    def check(self, found, color, depth, stencil, parts=False):
        self.assertEqual((found.color, found.depth, found.stencil, found.parts), (color, depth, stencil, parts))

    def test_render_passes(self):
        dynamic = Parameters({"pRenderingInfo": {"pDepthAttachment": self.value(0.25, 0),
                                                 "pStencilAttachment": self.value(0, 7)}})
        self.check(clears.of_render_pass(dynamic, "vkCmdBeginRendering(C=Clear, DS=Clear)"), True, 0.25, 7)
        self.check(clears.of_render_pass(dynamic, "vkCmdBeginRendering(C=Load, D=Load, S=Clear)"), False, None, 7)
        self.check(clears.of_render_pass(dynamic, "vkCmdBeginRendering(C=Clear, DS=Load)"), True, None, None)
        old = Parameters({"RenderPassBegin": {"pClearValues": [{"color": {}}, {"depthStencil": {"depth": 0.5,
                                                                                               "stencil": 3}}]}})
        self.check(clears.of_render_pass(old, "vkCmdBeginRenderPass(C=Clear, DS=Clear)"), True, 0.5, 3)

    def test_attachments_are_cleared_whole_or_in_parts(self):
        rectangle = lambda x, width: {"rect": {"offset": {"x": x, "y": 0}, "extent": {"width": width, "height": 8}}}
        of = lambda rectangles, *attachments: clears.of_attachments(
            Parameters({"pRects": rectangles, "pAttachments": list(attachments)}), (16, 8))
        color, both = {"aspectMask": 1, "clearValue": {"color": {}}}, {"aspectMask": 6, **self.value(0.75, 9)}
        self.check(of([rectangle(0, 16)], color, both), True, 0.75, 9)
        self.check(of([rectangle(0, 16)], {**both, "aspectMask": 4}), False, None, 9)
        self.check(of([rectangle(4, 12)], both), False, None, None, True)

    def test_images(self):
        image = Parameters({"pDepthStencil": {"depth": 1, "stencil": 2}, "pRanges": [{"aspectMask": 2}]})
        self.check(clears.of_depth_image(image), False, 1, None)


class Frames(unittest.TestCase):
    DRAW = {"left_out": None, "primitives": 0, "clip": np.zeros((3, 4), np.float32),
            "varyings": np.zeros((3, 0), np.uint32), "triangles": np.array([[0, 1, 2]]), "program": {}}

    def frame(self, cleared, *events, **changes):
        before = np.zeros((32, 64, 4), np.float32)
        before[..., 3] = 0.2
        pictures = {"size": (64, 32), "samples": 1, "later_draws": 0, "color_format": "R8G8B8A8_UNORM",
                    "api": "OpenGL (zink)", "is_window": False, "cleared_first": passes.Clears(True, 1.0, 0),
                    "color": before, "color_before": before, "depth": np.ones((32, 64)), "depth_before": np.ones((32, 64)),
                    "stencil_before": np.zeros((32, 64), np.uint8), "passes": [], "cleared_before": cleared, **changes}
        draws = [{**self.DRAW, "event": event, "api": States.API,
                  **({"left_out": "why", "primitives": 4} if event < 0 else {})} for event in events]
        return frame.Frame(pictures, draws)

    def test_clears_belong_to_the_next_draw_that_is_kept(self):
        found = self.frame({-2: passes.Clears(depth=1.0), 3: passes.Clears(stencil=5)}, 1, -2, 3, 4)
        self.assertEqual([draw.state for draw in found.draws],
                         [{}, {"clears_depth": True, "clears_stencil": 5}, {}])
        self.assertEqual(found.left_out, {"why": (1, 4)})

    def test_what_a_trace_cannot_clear_is_counted(self):
        found = self.frame({2: passes.Clears(parts=True), 3: passes.Clears(depth=0.5)}, 1, 2, 3)
        self.assertEqual(sorted(found.left_out.values()), [(1, 0), (1, 0)])

    def test_what_the_targets_have_before_the_first_draw(self):
        """Without clears, too, if it is the same everywhere."""
        stencil = np.full((32, 64), 3, np.uint8)
        found = self.frame({}, 1, 2, stencil_before=stencil, depth_before=np.full((32, 64), 0.5),
                           cleared_first=passes.Clears())
        self.assertEqual(found.left_out, {})
        self.assertEqual([draw.state for draw in found.draws], [{"clears_stencil": 3}, {}])
        self.assertAlmostEqual(found.background_alpha, 0.2)
        self.assertEqual((found.background, found.clear_depth), ([0, 0, 0], 0.5))

    def left_out_before(self, *, color=True, depth=1.0, parts=False, **changes):
        return sorted(self.frame({}, 1, cleared_first=passes.Clears(color, depth, None, parts), **changes).left_out)

    def test_what_is_not_cleared_before_the_first_draw_is_left_out(self):
        depth, color = np.ones((32, 64)), np.zeros((32, 64, 4), np.float32)
        depth[3, 4], color[5, 6] = 0.5, 1
        colour_is, depth_is = (f"{what} is not cleared before the first draw" for what in ("colour", "depth"))
        part = "a clear of a part of the target"
        for why, expected, changes in [
                ("depth of the last frame", [depth_is], {"depth": None, "depth_before": depth}),
                ("colour of the last frame", [colour_is], {"color": False, "color_before": color}),
                ("both", [colour_is, depth_is], {"depth": None, "color": False, "depth_before": depth,
                                                 "color_before": color}),
                ("drawn by a pass before", [colour_is], {"color_before": color}),
                ("a part is cleared after the whole", [part], {"parts": True, "color_before": color}),
                ("a part only", [part, depth_is], {"depth": None, "parts": True, "depth_before": depth}),
                ("a part to what is there", [], {"parts": True}),
                ("a stencil that no draw tests", [], {"stencil_before": np.arange(2048).reshape(32, 64) & 255})]:
            with self.subTest(why):
                self.assertEqual(self.left_out_before(**changes), expected)

    def test_depth_that_no_draw_tests_need_not_be_cleared(self):
        depth = np.linspace(0, 1, 2048).reshape(32, 64)
        with mock.patch.dict(States.API, depth_test=False):
            self.assertEqual(self.left_out_before(depth=None, depth_before=depth), [])

    def test_draws_with_another_encoding_are_counted(self):
        with mock.patch.dict(States.API, color_format="R8G8B8A8_SRGB"):
            self.assertEqual(self.frame({}, 1, color_format="R8G8B8A8_SRGB").left_out, {})
            found = self.frame({}, 1, 2)
            self.assertEqual(found.target, "unorm")
            self.assertEqual(found.left_out, {"sRGB encoding differs from that of the largest draw": (2, 0)})
            with mock.patch.dict(States.API, color_mask=0):
                self.assertEqual(self.frame({}, 1).left_out, {})

    def test_framebuffer_objects_of_opengl_are_stored_bottom_up(self):
        zink = "OpenGL (zink)"
        for api, is_window, height, expected in ((zink, False, 32, True), (zink, False, -32, False),
                                                 (zink, True, 32, False), ("Vulkan", False, 32, False)):
            with mock.patch.dict(States.API, viewport=[0, 0, 64, height]):
                self.assertEqual(self.frame({}, 1, api=api, is_window=is_window).is_bottom_up, expected)

    def test_the_target_is_that_of_its_format(self):
        for color_format, target in (("R8G8B8A8_UNORM", "unorm"), ("B8G8R8A8_SRGB", "srgb"),
                                     ("R16G16B16A16_FLOAT", "float"), ("R11G11B10_FLOAT", "float")):
            self.assertEqual(self.frame({}, 1, color_format=color_format).target, target)

    def test_a_target_without_alpha_does_not_write_it(self):
        found = self.frame({}, 1, color_format="R5G6B5_UNORM")
        self.assertEqual(found.draws[0].state, {"color_mask": "rgb"})


class Matrices(unittest.TestCase):
    def moved(self, old, matrix):
        return (old.astype(np.float64) @ matrix.T).astype(np.float32)

    MATRIX = np.array([[0.9, -0.3, 0.1, 0.2], [0.25, 1.1, -0.05, 0.1], [0, 0.04, 0.98, -0.6], [0.01, 0.02, -0.2, 1.3]])

    @staticmethod
    def vertices(seed, count):
        return np.random.default_rng(seed).normal(size=(count, 4)).astype(np.float32)

    def test_a_solid_that_moved(self):
        old = self.vertices(1, 500)
        found = motion.find_matrix(old, self.moved(old, self.MATRIX))
        np.testing.assert_allclose(found, self.MATRIX, atol=1e-5)

    def test_a_flat_mesh_that_moved(self):
        old = self.vertices(2, 50)
        old[:, 3] = 1
        old[:, 2] = 0.5
        new = self.moved(old, self.MATRIX)
        found = motion.find_matrix(old, new)
        np.testing.assert_allclose(old @ found.T, new, atol=1e-5)
        self.assertGreater(abs(np.linalg.det(found)), 1e-6)

    def test_a_mesh_that_stayed(self):
        old = self.vertices(3, 9)
        np.testing.assert_array_equal(motion.find_matrix(old, old.copy()), np.eye(4))

    def test_one_vertex_that_moved_by_itself_is_found(self):
        old = self.vertices(4, 500)
        new = self.moved(old, self.MATRIX)
        new[333, 1] += 1e-4
        self.assertIsNone(motion.find_matrix(old, new))

    def test_a_mesh_that_bends_is_another_mesh(self):
        old = self.vertices(5, 500)
        new = self.moved(old, self.MATRIX)
        new[:, 0] += 0.01 * old[:, 1] ** 2
        self.assertIsNone(motion.find_matrix(old, new))


class Colors(unittest.TestCase):
    def test_srgb_there_and_back(self):
        values = np.linspace(0, 1, 256)
        np.testing.assert_allclose(srgb.from_linear(srgb.to_linear(values)), values, atol=1e-7)
        self.assertAlmostEqual(float(srgb.to_linear(np.array(0.5))), 0.21404114)

class Images(unittest.TestCase):
    @staticmethod
    def format(name, kind="Regular", component_bytes=1, components=4, numbers="UNorm", bgra=False):
        return images.Format(name, kind, component_bytes, components, numbers, bgra)

    def test_bgra_bytes(self):
        found = images.decode_color(bytes([255, 0, 51, 255]), 1, 1, self.format("B8G8R8A8_UNORM", bgra=True))
        np.testing.assert_allclose(found[0, 0], [0.2, 0, 1, 1], atol=1e-6)

    def test_what_a_trace_knows_is_stored_as_it_is(self):
        data = bytes(range(8))
        self.assertEqual(images.stored(data, 2, 1, self.format("B8G8R8A8_SRGB", bgra=True)), ("B8G8R8A8_SRGB", data))
        half = self.format("R16G16B16A16_FLOAT", component_bytes=2, numbers="Float")
        self.assertEqual(images.stored(data, 1, 1, half), ("R16G16B16A16_SFLOAT", data))

    def numbers(self, data, format, kind="<f4"):
        name, texels = images.stored(data, len(data) // images.size_in_bytes(1, 1, format), 1, format)
        return name, np.frombuffer(texels, kind).reshape(-1, 4)

    def test_other_formats_keep_their_numbers(self):
        for format, data, wanted in (
                (self.format("R16_UNORM", component_bytes=2, components=1), struct.pack("<H", 65535), [1, 0, 0, 1]),
                (self.format("R8G8_SNORM", components=2, numbers="SNorm"), struct.pack("bb", -128, 127), [-1, 1, 0, 1]),
                (self.format("R10G10B10A2_UNORM", "R10G10B10A2"), struct.pack("<I", 1023 << 10 | 2 << 30),
                 [0, 1, 0, 2 / 3]),
                (self.format("R5G6B5_UNORM", "R5G6B5"), struct.pack("<H", 31 << 11), [0, 0, 1, 1]),
                # 1.5 = 1.1b; in 6 bits of mantissa 0x20, in 5 bits 0x10; an exponent of 15 is 2^0
                (self.format("R11G11B10_FLOAT", "R11G11B10"),
                 struct.pack("<I", (15 << 6 | 0x20) | (16 << 6) << 11 | (14 << 5 | 0x10) << 22), [1.5, 2, 0.75, 1]),
                # 256 / 512 * 2^(exponent - 15)
                (self.format("R9G9B9E5_FLOAT", "R9G9B9E5"), struct.pack("<I", 256 | 128 << 9 | 16 << 27),
                 [1, 0.5, 0, 1])):
            name, found = self.numbers(data, format)
            self.assertEqual(name, "R32G32B32A32_SFLOAT")
            np.testing.assert_allclose(found[0], wanted, atol=1e-6, err_msg=format.name)

    def test_integers_stay_integers(self):
        name, found = self.numbers(struct.pack("<hh", -3, 7), self.format("R16G16_SINT", "Regular", 2, 2, "SInt"), "<i4")
        self.assertEqual((name, found.tolist()), ("R32G32B32A32_SINT", [[-3, 7, 0, 1]]))

    def test_a_bc1_block_with_two_ends(self):
        if importlib.util.find_spec("PIL") is None:
            self.skipTest("python3-pil is not installed")
        block = struct.pack("<HHI", 0xF800, 0x001F, 0b00_00_00_00_10_01_00_00)  # red > blue: four colours
        name, texels = images.stored(block, 4, 4, self.format("BC1_SRGB", "BC1", numbers="UNormSRGB"))
        self.assertEqual(name, "R8G8B8A8_SRGB")
        found = np.frombuffer(texels, "u1").reshape(4, 4, 4)
        for x, color in ((0, [255, 0, 0, 255]), (2, [0, 0, 255, 255]), (3, [170, 0, 85, 255])):
            np.testing.assert_allclose(found[0, x], color, atol=1)

    def test_depth_has_24_bits_below_stencil(self):
        format = self.format("D24S8", "D24S8", 4, 2, "Depth")
        name, texels = images.stored(struct.pack("<I", 7 << 24 | 0xFFFFFF), 1, 1, format)
        self.assertEqual((name, texels), ("D32_SFLOAT", struct.pack("<f", 1)))

    def test_stencil_is_beside_depth(self):
        d24 = self.format("D24S8", "D24S8", 4, 2, "Depth")
        self.assertEqual(images.decode_stencil(struct.pack("<II", 7 << 24 | 5, 9), 2, 1, d24).tolist(), [[7, 0]])
        d32 = self.format("D32S8", "D32S8", 8, 2, "Depth")
        self.assertEqual(images.decode_stencil(struct.pack("<fIfI", 1, 4, 1, 6), 2, 1, d32).tolist(), [[4, 6]])
        self.assertIsNone(images.decode_stencil(bytes(4), 1, 1, self.format("D16", component_bytes=2, numbers="Depth")))

    def test_an_unknown_format_is_none(self):
        self.assertIsNone(images.stored(bytes(16), 4, 4, self.format("ASTC_4x4", "ASTC")))


class Interpolations(unittest.TestCase):
    def module(self, *instructions):
        words = [0x07230203, 0x10300, 0, 100, 0]
        for code, *operands in instructions:
            words += [(1 + len(operands)) << 16 | code, *operands]
        return struct.pack(f"<{len(words)}I", *words)

    def test_decorations_of_inputs(self):
        decorate, variable, location, flat, linear = 71, 59, 30, 14, 13
        module = self.module((decorate, 9, location, 4), (decorate, 8, location, 0), (decorate, 8, flat),
                             (decorate, 7, location, 1), (decorate, 7, linear), (decorate, 6, location, 2),
                             (decorate, 6, flat), (variable, 1, 9, 1), (variable, 1, 8, 1), (variable, 1, 7, 1),
                             (variable, 1, 6, 3))  # the last one is an output
        found = spirv.interpolations(module)
        self.assertEqual(found, [(0, "flat"), (1, "linear"), (4, "smooth")])
        self.assertEqual([spirv.interpolation_at(found, place) for place in (0, 1, 3, 4, 5)],
                         ["flat", "linear", "linear", "smooth", "smooth"])

    def test_the_place_in_a_point_becomes_an_input(self):
        module = self.module((71, 8, 30, 0), (71, 9, 11, 16), (59, 1, 8, 1), (59, 1, 9, 1))
        changed, found = spirv.with_point_coordinates(module, 31)
        self.assertTrue(found)
        self.assertEqual(changed, self.module((71, 8, 30, 0), (71, 9, 30, 31), (59, 1, 8, 1), (59, 1, 9, 1)))
        other = self.module((71, 9, 11, 15))  # gl_FragCoord
        self.assertEqual(spirv.with_point_coordinates(other, 31), (other, False))

    def test_members_of_a_block(self):
        module = self.module((72, 5, 0, 30, 3), (72, 5, 1, 30, 6), (72, 5, 1, 14), (59, 1, 9, 1))
        self.assertEqual(spirv.interpolations(module), [(3, "smooth"), (6, "flat")])


class Files(unittest.TestCase):
    def test_a_png_file_holds_the_pixels(self):
        values = np.random.default_rng(7).integers(0, 256, (5, 4, 3)).astype(np.uint8)
        data = png.encode(values)
        size = struct.unpack(">II", data[16:24])
        at = data.index(b"IDAT")
        rows = np.frombuffer(zlib.decompress(data[at + 4:]), np.uint8).reshape(5, 13)
        self.assertEqual((size, rows[:, 0].tolist()), ((4, 5), [2] * 5))
        np.testing.assert_array_equal(np.cumsum(rows[:, 1:], 0, dtype=np.uint8).reshape(5, 4, 3), values)

    def test_views_are_aligned(self):
        buffer = trace_file.Buffer("b")
        buffer.view(np.array([1, 2, 3]), "uint16")
        view = buffer.view(np.array([1.5]), "float32")
        self.assertEqual((view["offset"], view["count"], buffer.size), (8, 1, 12))
        self.assertEqual(b"".join(buffer.parts), struct.pack("<HHHHf", 1, 2, 3, 0, 1.5))

    def test_files_that_cannot_all_be_written_leave_nothing(self):
        with tempfile.TemporaryDirectory() as folder:
            files = [(os.path.join(folder, "a"), b"1"), (os.path.join(folder, "missing", "b"), b"2")]
            with self.assertRaises(OSError):
                trace_file.write_all(files)
            self.assertEqual(os.listdir(folder), [])
            trace_file.write_all(files[:1])
            self.assertEqual(os.listdir(folder), ["a"])


class Meshes(unittest.TestCase):
    SAMPLER = {"mag": "linear"}

    class FakeDraw:
        def __init__(self, clip, varyings=((1,), (2,), (3,), (4,))):
            self.clip, self.triangles = clip.astype(np.float32), np.array([[0, 1, 2], [2, 1, 3]])
            self.varyings = np.array(varyings, np.uint32)
            self.cull, self.state = "none", {}
            self.program = {"spirv": bytes(24), "specialization": [], "inputs": [{"location": 0, "count": 1}],
                            "buffers": [{"set": 0, "binding": 1, "element": 0, "bytes": b"abc"}],
                            "push_constants": b"",
                            "images": [{"set": 2, "binding": 0, "element": 0, "image": "first", "shape": "2d",
                                        "array": False, "sampler": Meshes.SAMPLER}]}

    class FakeFrame:
        def __init__(self, *draws):
            self.draws = draws

    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = holder.name
        for name in ("first", "second"):  # the same texels, as a program may have them twice
            with open(os.path.join(self.folder, name + ".pickle"), "wb") as file:
                pickle.dump({"format": "R8_UNORM", "texels": b"x", "width": 1, "height": 1, "depth": 1, "layers": 1,
                             "levels": 1}, file)
        self.collection = meshes.Collection()

    def add(self, *draws):
        return self.collection.add_frame(self.FakeFrame(*draws), self.folder)

    def test_a_mesh_that_moves_is_stored_once(self):
        old = self.FakeDraw(np.random.default_rng(8).normal(size=(4, 4)))
        first = self.add(old)
        second = self.add(self.FakeDraw(old.clip.astype(np.float64) @ Matrices.MATRIX.T))
        self.assertEqual(len(self.collection.meshes), 1)
        self.assertNotIn("transform", first[0])
        matrix = np.array(second[0]["transform"]).reshape(4, 4).T  # column-major
        np.testing.assert_allclose(matrix, Matrices.MATRIX, atol=1e-4)

    def test_other_varyings_are_another_mesh(self):
        clip = np.random.default_rng(9).normal(size=(4, 4))
        draws = self.add(self.FakeDraw(clip), self.FakeDraw(clip, ((1,), (2,), (3,), (5,))), self.FakeDraw(clip))
        self.assertEqual([draw["mesh"] for draw in draws], ["mesh0", "mesh1", "mesh0"])

    def test_programs_images_and_samplers_are_stored_once(self):
        clip = np.random.default_rng(10).normal(size=(4, 4))
        one, two = self.FakeDraw(clip), self.FakeDraw(clip)
        two.program["images"][0]["image"] = "second"
        draws = self.add(one, two)
        self.assertEqual(draws[0]["program"], {
            "program": 0, "buffers": [{"set": 0, "binding": 1, "element": 0, "bytes": "YWJj"}],
            "images": [{"set": 2, "binding": 0, "element": 0, "image": 0, "sampler": 0}]})
        self.assertEqual(draws[1]["program"], draws[0]["program"])
        self.assertEqual([len(table.entries) for table in (self.collection.programs, self.collection.images,
                                                           self.collection.samplers)], [1, 1, 1])

    def test_vertices_that_differ_in_a_varying_stay_apart(self):
        self.add(self.FakeDraw(np.ones((4, 4)) * [[1], [2], [2], [3]]))
        positions, varyings, indices = self.collection.meshes[0].welded()
        self.assertEqual((len(positions), varyings.tolist()), (4, [[1], [2], [3], [4]]))
        self.assertEqual(indices.tolist(), [[0, 1, 2], [2, 1, 3]])


if __name__ == "__main__":
    unittest.main()
