"""Unit tests of tools/capture that need numpy and nothing else: `python3 units_test.py FOLDER_OF_TOOLS_CAPTURE`."""
import contextlib
import importlib.util
import io
import os
import struct
import sys
import tempfile
import unittest
import zlib
from unittest import mock

import numpy as np

sys.path.insert(0, sys.argv.pop(1) if len(sys.argv) > 1 else
                os.path.join(os.path.dirname(__file__), "../../tools/capture"))
sys.dont_write_bytecode = True
import frame
import geometry
import meshes
import motion
import passes
import pixels
import png
import raster
import shading
import srgb
import state
import trace_file


class Errors(unittest.TestCase):
    def test_an_internal_error_is_one_line_unless_it_is_looked_for(self):
        path = os.path.join(sys.path[0], "__main__.py")
        spec = importlib.util.spec_from_file_location("capture_main", path)
        program = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(program)

        def fail(_):
            raise ValueError("two\nlines")
        program.run = fail
        words = ["-o", "a.json", "--", "true"]
        with contextlib.redirect_stderr(io.StringIO()) as error, mock.patch.dict(os.environ, {program.DEBUG: ""}):
            self.assertEqual(program.main(words), 1)
        self.assertRegex(error.getvalue(), r"\Abeampipe: error: internal error: ValueError: two lines \([^\n]*\n\Z")
        with mock.patch.dict(os.environ, {program.DEBUG: "1"}), self.assertRaises(ValueError):
            program.main(words)


class Triangles(unittest.TestCase):
    def test_topologies(self):
        for why, topology, indices, restart, expected in [
                ("a strip turns every second one", "TriangleStrip", [5, 6, 7, 8, 9], None, [[5, 6, 7], [7, 6, 8], [7, 8, 9]]),
                ("a fan's first vertex is everywhere", "TriangleFan", [3, 4, 5, 6], None, [[3, 4, 5], [3, 5, 6]]),
                ("a restart begins a strip with a new orientation", "TriangleStrip",
                 [0, 1, 2, 3, 255, 4, 5, 6, 255, 7, 8], 255, [[0, 1, 2], [2, 1, 3], [4, 5, 6]]),
                ("restarts at both ends and in a row", "TriangleFan", [9, 9, 0, 1, 2, 9], 9, [[0, 1, 2]]),
                ("incomplete ones are left out", "TriangleList", range(5), None, [[0, 1, 2]]),
                ("incomplete ones are left out", "TriangleStrip", range(2), None, []),
                ("neighbours are not corners", "TriangleList_Adj", range(6), None, [[0, 2, 4]])]:
            with self.subTest(why):
                self.assertEqual(geometry.triangles_of(topology, np.array(indices), restart).tolist(), expected)

    def test_lines_and_points_have_no_triangles(self):
        self.assertIsNone(geometry.triangles_of("LineStrip", np.arange(6)))
        self.assertIsNone(geometry.triangles_of("PointList", np.arange(6)))
        self.assertEqual(geometry.primitives_of("LineStrip", 6), 5)


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

    def test_opengl_measures_from_the_bottom_and_vulkan_from_the_top_with_y_down(self):
        # y = 20 + 50 * (1 + ndc) / 2 in OpenGL's window, and in Vulkan's framebuffer.
        for y_up, low, high in ((True, self.HEIGHT - 20, self.HEIGHT - 70), (False, 20, 70)):
            viewport = state.picture_viewport(10, 20, 100, 50, self.HEIGHT, y_up)
            self.assertEqual(self.place(viewport, -1, -1), (10, low))
            self.assertEqual(self.place(viewport, 1, 1), (110, high))

    def test_vulkan_with_a_negative_height_is_as_opengl(self):
        viewport = state.picture_viewport(0, self.HEIGHT, self.WIDTH, -self.HEIGHT, self.HEIGHT, False)
        self.assertEqual(viewport, [0, 0, self.WIDTH, self.HEIGHT])

    def test_scissors_stay_within_the_target(self):
        self.assertEqual(state.picture_scissor(-5, -5, 20, 20, self.WIDTH, self.HEIGHT, True), [0, 85, 15, 15])
        self.assertEqual(state.picture_scissor(190, 0, 50, 30, self.WIDTH, self.HEIGHT, False), [190, 0, 10, 30])
        self.assertEqual(state.picture_scissor(300, 0, 50, 30, self.WIDTH, self.HEIGHT, False)[2], 0)


