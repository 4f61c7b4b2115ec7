"""Texels from the bytes of GPU formats: 8-bit RGBA for textures, floats for pictures and depths. Rows stay in order.

Formats are named as RenderDoc names them: `kind` (its ResourceFormatType), and for "Regular" the bytes of a component,
their number and the kind of number."""
import numpy as np


class Format:
    def __init__(self, kind, component_bytes, components, numbers, bgra):
        self.kind, self.component_bytes, self.components = kind, component_bytes, components
        self.numbers, self.bgra = numbers, bgra


def _regular(data, width, height, format):
    types = {(1, "UNorm"): ("u1", 255.0), (1, "UNormSRGB"): ("u1", 255.0), (2, "UNorm"): ("<u2", 65535.0),
             (2, "Float"): ("<f2", 1.0), (4, "Float"): ("<f4", 1.0)}
    found = types.get((format.component_bytes, format.numbers))
    count = width * height * format.components
    if not found or len(data) < count * format.component_bytes:
        return None
    values = np.frombuffer(data, found[0], count).reshape(height, width, format.components)
    rgba = np.zeros((height, width, 4), np.float32)
    rgba[..., 3] = 1
    rgba[..., : format.components] = values / np.float32(found[1])
    return rgba[..., [2, 1, 0, 3]] if format.bgra else rgba


def _packed(data, width, height, bits, bgra):
    """Components of so many bits, the first in the lowest ones."""
    words = np.frombuffer(data, "<u4" if sum(bits) == 32 else "<u2", width * height).astype(np.uint32)
    rgba, shift = np.ones((height, width, 4), np.float32), 0
    for channel, count in enumerate(bits):
        most = (1 << count) - 1
        rgba[..., channel] = ((words >> shift & most) / np.float32(most)).reshape(height, width)
        shift += count
    return rgba[..., [2, 1, 0, 3]] if bgra else rgba


def _unpack_565(words):
    words = words.astype(np.int32)
    return np.stack([(words >> 11 & 31) * 255 // 31, (words >> 5 & 63) * 255 // 63, (words & 31) * 255 // 31], -1)


def _color_blocks(blocks, four_always):
    """RGBA, n x 16 x 4, of BC1's colour blocks (n x 8 bytes)."""
    ends = np.ascontiguousarray(blocks[:, :4]).view("<u2")
    a, b = _unpack_565(ends[:, 0]), _unpack_565(ends[:, 1])
    four = np.ones(len(blocks), bool) if four_always else ends[:, 0] > ends[:, 1]
    palette = np.full((len(blocks), 4, 4), 255, np.int32)
    palette[:, 0, :3], palette[:, 1, :3] = a, b
    palette[:, 2, :3] = np.where(four[:, None], (2 * a + b) // 3, (a + b) // 2)
    palette[:, 3, :3] = np.where(four[:, None], (a + 2 * b) // 3, 0)
    palette[:, 3, 3] = np.where(four, 255, 0)
    bits = np.ascontiguousarray(blocks[:, 4:8]).view("<u4")[:, 0]
    picked = bits[:, None] >> (2 * np.arange(16, dtype=np.uint32)) & 3
    return np.take_along_axis(palette, picked[..., None].astype(np.int64), 1)


def _alpha_blocks(blocks):
    """Opacity, n x 16, of BC3's alpha blocks (n x 8 bytes)."""
    a, b = blocks[:, 0].astype(np.int32), blocks[:, 1].astype(np.int32)
    palette = np.zeros((len(blocks), 8), np.int32)
    palette[:, 0], palette[:, 1] = a, b
    for k in range(1, 7):
        six = ((7 - k) * a + k * b) // 7
        four = ((5 - k) * a + k * b) // 5 if k < 5 else np.full_like(a, 0 if k == 5 else 255)
        palette[:, k + 1] = np.where(a > b, six, four)
    bits = sum(blocks[:, 2 + k].astype(np.uint64) << np.uint64(8 * k) for k in range(6))
    picked = bits[:, None] >> (np.uint64(3) * np.arange(16, dtype=np.uint64)) & np.uint64(7)
    return np.take_along_axis(palette, picked.astype(np.int64), 1)


def _blocks(data, width, height, kind):
    across, down = (width + 3) // 4, (height + 3) // 4
    size = 8 if kind == "BC1" else 16
    if len(data) < across * down * size:
        return None
    blocks = np.frombuffer(data, np.uint8, across * down * size).reshape(-1, size)
    texels = _color_blocks(blocks[:, -8:], kind != "BC1")
    if kind == "BC2":
        nibbles = np.stack([blocks[:, :8] & 15, blocks[:, :8] >> 4], -1).reshape(-1, 16)
        texels[..., 3] = nibbles.astype(np.int32) * 17
    elif kind == "BC3":
        texels[..., 3] = _alpha_blocks(blocks[:, :8])
    picture = texels.reshape(down, across, 4, 4, 4).transpose(0, 2, 1, 3, 4).reshape(down * 4, across * 4, 4)
    return picture[:height, :width].astype(np.float32) / np.float32(255)


def decode_color(data, width, height, format):
    """height x width x 4 float32, or None if the format is not known. sRGB and linear 8-bit formats come as stored."""
    if format.kind == "Regular":
        return _regular(data, width, height, format)
    if format.kind == "R10G10B10A2":
        return _packed(data, width, height, [10, 10, 10, 2], format.bgra)
    if format.kind == "R5G6B5":
        return _packed(data, width, height, [5, 6, 5], format.bgra)
    if format.kind == "R5G5B5A1":
        return _packed(data, width, height, [5, 5, 5, 1], format.bgra)
    if format.kind == "R4G4B4A4":
        return _packed(data, width, height, [4, 4, 4, 4], format.bgra)
    if format.kind in ("BC1", "BC2", "BC3"):
        return _blocks(data, width, height, format.kind)
    return None


def decode_depth(data, width, height, format, is_vulkan):
    """height x width float32 of window depths, 0..1, or None if the format is not known."""
    count = width * height
    if format.kind == "D24S8":  # OpenGL keeps stencil in the lowest byte, Vulkan in the highest
        words = np.frombuffer(data, "<u4", count)
        depth = (words & 0xFFFFFF if is_vulkan else words >> 8) / 16777215.0
    elif format.kind == "D32S8":
        depth = np.frombuffer(data, "<f4", 2 * count)[::2]
    elif format.component_bytes == 2:
        depth = np.frombuffer(data, "<u2", count) / 65535.0
    elif format.component_bytes == 3:
        words = np.frombuffer(data, "<u4", count)
        depth = (words & 0xFFFFFF) / 16777215.0 if is_vulkan else words / 4294967295.0
    elif format.component_bytes == 4:
        depth = np.frombuffer(data, "<f4", count)
        if not ((depth >= 0) & (depth <= 1)).all():  # OpenGL's 32-bit integers, which have the same name
            depth = np.frombuffer(data, "<u4", count) / 4294967295.0
    else:
        return None
    return np.ascontiguousarray(depth, np.float32).reshape(height, width)


def swizzled(rgba, swizzle):
    """Channels in another order: "rrr1" spreads red over the colours and makes all opaque."""
    if swizzle == "rgba":
        return rgba
    planes = [rgba[..., "rgba".index(c)] if c in "rgba" else np.full(rgba.shape[:2], float(c), rgba.dtype)
              for c in swizzle]
    return np.stack(planes, -1)
