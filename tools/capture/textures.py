"""Looks colours up in captured textures, to compare them with the captured picture."""
import os

import numpy as np

from pixels import swizzled


class Texture:
    """A texture with the swizzle and wrapping of one binding. Values are as stored, 0..1."""

    def __init__(self, texels, binding):
        self.texels = swizzled(texels.astype(np.float32) / 255, binding["swizzle"])
        self.wrap = binding["wrap"]
        self.nearest = binding["nearest"]
        self.levels = [self.texels]
        while binding["mips"] and min(self.levels[-1].shape[:2]) > 1:
            level = self.levels[-1]
            level = level[: level.shape[0] // 2 * 2, : level.shape[1] // 2 * 2]
            self.levels.append((level[::2, ::2] + level[1::2, ::2] + level[::2, 1::2] + level[1::2, 1::2]) / 4)

    @property
    def has_alpha(self):
        return bool((self.texels[..., 3] < 0.999).any())

    def _texel(self, level, x, y):
        height, width = level.shape[:2]
        place = []
        for value, size, wrap in ((x, width, self.wrap[0]), (y, height, self.wrap[1])):
            if wrap == "repeat":
                value = value % size
            elif wrap == "mirror":
                value = value % (2 * size)
                value = np.where(value >= size, 2 * size - 1 - value, value)
            place.append(np.clip(value, 0, size - 1))
        return level[place[1], place[0]]

    def _filtered(self, level, uv):
        x, y = uv[:, 0] * level.shape[1], uv[:, 1] * level.shape[0]
        if self.nearest:
            return self._texel(level, np.floor(x).astype(np.int64), np.floor(y).astype(np.int64))
        x, y = x - 0.5, y - 0.5
        x0, y0 = np.floor(x), np.floor(y)
        fx, fy = (x - x0)[:, None], (y - y0)[:, None]
        x0, y0 = x0.astype(np.int64), y0.astype(np.int64)
        top = self._texel(level, x0, y0) * (1 - fx) + self._texel(level, x0 + 1, y0) * fx
        low = self._texel(level, x0, y0 + 1) * (1 - fx) + self._texel(level, x0 + 1, y0 + 1) * fx
        return top * (1 - fy) + low * fy

    def look_up(self, uv, texels_per_pixel):
        """RGBA at n x 2 texture coordinates; `texels_per_pixel` (n) chooses the levels."""
        uv = np.where(np.isfinite(uv), uv, 0)
        wanted = np.log2(np.maximum(1, np.nan_to_num(texels_per_pixel, nan=1, posinf=1e6)))
        wanted = np.clip(np.rint(wanted), 0, len(self.levels) - 1).astype(np.int64)
        out = np.empty((len(uv), 4), np.float32)
        for number in np.unique(wanted):
            at = wanted == number
            out[at] = self._filtered(self.levels[number], uv[at])
        return out


def key_of(binding):
    return binding["id"], binding["swizzle"], tuple(binding["wrap"]), binding["nearest"], binding["mips"]


class TextureFolder:
    """The textures that the workers left, by binding."""

    def __init__(self, folder):
        self.folder, self.kept = folder, {}

    def get(self, binding):
        """The Texture, or None if its format could not be read."""
        key = key_of(binding)
        if key not in self.kept:
            path = os.path.join(self.folder, f"texture_{binding['id']}.npy")
            self.kept[key] = Texture(np.load(path), binding) if os.path.exists(path) else None
        return self.kept[key]