class States(unittest.TestCase):
    API = {"viewport": [0, 0, 64, 32], "depth_range": [0, 1], "scissor": None, "depth_test": True, "depth_write": True,
           "depth_function": "Less", "bias": 0, "slope_bias": 0, "bias_clamp": 0, "depth_format": "D24",
           "depth_clamp": False, "front_ccw": True, "blend": None, "color_mask": 15, "stencil": None, "y_up": True}

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
        one = {"source": "One", "destination": "Zero", "operation": "Add"}
        self.assertEqual(self.of(blend=one), {})
        mix = {"source": "SrcAlpha", "destination": "InvSrcAlpha", "operation": "Add"}
        self.assertEqual(self.of(blend=mix)["blend"], {"source": "source_alpha", "operation": "add",
                                                       "destination": "one_minus_source_alpha"})
        with self.assertRaises(ValueError):
            self.of(blend={"source": "Src1Col", "destination": "Zero", "operation": "Add"})

    def test_masks_and_faces(self):
        self.assertEqual(self.of(color_mask=7, front_ccw=False), {"color_mask": "rgb", "front_face": "clockwise"})

    def test_stencil_has_8_bits(self):
        face = {"function": "Equal", "reference": 1, "compare_mask": 0xFFFFFFFF, "write_mask": 0xFFFFFFFF,
                "fail": "Keep", "depth_fail": "IncSat", "pass": "Replace"}
        self.assertEqual(self.of(stencil=face)["stencil"],
                         {"function": "equal", "reference": 1, "mask": 255, "write_mask": 255, "fail": "keep",
                          "depth_fail": "increment", "pass": "replace"})


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
        clear = passes.Action(2, "", False, 5, 6, 0, clears_depth=True, clears_color=True)
        found = passes.group([self.draw(1, 5, 6, 10), clear, self.draw(3, 5, 6, 20)])
        self.assertEqual([[one.event for one in p.draws] for p in found], [[1], [3]])

    def test_depth_that_is_cleared_between_draws_is_known(self):
        clear = passes.Action(2, "", False, 5, 6, 0, clears_depth=True)
        found = passes.group([self.draw(1, 5, 6, 10), clear, self.draw(3, 5, 6, 20), self.draw(4, 5, 6, 20)])
        self.assertEqual((len(found), found[0].cleared_before), (1, {3}))

    def test_names_of_render_passes(self):
        self.assertEqual(passes.clears_of("vkCmdBeginRenderPass(C=Clear, D=Clear)"), (True, True))
        self.assertEqual(passes.clears_of("vkCmdBeginRendering(C=Load, DS=Clear)"), (True, False))
        self.assertEqual(passes.clears_of("vkCmdBeginRendering(C=Load, D=Load)"), (False, False))


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


