"""A RenderDoc capture that is opened for replay: its commands, pictures and textures."""
import bisect
import os
import re

import numpy as np
import renderdoc as rd

import srgb
import clears
from api_state import color_view
from images import Format, decode_color, decode_depth, decode_stencil, size_in_bytes, stored
from passes import Action, Clears

_NULL = rd.ResourceId.Null()
_READS = re.compile("_Resource|_Constants|Src|Barrier|InputTarget|Unused|Discard")  # names of uses that write nothing


class ReplayError(Exception):
    """One line: why a capture cannot be replayed."""


# Mesa's software drivers filter textures by shortcuts, which this turns off: what they draw then is what the
# specification says. Other drivers do not know this variable.
FILTERING = "no_brilinear,no_rho_approx,no_quad_lod,no_aos_sampling"


class Replay:
    """Opens a capture of Vulkan. `color`, `depth` and textures are named by RenderDoc's numbers. `is_one_of_many`:
    other processes replay it at the same time."""

    def __init__(self, path, is_one_of_many=False):
        os.environ["GALLIVM_PERF"] = FILTERING  # before the driver is loaded
        if is_one_of_many:
            os.environ["LP_NUM_THREADS"] = "1"
        rd.InitialiseReplay(rd.GlobalEnvironment(), [])
        self.file = rd.OpenCaptureFile()
        opened = self.file.OpenFile(path, "", None)
        if opened != rd.ResultCode.Succeeded:
            raise ReplayError(f"{path}: not a RenderDoc capture that can be read ({opened.Message().strip()})")
        if self.file.DriverName() != "Vulkan":
            raise ReplayError(f"{path}: expected a capture of Vulkan, found {self.file.DriverName()}; capture the "
                              "program itself, whose OpenGL becomes Vulkan")
        opened, self.controller = self.file.OpenCapture(rd.ReplayOptions(), None)
        if opened != rd.ResultCode.Succeeded:
            raise ReplayError(f"{path}: this machine's driver cannot replay it ({opened.Message().strip()})")
        devices = self.file.GetAvailableGPUs()
        self.driver = devices[0].name if len(devices) else ""
        self.textures = {int(t.resourceId): t for t in self.controller.GetTextures()}
        self.structure = self.controller.GetStructuredFile()
        self.commands = []
        self._flatten(self.controller.GetRootActions())
        self._writes = {}

    def close(self):
        self.controller.Shutdown()
        self.file.Shutdown()
        rd.ShutdownReplay()

    def _flatten(self, actions):
        for action in actions:
            self.commands.append(action)
            self._flatten(action.children)

    def actions(self):
        """The frame's commands as passes.Action."""
        found = []
        for command in self.commands:
            flags = command.flags
            is_draw = bool(flags & rd.ActionFlags.Drawcall)
            color = next((int(output) for output in command.outputs if output != _NULL), 0)
            depth, cleared, name = int(command.depthOut), None, ""
            if not is_draw:
                name = command.GetName(self.structure)
                color, depth, cleared = self._clears(command, name, color, depth)
            found.append(Action(command.eventId, name, is_draw, color, depth,
                                command.numIndices * max(1, command.numInstances), cleared,
                                int(command.copyDestination) if flags & rd.ActionFlags.Present else 0))
        return found

    def _clears(self, command, name, color, depth):
        """(colour target, depth target, what it clears) of a command that does not draw."""
        if not len(command.events) or not command.flags & (rd.ActionFlags.BeginPass | rd.ActionFlags.Clear):
            return color, depth, Clears()
        chunk = self.structure.chunks[command.events[-1].chunkIndex]
        if command.flags & rd.ActionFlags.BeginPass:
            return color, depth, clears.of_render_pass(chunk, name)
        if chunk.name == "vkCmdClearAttachments":
            return color, depth, clears.of_attachments(chunk, self.size_of(color or depth))
        target = int(command.copyDestination)
        if chunk.name == "vkCmdClearDepthStencilImage":
            return 0, target, clears.of_depth_image(chunk)
        return target, 0, Clears(color=chunk.name == "vkCmdClearColorImage")

    def command(self, event):
        return next(command for command in self.commands if command.eventId == event)

    def format_of(self, texture):
        return self.format_named(self.textures[texture].format)

    def format_named(self, f):
        return Format(f.Name(), f.type.name, f.compByteWidth, f.compCount, f.compType.name, f.BGRAOrder())

    def seen_format(self, texture):
        """Of a colour target, as the current draw sees it; None if it is none."""
        view = color_view(self.controller, texture)
        return self.format_named(view) if view is not None else self.format_of(texture) if texture else None

    def format_name(self, texture):
        return self.textures[texture].format.Name() if texture in self.textures else ""

    def size_of(self, texture):
        t = self.textures[texture]
        return t.width, t.height

    def samples_of(self, texture):
        return max(1, self.textures[texture].msSamp) if texture in self.textures else 1

    def _bytes(self, texture, level=0, layer=0, sample=0):
        place = rd.Subresource(level, layer, sample)
        return bytes(self.controller.GetTextureData(self.textures[texture].resourceId, place))

    def is_of_a_window(self, texture):
        return texture in self.textures and bool(self.textures[texture].creationFlags & rd.TextureCategory.SwapBuffer)

    def color_picture(self, texture, format):
        """height x width x 4 float32 of the codes that are stored, row 0 on top, the mean of the samples; None if it
        cannot be read."""
        samples = [decode_color(self._bytes(texture, sample=sample), *self.size_of(texture), format)
                   for sample in range(self.samples_of(texture))]
        if samples[0] is None or len(samples) == 1:
            return samples[0]
        if format.numbers != "UNormSRGB":
            return sum(samples) / len(samples)
        mean = sum(srgb.to_linear(sample[..., :3]) for sample in samples) / len(samples)
        return np.concatenate([srgb.from_linear(mean), sum(samples)[..., 3:] / len(samples)], -1, dtype=np.float32)

    def depth_and_stencil(self, texture):
        """height x width float32 of window depths, and uint8 of stencil, row 0 on top, of sample 0; None for what is not
        there or cannot be read."""
        if texture not in self.textures:
            return None, None
        data, size, format = self._bytes(texture), self.size_of(texture), self.format_of(texture)
        return decode_depth(data, *size, format), decode_stencil(data, *size, format)

    def version(self, texture, event):
        """How often the frame has written a texture before an event."""
        if texture not in self._writes:
            used = self.controller.GetUsage(self.textures[texture].resourceId)
            self._writes[texture] = sorted({use.eventId for use in used if not _READS.search(use.usage.name)})
        return bisect.bisect_left(self._writes[texture], event)

    def image(self, texture, format):
        """(name of a trace's format, texels as a trace has them) of all levels and layers of a texture, whose bytes are
        looked at as `format`; None if it cannot be read."""
        t = self.textures[texture]
        if t.msSamp > 1:
            return None
        parts = []
        for level in range(t.mips):
            width, height, depth = (max(1, side >> level) for side in (t.width, t.height, t.depth))
            size = size_in_bytes(width, height, format)
            for layer in range(t.arraysize):
                data = self._bytes(texture, level, layer)
                if len(data) < depth * size:
                    return None
                parts += [stored(data[k * size: (k + 1) * size], width, height, format) for k in range(depth)]
        return None if None in parts else (parts[0][0], b"".join(texels for _, texels in parts))

    @property
    def api(self):
        """OpenGL (zink) where Mesa's zink has made Vulkan of it."""
        for chunk in self.structure.chunks:
            if chunk.name == "vkCreateInstance":
                engine = chunk.FindChildRecursively("EngineName")
                return "OpenGL (zink)" if engine is not None and "zink" in engine.AsString() else "Vulkan"
        return "Vulkan"
