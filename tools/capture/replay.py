"""A RenderDoc capture that is opened for replay: its commands, pictures and textures."""
import os

import renderdoc as rd

from passes import Action, clears_of
from pixels import Format, decode_color, decode_depth

_NULL = rd.ResourceId.Null()


class ReplayError(Exception):
    """One line: why a capture cannot be replayed."""


# What makes Mesa's software drivers fast where only vertices matter: shaders, each of which runs once, are compiled
# without optimisation, and no pixels are drawn. OpenGL's textures are read by drawing them. Other drivers do not know
# these variables.
_VERTICES_ONLY = {"GALLIVM_PERF": "nopt", "LP_NUM_THREADS": "1"}
_NO_PIXELS = {"LP_NO_RAST": "1"}


class Replay:
    """Opens a capture. `color`, `depth` and textures are named by RenderDoc's numbers. `vertices_only`: pictures that
    the frame draws are not asked for."""

    def __init__(self, path, vertices_only=False):
        rd.InitialiseReplay(rd.GlobalEnvironment(), [])
        self.file = rd.OpenCaptureFile()
        opened = self.file.OpenFile(path, "", None)
        if opened != rd.ResultCode.Succeeded:
            raise ReplayError(f"{path}: not a RenderDoc capture that can be read ({opened.Message().strip()})")
        self.api = self.file.DriverName()
        self.is_vulkan = self.api == "Vulkan"
        if vertices_only:  # before the driver is loaded
            os.environ.update(_VERTICES_ONLY | (_NO_PIXELS if self.is_vulkan else {}))
        opened, self.controller = self.file.OpenCapture(rd.ReplayOptions(), None)
        if opened != rd.ResultCode.Succeeded:
            raise ReplayError(f"{path}: this machine's driver cannot replay it ({opened.Message().strip()})")
        devices = self.file.GetAvailableGPUs()
        self.driver = devices[0].name if len(devices) else ""
        self.textures = {int(t.resourceId): t for t in self.controller.GetTextures()}
        self.structure = self.controller.GetStructuredFile()
        self.commands = []
        self._flatten(self.controller.GetRootActions())

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
            name = "" if is_draw else command.GetName(self.structure)
            clears_depth, clears_color = clears_of(name) if flags & rd.ActionFlags.BeginPass else (False, False)
            if flags & rd.ActionFlags.Clear and flags & rd.ActionFlags.ClearDepthStencil and "epth" in name:
                clears_depth = True
            found.append(Action(command.eventId, name, is_draw, color, int(command.depthOut),
                                command.numIndices * max(1, command.numInstances), clears_depth, clears_color,
                                int(command.copyDestination) if flags & rd.ActionFlags.Present else 0))
        return found

    def command(self, event):
        return next(command for command in self.commands if command.eventId == event)

    def format_of(self, texture):
        f = self.textures[texture].format
        return Format(f.type.name, f.compByteWidth, f.compCount, f.compType.name, f.BGRAOrder())

    def format_name(self, texture):
        return self.textures[texture].format.Name() if texture in self.textures else ""

    def size_of(self, texture):
        t = self.textures[texture]
        return t.width, t.height

    def samples_of(self, texture):
        return max(1, self.textures[texture].msSamp) if texture in self.textures else 1

    def is_target(self, texture):
        flags = self.textures[texture].creationFlags
        return bool(flags & (rd.TextureCategory.ColorTarget | rd.TextureCategory.DepthTarget))

    def _bytes(self, texture, sample):
        return bytes(self.controller.GetTextureData(self.textures[texture].resourceId, rd.Subresource(0, 0, sample)))

    def color_picture(self, texture):
        """height x width x 4 float32 as stored, row 0 on top, the mean of the samples; None if it cannot be read."""
        samples = [self._color(texture, sample) for sample in range(self.samples_of(texture))]
        if samples[0] is None:
            return None
        picture = sum(samples) / len(samples)
        return picture if self.is_vulkan else picture[::-1]

    def _color(self, texture, sample):
        return decode_color(self._bytes(texture, sample), *self.size_of(texture), self.format_of(texture))

    def depth_picture(self, texture):
        """height x width float32 of window depths, row 0 on top, of sample 0; None if it cannot be read."""
        if texture not in self.textures:
            return None
        depth = decode_depth(self._bytes(texture, 0), *self.size_of(texture), self.format_of(texture), self.is_vulkan)
        return depth if depth is None or self.is_vulkan else depth[::-1]

    def texture_texels(self, texture):
        """The texture's largest level, rows in the order of v from 0, or None if it is not a flat colour texture."""
        t = self.textures[texture]
        if t.depth > 1 or t.arraysize > 1 or t.cubemap or t.msSamp > 1:
            return None
        return self._color(texture, 0)
