#!/usr/bin/env python3
"""Writes a large glTF model, a wavy sheet with normals, tangents and texture coordinates, to time its import.

usage: docs/large_gltf.py FILE.glb TRIANGLES
"""
import array
import json
import math
import struct
import sys


def main():
    file, triangles = sys.argv[1], int(sys.argv[2])
    side = max(round(math.sqrt(triangles / 2)), 1)
    vertices = [(x / side, y / side) for y in range(side + 1) for x in range(side + 1)]
    positions, normals, tangents, uvs = (array.array("f") for _ in range(4))
    for u, v in vertices:
        slope = 0.1 * math.cos(20 * u)  # of z = 0.005 sin(20 u)
        length = math.hypot(slope, 1)
        positions.extend((u, v, 0.005 * math.sin(20 * u)))
        normals.extend((-slope / length, 0, 1 / length))
        tangents.extend((1 / length, 0, slope / length, 1))
        uvs.extend((u, 1 - v))
    indices = array.array("I")
    for y in range(side):
        for x in range(side):
            a = y * (side + 1) + x
            indices.extend((a, a + 1, a + side + 2, a, a + side + 2, a + side + 1))
    parts = [(positions, 5126, "VEC3"), (normals, 5126, "VEC3"), (tangents, 5126, "VEC4"), (uvs, 5126, "VEC2"),
             (indices, 5125, "SCALAR")]
    views, accessors, offset = [], [], 0
    for i, (numbers, component, kind) in enumerate(parts):
        size = numbers.itemsize * len(numbers)
        views.append({"buffer": 0, "byteOffset": offset, "byteLength": size})
        count = len(numbers) // {"VEC4": 4, "VEC3": 3, "VEC2": 2, "SCALAR": 1}[kind]
        accessors.append({"bufferView": i, "componentType": component, "count": count, "type": kind})
        offset += size
    accessors[0]["min"], accessors[0]["max"] = [0, 0, -0.005], [1, 1, 0.005]
    model = {"asset": {"version": "2.0"}, "buffers": [{"byteLength": offset}], "bufferViews": views,
             "accessors": accessors, "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0}}],
             "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1, "TANGENT": 2, "TEXCOORD_0": 3},
                                         "indices": 4, "material": 0}]}],
             "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0}
    text = json.dumps(model).encode()
    text += b" " * (-len(text) % 4)
    with open(file, "wb") as out:
        out.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + offset))
        out.write(struct.pack("<I4s", len(text), b"JSON") + text)
        out.write(struct.pack("<I4s", offset, b"BIN\0"))
        for numbers, _, _ in parts:
            out.write(numbers.tobytes())


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main()
