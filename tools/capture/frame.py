"""A captured frame as plain arrays: the pictures and the draws, in order, ready for the trace."""
import re

import numpy as np

import srgb
import state as draw_state
from passes import Clears


def most_common(picture, otherwise):
    """The most common value of a picture, or `otherwise` if there is none."""
    if picture is None:
        return otherwise
    values, counts = np.unique(picture, return_counts=True)
    return values[counts.argmax()].item()


_PART = "a clear of a part of the target"
_OTHER_DEPTH = "a clear to another depth than before the first draw"
_EARLIER = {what: f"{what} is not cleared before the first draw" for what in ("colour", "depth", "stencil")}
_ENCODING = "sRGB encoding differs from that of the largest draw"  # the draws are kept
# What other than draws a trace leaves out, by reason: the word that counts it.
COUNTED = {_PART: "clear", _OTHER_DEPTH: "clear", **{reason: "earlier picture" for reason in _EARLIER.values()},
           _ENCODING: "encoding"}


def is_mixed(picture):
    """Whether a picture has several values."""
    return picture is not None and bool((picture != picture[:1, :1]).any())


class Draw:
    """A draw with triangles."""

    def __init__(self, found, state):
        self.clip, self.varyings, self.triangles = found["clip"], found["varyings"], found["triangles"]
        self.state, self.cull = state, draw_state.CULL[found["api"]["cull"]]
        self.program = found["program"]  # as programs.Programs reads it


class Frame:
    """`color`: height x width x 3, 0..1, codes as a picture shows them; `depth`: height x width window depths or None;
    `target`: "srgb" if codes are sRGB-encoded as they are stored, "unorm" if shaders write the codes, "float" if they
    write linear colours of any size."""

    def __init__(self, pictures, found):
        self.width, self.height = pictures["size"]
        self.samples = pictures["samples"]
        self.later_draws = pictures["later_draws"]
        is_float = "FLOAT" in pictures["color_format"]
        self.target = "float" if is_float else "srgb" if "SRGB" in pictures["color_format"] else "unorm"
        encoded = lambda picture: None if picture is None else np.clip(
            srgb.from_linear(picture[..., :3]) if is_float else picture[..., :3], 0, 1)
        self.color, self.color_before = encoded(pictures["color"]), encoded(pictures["color_before"])
        self.background_alpha = most_common(None if pictures["color_before"] is None else
                                            np.clip(pictures["color_before"][..., 3], 0, 1), 1.0)
        self.depth, self.depth_before = pictures["depth"], pictures["depth_before"]
        # In windows, Mesa's drivers turn OpenGL's rows around by viewports of negative height.
        self.is_bottom_up = (pictures["api"].startswith("OpenGL") and not pictures["is_window"]
                             and any(one["api"]["viewport"][3] > 0 for one in found[:1]))
        self.has_alpha = not pictures["color_format"] or bool(re.search(r"A\d", pictures["color_format"]))
        self.passes = pictures["passes"]
        self.draws, self.left_out = [], {}
        owed = Clears(stencil=most_common(pictures["stencil_before"], 0) or None)
        for one in found:
            if one["event"] in pictures["cleared_before"]:  # also if the draw is left out
                owed = owed.then(pictures["cleared_before"][one["event"]])
                self._check_clears(pictures["cleared_before"][one["event"]])
            reason, primitives = one["left_out"], one["primitives"]
            if not reason:
                try:
                    state = draw_state.state_of(one["api"], self.width, self.height, self.has_alpha)
                    if one["program"] is None:  # without a fragment shader there is no colour
                        state["color_mask"] = ""
                    if not state.get("depth_write", True) and state.get("color_mask") == "" and "stencil" not in state:
                        reason, primitives = "nothing is written", len(one["triangles"])
                    elif "viewport" in state and (state["viewport"][2] <= 0 or state["viewport"][3] == 0):
                        reason, primitives = "empty viewport", len(one["triangles"])
                except ValueError as error:
                    reason, primitives = str(error), len(one["triangles"])
            if reason:
                self._leave_out(reason, primitives)
                continue
            if not len(one["triangles"]):
                continue
            if owed.depth is not None:
                state["clears_depth"] = True
            if owed.stencil is not None:
                state["clears_stencil"] = owed.stencil
            owed = Clears()
            if one["api"]["color_format"].endswith("SRGB") != (self.target == "srgb") and state.get("color_mask") != "":
                self._leave_out(_ENCODING, 0)
            self.draws.append(Draw(one, state))
        self._check_before(pictures)

    def _leave_out(self, reason, primitives):
        draws, count = self.left_out.get(reason, (0, 0))
        self.left_out[reason] = (draws + 1, count + primitives)

    def _check_clears(self, clears):
        if clears.parts:
            self._leave_out(_PART, 0)
        if clears.depth is not None and abs(clears.depth - self.clear_depth) > 1e-6:
            self._leave_out(_OTHER_DEPTH, 0)

    def _check_before(self, pictures):
        """Of what the targets have before the first draw, a trace has one colour, depth and stencil."""
        first, states = pictures["cleared_first"], [draw.state for draw in self.draws]
        tests_depth = any(state.get("depth_test", True) for state in states)
        tests_stencil = any("stencil" in state for state in states)
        mixed = {what: is_cleared for what, picture, is_used, is_cleared in (
            ("colour", self.color_before, True, first.color),
            ("depth", self.depth_before, tests_depth, first.depth is not None),
            ("stencil", pictures["stencil_before"], tests_stencil, first.stencil is not None))
            if is_used and is_mixed(picture)}
        if mixed and first.parts:
            self._leave_out(_PART, 0)
        for what, is_cleared in mixed.items():
            if not (is_cleared and first.parts):  # else the clear of a part is why
                self._leave_out(_EARLIER[what], 0)

    @property
    def clear_depth(self):
        """What most of the depth buffer had before the first draw."""
        return float(most_common(self.depth_before, 1.0))

    @property
    def background(self):
        """Linear RGB of most of the picture before the first draw."""
        if self.color_before is None:
            return [0.0, 0.0, 0.0]
        colors, counts = np.unique(np.rint(self.color_before.reshape(-1, 3) * 255).astype(np.uint8), axis=0,
                                   return_counts=True)
        return [float(c) for c in srgb.to_linear(colors[counts.argmax()] / 255.0)]
