#!/usr/bin/env python3
"""Puts the same part of several pictures side by side, enlarged.

usage: docs/detail.py LEFT,TOP,WIDTH,HEIGHT SCALE PICTURE.png... -o DETAIL.png

The pictures are those of `beampipe run`: PNG files with 8 or 16 bits for each of R, G, B, and A if there is one.
"""
import struct
import sys
import zlib

GAP = 8  # pixels between the parts, white


def chunks(data):
    at = 8
    while at < len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        yield kind, data[at + 8:at + 8 + length]
        at += 12 + length


def paeth(left, up, corner):
    estimate = left + up - corner
    return min((left, up, corner), key=lambda each: abs(estimate - each))


def rows_of(path):
    """The rows of a picture, each a list of (R, G, B) with 8 bits."""
    with open(path, "rb") as file:
        found = list(chunks(file.read()))
    width, _, bits, color = struct.unpack(">IIBB", found[0][1][:10])
    channels, size = {2: 3, 6: 4}[color], bits // 8
    step = channels * size  # bytes of a pixel
    raw = zlib.decompress(b"".join(content for kind, content in found if kind == b"IDAT"))
    rows, above = [], bytearray(width * step)
    for start in range(0, len(raw), width * step + 1):
        line = bytearray(raw[start + 1:start + 1 + width * step])
        for i in range(len(line)):
            left, corner = (line[i - step], above[i - step]) if i >= step else (0, 0)
            line[i] = line[i] + [0, left, above[i], (left + above[i]) // 2, paeth(left, above[i], corner)][raw[start]] & 255
        rows.append([tuple(line[x * step + c * size] for c in range(3)) for x in range(width)])
        above = line
    return rows


def write(path, rows):
    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    raw = b"".join(b"\0" + bytes(value for pixel in row for value in pixel) for row in rows)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2, 0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b""))


def main(part, scale, pictures, output):
    left, top, width, height = map(int, part.split(","))
    joined = [[] for _ in range(height)]
    for path in pictures:
        for row, line in zip(joined, rows_of(path)[top:top + height]):
            row += [(255, 255, 255)] * (GAP if row else 0)
            row += [pixel for pixel in line[left:left + width] for _ in range(int(scale))]
    write(output, [row for row in joined for _ in range(int(scale))])


if __name__ == "__main__":
    match sys.argv[1:]:
        case [part, scale, *pictures, "-o", output] if pictures:
            main(part, scale, pictures, output)
        case _:
            sys.exit(__doc__.strip())
