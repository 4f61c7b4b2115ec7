"""Writes a trace: FRAME.json, its arrays in FRAME.bin, its pictures as PNG files beside them.

Each file gets its name when it is complete, and the JSON file last, so that a trace is either there or not."""
import json
import os

import numpy as np

import png


class Buffer:
    """The bytes of FRAME.bin, and views of them."""

    def __init__(self, name):
        self.name, self.parts, self.size = name, [], 0

    def view(self, array, kind):
        """Adds an array; `kind` is the view's type: float32, uint32, uint16 or uint8."""
        data = np.ascontiguousarray(array, {"float32": "<f4", "uint32": "<u4", "uint16": "<u2", "uint8": "u1"}[kind])
        self.parts += [b"\0" * (-self.size % 4), data.tobytes()]
        offset = self.size + (-self.size % 4)
        self.size = offset + data.nbytes
        return {"buffer": self.name, "offset": offset, "count": int(data.size), "type": kind}


def mesh_entry(mesh, buffer):
    """A mesh of a trace, or None if none of its triangles has an area."""
    positions, varyings, indices = mesh.welded()
    if not len(indices):
        return None
    entry = {"positions4": buffer.view(positions, "float32"),
             "indices": buffer.view(indices, "uint16" if len(positions) <= 65536 else "uint32")}
    if varyings.shape[1]:
        entry["varyings"] = buffer.view(varyings, "uint32")
    return entry


def json_text(trace):
    """The trace as JSON, a mesh, program, image or draw a line."""
    one = lambda value: json.dumps(value, separators=(",", ":"))
    named = lambda values: "{" + ",".join(f"\n  {one(key)}:{one(value)}" for key, value in values.items()) + "}"
    listed = lambda values: "[" + ",".join(f"\n  {one(value)}" for value in values) + "]"
    frames = []
    for frame in trace["frames"]:
        rest = one({key: value for key, value in frame.items() if key != "draws"})
        frames.append(rest[:-1] + ',"draws":[' + ",".join("\n  " + one(draw) for draw in frame["draws"]) + "]}")
    form = {"images": named, "meshes": named, "programs": listed, "program_images": listed}
    parts = [f'"{key}":{form.get(key, one)(value)}' for key, value in trace.items() if key != "frames"]
    return "{" + ",\n".join(parts + ['"frames":[\n' + ",\n".join(frames) + "]"]) + "}\n"


def write_all(files):
    """Writes (path, bytes) pairs so that all of them have their names at the end, the last one last."""
    unfinished = []
    try:
        for path, data in files:
            temporary = f"{path}.{os.getpid()}.part"
            unfinished.append(temporary)
            with open(temporary, "wb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
        for path, _ in files:
            os.rename(f"{path}.{os.getpid()}.part", path)
    finally:
        for temporary in unfinished:
            if os.path.exists(temporary):
                os.remove(temporary)


def write_trace(path, frames, draws_of_frames, collection, source):
    """Writes the trace of frame.Frame objects with the draws that meshes.Collection made of them. Returns the trace, and
    the bytes of all its files."""
    stem = os.path.splitext(os.path.basename(path))[0]
    folder = os.path.dirname(path) or "."
    arrays, depths = Buffer("arrays"), Buffer("depths")
    files, images, meshes = [], {}, {}

    def add_image(name, pixels):
        file = f"{stem}_{name}.png"
        images[name] = {"file": file}
        files.append((os.path.join(folder, file), png.encode(pixels)))

    without_area = {}
    for mesh in collection.meshes:
        entry = mesh_entry(mesh, arrays)
        stored = entry["indices"]["count"] // 3 if entry else 0
        without_area[mesh.name] = len(mesh.triangles) - stored
        if entry:
            meshes[mesh.name] = entry
    programs = [{**one, "spirv": arrays.view(one["spirv"], "uint32")} for one in collection.programs.entries]
    program_images = [{**one, "texels": arrays.view(one["texels"], "uint8")} for one in collection.images.entries]
    written = []
    for number, (frame, draws) in enumerate(zip(frames, draws_of_frames)):
        thin = [without_area[draw["mesh"]] for draw in draws if without_area[draw["mesh"]]]
        if thin:
            frame.left_out["two corners of the triangle are one point"] = (len(thin), sum(thin))
        entry = {"width": frame.width, "height": frame.height, "background": frame.background,
                 **({"background_alpha": frame.background_alpha} if frame.background_alpha != 1 else {}),
                 "target": frame.target,
                 "passes": [{"name": one["name"], "width": one["size"][0], "height": one["size"][1],
                             "draws": one["draws"], "triangles": one["triangles"], "kept": one["kept"],
                             "reason": one["reason"]} for one in frame.passes],
                 "left_out": [{"reason": reason, "draws": count, "primitives": primitives}
                              for reason, (count, primitives) in sorted(frame.left_out.items())]}
        captured = {"clear_depth": frame.clear_depth, "samples": frame.samples}
        if frame.color is not None:
            name = "captured" if len(frames) == 1 else f"captured{number}"
            add_image(name, np.rint(frame.color * 255).astype(np.uint8))
            captured["color"] = name
        if frame.depth is not None:
            captured["depth"] = depths.view(np.clip(frame.depth, 0, 1), "float32")
        entry["captured"] = captured
        entry["draws"] = [draw for draw in draws if draw["mesh"] in meshes]
        written.append(entry)
    buffers = {}
    for buffer, suffix in ((arrays, ".bin"), (depths, "_depth.bin")):
        if buffer.size:
            buffers[buffer.name] = {"file": stem + suffix, "bytes": buffer.size}
            files.append((os.path.join(folder, stem + suffix), b"".join(buffer.parts)))
    trace = {"beampipe_trace": 2, "source": source, "buffers": buffers, "images": images, "programs": programs,
             "program_images": program_images, "program_samplers": collection.samplers.entries, "meshes": meshes,
             "frames": written}
    files.append((path, json_text({key: value for key, value in trace.items() if value or key in ("meshes", "frames")})
                  .encode()))
    write_all(files)
    return trace, sum(len(data) for _, data in files)
