"""Texels from the bytes of GPU formats: images as a trace stores them, and pictures and depths as floats. Rows stay in
order.

Formats are named as RenderDoc names them: `name`, `kind` (its ResourceFormatType), and for "Regular" the bytes of a
component, their number and the kind of number."""
import numpy as np

# What a trace stores as it is; all else becomes one of these that holds the same numbers.
STORED = {"R8_UNORM", "R8G8_UNORM", "R8G8B8A8_UNORM", "R8G8B8A8_SRGB", "B8G8R8A8_UNORM", "B8G8R8A8_SRGB",
          "R16_SFLOAT", "R16G16_SFLOAT", "R16G16B16A16_SFLOAT", "R16G16B16A16_UNORM", "R32_SFLOAT",
          "R32G32B32A32_SFLOAT", "R32G32B32A32_UINT", "R32G32B32A32_SINT"}
# RenderDoc's names of floats lack Vulkan's S.
_NAMES = {f"{channels}_FLOAT": f"{channels}_SFLOAT" for channels in (
    "R16", "R16G16", "R16G16B16A16", "R32", "R32G32B32A32")}
# Bits of the components, the first in the lowest ones.
_PACKED = {"R10G10B10A2": (10, 10, 10, 2), "R5G6B5": (5, 6, 5), "R5G5B5A1": (5, 5, 5, 1), "R4G4B4A4": (4, 4, 4, 4)}
_BLOCKS = {"BC1": 1, "BC2": 2, "BC3": 3, "BC7": 7}


class Format:
    def __init__(self, name, kind, component_bytes, components, numbers, bgra):
        self.name, self.kind, self.component_bytes = _NAMES.get(name, name), kind, component_bytes
        self.components, self.numbers, self.bgra = components, numbers, bgra

    @property
    def is_depth(self):
        return self.kind in ("D16S8", "D24S8", "D32S8") or self.numbers == "Depth"


def _rgba(values, bgra):
    """n x 4 of n x 1..4: missing colours are 0, and opacity is 1."""
    rgba = np.zeros((len(values), 4), values.dtype)
    rgba[:, 3] = 1
    rgba[:, : values.shape[1]] = values
    return rgba[:, [2, 1, 0, 3]] if bgra else rgba


def _regular(data, count, format):
    letter = {"UNorm": "u", "UNormSRGB": "u", "SNorm": "i", "UInt": "u", "SInt": "i", "Float": "f"}.get(format.numbers)
    if letter is None or (letter == "f" and format.component_bytes == 1):
        return None
    values = np.frombuffer(data, f"<{letter}{format.component_bytes}", count * format.components)
    values = values.reshape(count, format.components)
    if "Norm" in format.numbers:
        most = (1 << 8 * format.component_bytes - (letter == "i")) - 1
        values = np.maximum(values / np.float64(most), -1).astype(np.float32)
    elif letter == "f":
        values = values.astype(np.float32)
    else:
        values = values.astype(f"{letter}4")
    return _rgba(values, format.bgra)


def _packed(data, count, bits, bgra):
    words = np.frombuffer(data, "<u4" if sum(bits) == 32 else "<u2", count).astype(np.uint32)
    values, shift = np.empty((count, len(bits)), np.float32), 0
    for channel, width in enumerate(bits):
        most = (1 << width) - 1
        values[:, channel] = (words >> shift & most) / np.float32(most)
        shift += width
    return _rgba(values, bgra)


def _small_floats(data, count):
    """R11G11B10: floats of 5 bits of exponent and 6, 6 and 5 of mantissa, without a sign: halves without low bits."""
    words = np.frombuffer(data, "<u4", count)
    parts = [(words & 0x7FF) << 4, (words >> 11 & 0x7FF) << 4, (words >> 22) << 5]
    return _rgba(np.stack(parts, 1).astype(np.uint16).view(np.float16).astype(np.float32), False)


