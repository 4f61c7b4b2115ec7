"""A captured frame as plain arrays: the pictures and the draws, in order, ready for shading and for the trace."""
import numpy as np

import raster
import srgb
import state as draw_state

LEVELS = {"D16": 65535, "D16S8": 65535, "D24": 16777215, "D24S8": 16777215}


class Draw:
    """A draw with triangles. `first` is the number of its first triangle in the frame."""

    def __init__(self, found, state, first):
        self.clip, self.triangles, self.attributes = found["clip"], found["triangles"], found["attributes"]
        self.state, self.first = state, first
        self.cull = draw_state.CULL[found["api"]["cull"]]
        self.textures, self.shader, self.discards = found["textures"], found["shader"], found["discards"]
        self.topology = found["api"]["topology"]
        self.look = None  # shading.Look: where its colours come from
        self.alpha_test = None  # shading.AlphaTest, if some of its fragments are discarded by opacity
        self.is_ground = False  # writes depth alone, and gets the colours that other draws add up on it

    @property
    def blends(self):
        return "blend" in self.state

    @property
    def mixes(self):
        """Whether it blends in the usual way, which shows the draw's own colour where it is opaque."""
        blend = self.state.get("blend")
        return blend is not None and (blend["source"] in ("source_alpha", "one") and blend["operation"] == "add"
                                      and blend["destination"] == "one_minus_source_alpha")

    @property
    def writes_only_depth(self):
        return (self.state.get("color_mask") == "" and self.state.get("depth_test", True)
                and self.state.get("depth_write", True))


class Frame:
    """`color`: height x width x 3, 0..1, sRGB-encoded; `depth`: height x width window depths or None."""

    def __init__(self, pictures, found):
        self.width, self.height = pictures["size"]
        self.samples = pictures["samples"]
        encoded = lambda picture: None if picture is None else np.clip(
            srgb.from_linear(picture[..., :3]) if "FLOAT" in pictures["color_format"] else picture[..., :3], 0, 1)
        self.color, self.color_before = encoded(pictures["color"]), encoded(pictures["color_before"])
        self.depth, self.depth_before = pictures["depth"], pictures["depth_before"]
        self.levels = LEVELS.get(pictures["depth_format"])
        self.passes = pictures["passes"]
        self.draws, self.left_out = [], {}
        cleared, owed, first = set(pictures["cleared_before"]), False, 0
        for one in found:
            owed = owed or one["event"] in cleared  # a clear right before a draw that is left out still counts
            reason, primitives = one["left_out"], one["primitives"]
            if not reason:
                try:
                    state = draw_state.state_of(one["api"], self.width, self.height)
                    if not state.get("depth_write", True) and state.get("color_mask") == "" and "stencil" not in state:
                        reason, primitives = "nothing is written", len(one["triangles"])
                    elif "viewport" in state and (state["viewport"][2] <= 0 or state["viewport"][3] == 0):
                        reason, primitives = "empty viewport", len(one["triangles"])
                except ValueError as error:
                    reason, primitives = str(error), len(one["triangles"])
            if reason:
                draws, count = self.left_out.get(reason, (0, 0))
                self.left_out[reason] = (draws + 1, count + primitives)
                continue
            if not len(one["triangles"]):
                continue
            if owed:
                state["clears_depth"] = True
                owed = False
            self.draws.append(Draw(one, state, first))
            first += len(one["triangles"])
        self.triangles = first
        if self.depth is not None and not self._depth_was_read():
            self.depth = self.depth_before = None

    def _depth_was_read(self):
        """RenderDoc reads some depth buffers, such as OpenGL's renderbuffers of 16 bits, as 0 everywhere. Nothing would
        pass the usual tests against that."""
        nearer_is_larger = any(draw.state.get("depth_function", "less").startswith("greater") for draw in self.draws)
        return nearer_is_larger or bool(self.depth.any() or self.depth_before.any())

    @property
    def clear_depth(self):
        """What most of the depth buffer had before the first draw."""
        if self.depth_before is None:
            return 1.0
        values, counts = np.unique(self.depth_before, return_counts=True)
        return float(values[counts.argmax()])

    @property
    def background(self):
        """Linear RGB of most of the picture before the first draw."""
        if self.color_before is None:
            return [0.0, 0.0, 0.0]
        colors, counts = np.unique(np.rint(self.color_before.reshape(-1, 3) * 255).astype(np.uint8), axis=0,
                                   return_counts=True)
        return [float(c) for c in srgb.to_linear(colors[counts.argmax()] / 255.0)]

    def rasterize(self, keep_fragment):
        """Draws everything. `keep_fragment(draw, fragments)` says which fragments the alpha test leaves."""
        target = raster.Target(self.width, self.height, self.depth_before, self.levels, self.samples)
        for draw in self.draws:
            if draw.state.get("clears_depth"):
                target.depth[:], target.front[:] = self.clear_depth, -1
            for fragments in raster.fragments_of(draw.clip, draw.triangles, draw.state, draw.cull, target):
                if draw.alpha_test:
                    fragments = fragments.where(keep_fragment(draw, fragments))
                raster.draw(target, fragments, draw.state, draw.first)
        return target


class Agreement:
    """How far the extracted triangles, rasterized here, agree with what the program drew."""

    def __init__(self, frame, target):
        self.covered, self.depths = None, None  # shares, 0..1
        if frame.depth is not None and (frame.depth != frame.depth_before).any():
            ours = target.depth.reshape(frame.depth.shape)
            theirs_written = frame.depth != frame.depth_before
            ours_written = np.abs(ours - frame.depth_before) > 0
            both = theirs_written & ours_written
            self.covered = both.sum() / max(1, (theirs_written | ours_written).sum())
            self.depths = (np.abs(ours - frame.depth)[both] < 1e-4).mean() if both.any() else 0.0
        elif frame.color is not None:
            changed = (np.abs(frame.color - frame.color_before) > 1e-6).any(-1)
            touched = target.touched.reshape(changed.shape)
            # What is drawn in the colour that is there already cannot be told from what is not drawn.
            self.covered = (changed & touched).sum() / max(1, changed.sum())