class Rasters(unittest.TestCase):
    QUAD = np.array([[-1, -1, 0, 1], [1, -1, 0, 1], [1, 1, 0, 1], [-1, 1, 0, 1]], np.float32)
    TWO = np.array([[0, 1, 2], [0, 2, 3]])

    def draw(self, clip, triangles, draw_state=None, cull="none", target=None, first=0):
        target = target or raster.Target(8, 6, None)
        for fragments in raster.fragments_of(clip, triangles, draw_state or {}, cull, target):
            raster.draw(target, fragments, draw_state or {}, first)
        return target

    def test_two_triangles_of_a_quad_share_no_pixel(self):
        target = raster.Target(8, 6, None)
        fragments = list(raster.fragments_of(self.QUAD, self.TWO, {}, "none", target))[0]
        self.assertEqual(sorted(fragments.pixel), list(range(48)))

    def test_an_edge_through_pixel_centers_belongs_to_one_side(self):
        for axis in (0, 1):  # the shared edge is at x = 4.5 of 8 pixels, and at y = 2.5 of 6
            middle = [1 / 8, 1 / 6][axis]
            low, high = self.QUAD.copy(), self.QUAD.copy()
            low[low[:, axis] > 0, axis] = middle
            high[high[:, axis] < 0, axis] = middle
            target = raster.Target(8, 6, None)
            found = [pixel for quad in (low, high) for fragments in
                     raster.fragments_of(quad, self.TWO, {}, "none", target) for pixel in fragments.pixel]
            self.assertEqual(sorted(found), list(range(48)))
        target = raster.Target(8, 6, None)
        below = next(raster.fragments_of(low, self.TWO, {}, "none", target)).pixel  # a top edge is part of a triangle
        self.assertEqual(min(below) // 8, 2)

    def test_random_triangles_cover_the_pixels_whose_centers_they_contain(self):
        random = np.random.default_rng(6)
        for _ in range(50):
            clip = np.concatenate([random.uniform(-1.5, 1.5, (3, 2)), np.zeros((3, 1)), np.ones((3, 1))], 1)
            target = self.draw(clip.astype(np.float32), np.array([[0, 1, 2]]))
            x, y = (1 + clip[:, 0]) * 4, (1 - clip[:, 1]) * 3
            for pixel in range(48):
                px, py = pixel % 8 + 0.5, pixel // 8 + 0.5
                sides = [(x[k - 2] - x[k]) * (py - y[k]) - (y[k - 2] - y[k]) * (px - x[k]) for k in range(3)]
                if min(abs(side) for side in sides) > 0.1:  # far enough from an edge for snapping not to matter
                    self.assertEqual(bool(target.touched[pixel]), all(s > 0 for s in sides) or all(s < 0 for s in sides))

    def test_the_nearer_triangle_owns_the_pixel_in_any_order(self):
        near, far = self.QUAD.copy(), self.QUAD.copy()
        near[:, 2], far[:, 2] = -0.5, 0.5
        for order in ((near, far), (far, near)):
            target = self.draw(order[0], self.TWO)
            self.draw(order[1], self.TWO, target=target, first=2)
            owner = 0 if order[0] is near else 2
            self.assertTrue(((target.owner == owner) | (target.owner == owner + 1)).all())
            np.testing.assert_allclose(target.depth, 0.25)

    def test_layers_within_one_draw_are_drawn_in_order(self):
        clip = np.concatenate([self.QUAD, self.QUAD])
        triangles = np.concatenate([self.TWO, self.TWO + 4])
        self.assertLess(self.draw(clip, triangles).owner.max(), 2)
        self.assertGreater(self.draw(clip, triangles, {"depth_function": "less_equal"}).owner.min(), 1)

    def test_what_blends_on_top_leaves_the_solid_owner(self):
        target = self.draw(self.QUAD, self.TWO)
        mix = {"source": "source_alpha", "destination": "one_minus_source_alpha", "operation": "add"}
        self.draw(self.QUAD, self.TWO, {"depth_test": False, "blend": mix}, target=target, first=2)
        self.assertTrue((target.owner >= 2).all())
        self.assertTrue((target.solid < 2).all() and (target.solid >= 0).all())

    def test_culling_looks_at_the_picture(self):
        self.assertTrue(self.draw(self.QUAD, self.TWO, cull="back").touched.all())
        self.assertFalse(self.draw(self.QUAD, self.TWO, cull="front").touched.any())
        self.assertFalse(self.draw(self.QUAD, self.TWO, {"front_face": "clockwise"}, "back").touched.any())
        upside_down = {"viewport": [0, 6, 8, -6]}
        self.assertFalse(self.draw(self.QUAD, self.TWO, upside_down, "back").touched.any())

    def test_scissor_viewport_and_range(self):
        found = self.draw(self.QUAD, self.TWO, {"viewport": [2, 0, 4, 6], "scissor": [0, 1, 8, 2],
                                                "depth_range": [0.5, 0.7]})
        self.assertEqual(np.flatnonzero(found.touched).tolist(), [10, 11, 12, 13, 18, 19, 20, 21])
        np.testing.assert_allclose(found.depth[found.touched], 0.6)

    def test_a_triangle_that_passes_the_eye_is_cut_at_the_near_plane(self):
        clip = np.array([[-1, -1, 0, 1], [1, -1, 0, 1], [0, 3, -4, -2]], np.float32)
        target = self.draw(clip, np.array([[0, 1, 2]]))
        self.assertTrue(target.touched.any())
        self.assertGreaterEqual(target.depth.min(), 0)

    def test_a_slope_bias_moves_a_slope(self):
        clip = self.QUAD.copy()
        clip[:, 2] = clip[:, 0] * 0.5
        plain = self.draw(clip, self.TWO).depth
        moved = self.draw(clip, self.TWO, {"depth_bias": {"constant": 0.01, "slope": 2.0, "clamp": 0}}).depth
        np.testing.assert_allclose(moved - plain, 0.01 + 2 * 0.5 / 8, atol=1e-9)  # z changes by 0.5 over 8 pixels

    def test_stencil_keeps_later_draws_out(self):
        target = self.draw(self.QUAD, self.TWO[:1], {
            "depth_test": False, "depth_write": False, "color_mask": "",
            "stencil": {"function": "always", "reference": 1, "mask": 255, "write_mask": 255, "fail": "keep",
                        "depth_fail": "keep", "pass": "replace"}})
        marked = target.stencil == 1
        self.assertTrue(0 < marked.sum() < 48)
        self.draw(self.QUAD, self.TWO, {"stencil": {"function": "equal", "reference": 1, "mask": 255, "write_mask": 255,
                                                    "fail": "keep", "depth_fail": "keep", "pass": "keep"}},
                  target=target)
        np.testing.assert_array_equal(target.owner >= 0, marked)

    def test_weights_are_perspective_correct(self):
        clip = np.array([[-1, -1, 0, 1], [3, -3, 0, 3], [-2, 2, 0, 2]], np.float32)
        point = np.array([[0.2, 0.3, 0.5]]) @ clip  # a point of the triangle, in clip space
        x, y = 100 * (1 + point[0, 0] / point[0, 3]) / 2, 50 * (1 - point[0, 1] / point[0, 3]) / 2
        found = raster.weights_at(clip, np.array([[0, 1, 2]]), np.array([0]), np.array([x]), np.array([y]),
                                  [0, 0, 100, 50])
        np.testing.assert_allclose(found, [[0.2, 0.3, 0.5]], atol=1e-12)


class Colors(unittest.TestCase):
    def test_srgb_there_and_back(self):
        values = np.linspace(0, 1, 256)
        np.testing.assert_allclose(srgb.from_linear(srgb.to_linear(values)), values, atol=1e-7)
        self.assertAlmostEqual(float(srgb.to_linear(np.array(0.5))), 0.21404114)

    def test_the_cutoff_is_between_what_is_kept_and_what_is_gone(self):
        alpha = np.array([0.1, 0.2, 0.25, 0.8, 0.9])
        self.assertEqual(shading.best_cutoff(alpha, alpha > 0.22), (0.225, 0.0))
        self.assertEqual(shading.best_cutoff(alpha, alpha > 0.3), (0.5, 0.0))

    def test_the_cutoff_bears_a_few_wrong_fragments(self):
        alpha = np.linspace(0, 1, 101)
        kept = alpha > 0.705
        kept[10] = True
        cutoff, wrong = shading.best_cutoff(alpha, kept)
        self.assertAlmostEqual(cutoff, 0.705)
        self.assertAlmostEqual(wrong, 1 / 101)

    def test_light_at_vertices_is_found_through_a_texture(self):
        random = np.random.default_rng(11)
        weights, texel = random.dirichlet([1, 1, 1], 2000), random.uniform(0.2, 1, (2000, 3))
        corners = np.array([[0, 1, 2], [2, 1, 3]])[random.integers(0, 2, 2000)]
        light = np.array([[1, 0, 0], [0, 1, 0.5], [0.2, 0.3, 1], [0.9, 0.9, 0]])
        captured = texel * (weights[..., None] * light[corners]).sum(1)
        found, seen = shading._least_squares(texel, weights, corners, captured, 5)
        self.assertEqual(seen.tolist(), [True] * 4 + [False])
        np.testing.assert_allclose(found[:4], light, atol=0.01)


class Pixels(unittest.TestCase):
    def test_bgra_bytes(self):
        found = pixels.decode_color(bytes([255, 0, 51, 255]), 1, 1, pixels.Format("Regular", 1, 4, "UNorm", True))
        np.testing.assert_allclose(found[0, 0], [0.2, 0, 1, 1], atol=1e-6)

    def test_one_channel_is_red(self):
        found = pixels.decode_color(bytes([51]), 1, 1, pixels.Format("Regular", 1, 1, "UNorm", False))
        np.testing.assert_allclose(pixels.swizzled(found, "rrr1")[0, 0], [0.2, 0.2, 0.2, 1], atol=1e-6)

    def test_a_bc1_block_with_two_ends(self):
        block = struct.pack("<HHI", 0xF800, 0x001F, 0b00_00_00_00_10_01_00_00)  # red > blue: four colours
        found = pixels.decode_color(block, 4, 4, pixels.Format("BC1", 0, 4, "UNorm", False))
        for x, color in ((0, [1, 0, 0, 1]), (2, [0, 0, 1, 1]), (3, [2 / 3, 0, 1 / 3, 1])):
            np.testing.assert_allclose(found[0, x], color, atol=0.005)

    def test_a_bc3_block_has_opacity_and_with_rising_ends_0_and_1(self):
        for ends, codes, expected in (([200, 100], 1 | 2 << 3, [100, 185, 200]),
                                      ([100, 200], 6 | 7 << 3 | 2 << 6, [0, 255, 120])):
            block = bytes(ends) + codes.to_bytes(6, "little") + struct.pack("<HHI", 0xFFFF, 0, 0)
            found = pixels.decode_color(block, 4, 4, pixels.Format("BC3", 0, 4, "UNorm", False))
            np.testing.assert_allclose(found[0, :3, 3] * 255, expected, atol=1)

    def test_24_bits_of_depth_are_where_the_api_keeps_them(self):
        for word, low in ((0xFFFFFF << 8 | 7, False), (7 << 24 | 0xFFFFFF, True)):
            depth = pixels.Format("D24S8", 0, 2, "Depth", False)
            self.assertEqual(pixels.decode_depth(struct.pack("<I", word), 1, 1, depth, low)[0, 0], 1)


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
    class FakeDraw:
        def __init__(self, clip):
            self.clip, self.triangles = clip.astype(np.float32), np.array([[0, 1, 2], [2, 1, 3]])
            self.topology, self.look, self.alpha_test, self.attributes = "TriangleList", None, None, {}
            self.cull, self.state, self.first, self.blends, self.is_ground = "none", {}, 0, False, False

    class FakeFrame:
        def __init__(self, *draws):
            self.draws = draws

    COLORS = (np.full((2, 3), 4.0), np.array([8, 0]), np.full((2, 3), 0.25))

    def test_a_mesh_that_moves_is_stored_once_with_the_mean_of_its_colors(self):
        old = np.random.default_rng(8).normal(size=(4, 4))
        collection = meshes.Collection(None)
        first = collection.add_frame(self.FakeFrame(self.FakeDraw(old)), self.COLORS)
        moved = self.FakeDraw((self.FakeDraw(old).clip.astype(np.float64) @ Matrices.MATRIX.T))
        second = collection.add_frame(self.FakeFrame(moved), (np.full((2, 3), 8.0), np.array([8, 0]), np.ones((2, 3))))
        self.assertEqual(len(collection.meshes), 1)
        self.assertNotIn("transform", first[0])
        matrix = np.array(second[0]["transform"]).reshape(4, 4).T  # column-major
        np.testing.assert_allclose(matrix, Matrices.MATRIX, atol=1e-4)
        colors = collection.meshes[0].welded()[4]
        np.testing.assert_allclose(colors, [[0.75] * 3, [0.25] * 3])

    def test_two_draws_of_a_frame_have_a_mesh_each(self):
        clip = np.random.default_rng(9).normal(size=(4, 4))
        collection = meshes.Collection(None)
        draws = collection.add_frame(self.FakeFrame(self.FakeDraw(clip), self.FakeDraw(clip)), self.COLORS)
        self.assertNotEqual(draws[0]["mesh"], draws[1]["mesh"])


class Grounds(unittest.TestCase):
    """A ground that writes depth alone, and layers on it."""
    ADD = {"source": "source_alpha", "destination": "one", "operation": "add"}
    MIX = {"source": "source_alpha", "destination": "one_minus_source_alpha", "operation": "add"}

    def frame_of(self, *states):
        """A frame of 8 x 6 pixels that is covered once by each draw, and its target."""
        holder = frame.Frame.__new__(frame.Frame)
        holder.width, holder.height, holder.samples, holder.levels, holder.depth_before = 8, 6, 1, None, None
        holder.color = np.full((6, 8, 3), 0.5)
        holder.draws = []
        for state_of_draw in states:
            draw = frame.Draw.__new__(frame.Draw)
            draw.clip, draw.triangles, draw.state, draw.cull = Rasters.QUAD, Rasters.TWO, state_of_draw, "none"
            draw.first, draw.alpha_test, draw.look, draw.attributes = 2 * len(holder.draws), None, None, {}
            draw.topology, draw.is_ground = "TriangleList", False
            holder.draws.append(draw)
        holder.triangles = 2 * len(states)
        target = holder.rasterize(None)
        shading.find_grounds(holder, target)
        return holder, target

    def layers(self, blend):
        return ({"color_mask": ""}, {"depth_write": False, "depth_function": "less_equal", "blend": blend})

    def test_a_ground_gets_the_colours_that_are_added_on_it(self):
        found, target = self.frame_of(*self.layers(self.ADD))
        self.assertEqual([draw.is_ground for draw in found.draws], [True, False])
        sums, count, _ = shading.picture_colors(found, target)
        self.assertEqual(count[:2].sum(), 48)
        np.testing.assert_allclose(sums[:2] / count[:2, None], srgb.to_linear(np.full((2, 3), 0.5)))
        first = meshes.Collection(None).add_frame(found, (sums, count, sums))[0]
        self.assertNotIn("color_mask", first.get("state", {}))

    def test_depth_below_usual_draws_stays_without_colour(self):
        for layers in (self.layers(self.MIX), ({"color_mask": ""}, {"depth_function": "less_equal"}),
                       ({"color_mask": ""},)):
            found, _ = self.frame_of(*layers)
            self.assertFalse(any(draw.is_ground for draw in found.draws), layers)

    def test_a_ground_that_is_hidden_is_none(self):
        found, _ = self.frame_of(*self.layers(self.ADD), {"depth_function": "always"})
        self.assertFalse(any(draw.is_ground for draw in found.draws))


if __name__ == "__main__":
    unittest.main()