def _shared_exponent(data, count):
    words = np.frombuffer(data, "<u4", count)
    scale = np.exp2((words >> 27).astype(np.float32) - 24)
    return _rgba(np.stack([(words >> shift & 511) * scale for shift in (0, 9, 18)], 1).astype(np.float32), False)


def _unpacked(data, width, height, format):
    """RGBA, width * height x 4, or None if the format is not known."""
    count = width * height
    if format.kind == "Regular":
        return _regular(data, count, format)
    if format.kind in _PACKED:
        return _packed(data, count, _PACKED[format.kind], format.bgra)
    if format.kind == "R11G11B10":
        return _small_floats(data, count)
    if format.kind == "R9G9B9E5":
        return _shared_exponent(data, count)
    if format.kind in _BLOCKS:
        from PIL import Image
        picture = Image.frombytes("RGBA", (width, height), data, "bcn", _BLOCKS[format.kind])
        return np.asarray(picture).reshape(count, 4)
    return None


def size_in_bytes(width, height, format):
    """Of one picture, rows without gaps."""
    if format.kind in _BLOCKS:
        return (width + 3) // 4 * ((height + 3) // 4) * (8 if format.kind == "BC1" else 16)
    if format.kind in ("R5G6B5", "R5G5B5A1", "R4G4B4A4"):
        return 2 * width * height
    if format.kind == "D32S8":
        return 8 * width * height
    if format.kind != "Regular":
        return 4 * width * height
    return width * height * format.components * (4 if format.is_depth and format.component_bytes == 3
                                                 else format.component_bytes)


def stored(data, width, height, format):
    """(name of a trace's format, bytes) of one level of one layer; None if the format is not known."""
    if format.name in STORED:
        return format.name, data
    if format.is_depth:
        depth = decode_depth(data, width, height, format)
        return None if depth is None else ("D32_SFLOAT", depth.tobytes())
    rgba = _unpacked(data, width, height, format)
    if rgba is None:
        return None
    if rgba.dtype == np.uint8:  # blocks
        return "R8G8B8A8_SRGB" if format.numbers == "UNormSRGB" else "R8G8B8A8_UNORM", rgba.tobytes()
    return f"R32G32B32A32_{ {'u': 'UINT', 'i': 'SINT', 'f': 'SFLOAT'}[rgba.dtype.kind]}", rgba.tobytes()


def decode_color(data, width, height, format):
    """height x width x 4 float32, or None if the format is not known. sRGB codes come as stored, 0..1."""
    rgba = _unpacked(data, width, height, format)
    if rgba is None:
        return None
    if rgba.dtype == np.uint8:
        rgba = rgba / np.float32(255)
    return rgba.astype(np.float32).reshape(height, width, 4)


def decode_depth(data, width, height, format):
    """height x width float32 of window depths, 0..1, or None if the format is not known."""
    count = width * height
    if format.kind == "D24S8" or (format.kind == "Regular" and format.component_bytes == 3):
        depth = (np.frombuffer(data, "<u4", count) & 0xFFFFFF) / 16777215.0
    elif format.kind == "D32S8":
        depth = np.frombuffer(data, "<f4", 2 * count)[::2]
    elif format.component_bytes == 2:
        depth = np.frombuffer(data, "<u2", count) / 65535.0
    elif format.component_bytes == 4:
        depth = np.frombuffer(data, "<f4", count)
    else:
        return None
    return np.ascontiguousarray(depth, np.float32).reshape(height, width)


def decode_stencil(data, width, height, format):
    """height x width uint8, or None if the format has no stencil."""
    if format.kind not in ("D24S8", "D32S8"):
        return None
    words = np.frombuffer(data, "<u4", len(data) // 4)
    stencil = words[: width * height] >> 24 if format.kind == "D24S8" else words[1: 2 * width * height: 2] & 255
    return stencil.astype(np.uint8).reshape(height, width)
