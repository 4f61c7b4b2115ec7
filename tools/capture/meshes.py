"""The meshes, programs, images and samplers of a trace, gathered from the draws of one or more frames."""
import base64
import hashlib
import json
import os
import pickle

import numpy as np

import geometry
import motion


class Mesh:
    """One stored mesh. `varyings`: bits of what the inputs of program number `program` have, n x components."""

    def __init__(self, name, draw, program):
        self.name, self.program = name, program
        self.clip, self.varyings, self.triangles = draw.clip, draw.varyings, draw.triangles

    @property
    def key(self):
        """Meshes with the same key are the same."""
        digest = hashlib.sha256(repr((self.program, self.clip.shape)).encode())
        for column in (self.clip, self.varyings, self.triangles):
            digest.update(np.ascontiguousarray(column))
        return digest.digest()

    def matrix_to(self, other):
        """The matrix that makes this mesh the other one, or None."""
        same = np.array_equal(self.triangles, other.triangles) and np.array_equal(self.varyings, other.varyings)
        return motion.find_matrix(self.clip, other.clip) if same else None

    def welded(self):
        """(positions4, varyings, indices)."""
        columns, indices, _ = geometry.weld([self.clip, self.varyings], self.triangles)
        return *columns, indices


class Table:
    """Numbers entries, equal ones once."""

    def __init__(self):
        self.entries, self._numbers = [], {}

    def number(self, key, make):
        """That of the entry with this key; make() makes it when it is new."""
        if key not in self._numbers:
            self._numbers[key] = len(self.entries)
            self.entries.append(make())
        return self._numbers[key]


def _base64(data):
    return base64.b64encode(data).decode()


class Collection:
    """Gathers frames. `meshes`, `programs`, `images` and `samplers` are the result."""

    def __init__(self):
        self.meshes = []
        self.programs, self.images, self.samplers = Table(), Table(), Table()
        self.unread = set()  # formats of images that could not be read
        self._by_key, self._by_size = {}, {}

    def add_frame(self, frame, folder):
        """The frame's draws as a trace has them. `folder`: where the workers left its images."""
        draws, earlier = [], list(self.meshes)
        for draw in frame.draws:
            program = self._program_of(draw.program) if draw.program else None
            mesh, matrix = self._mesh_of(draw, program, len(earlier))
            entry = {"mesh": mesh.name, "cull": draw.cull}
            if not np.array_equal(matrix, np.eye(4)):
                entry["transform"] = [float(value) for value in matrix.T.ravel()]
            if draw.state:
                entry["state"] = draw.state
            if draw.program:
                entry["program"] = self._use_of(draw.program, program, folder)
            draws.append(entry)
        return draws

    def _mesh_of(self, draw, program, earlier):
        """A mesh that is there already, one of the first `earlier` ones that only moved, or a new one."""
        new = Mesh(f"mesh{len(self.meshes)}", draw, program)
        if new.key in self._by_key:
            return self._by_key[new.key], np.eye(4)
        size = (len(draw.clip), len(draw.triangles), program)
        for number in self._by_size.get(size, []):
            matrix = self.meshes[number].matrix_to(new) if number < earlier else None
            if matrix is not None:
                return self.meshes[number], matrix
        self._by_size.setdefault(size, []).append(len(self.meshes))
        self._by_key[new.key] = new
        self.meshes.append(new)
        return new, np.eye(4)

    def _program_of(self, found):
        """The number of the program: its module, its specialization and its inputs."""
        digest = hashlib.sha256(found["spirv"]).hexdigest()
        entry = {"name": digest[:16], "spirv": np.frombuffer(found["spirv"], "<u4"), "inputs": found["inputs"]}
        if found["specialization"]:
            entry["specialization"] = found["specialization"]
        key = json.dumps([digest, found["specialization"], found["inputs"]], sort_keys=True)
        return self.programs.number(key, lambda: entry)

    def _use_of(self, found, program, folder):
        use = {"program": program}
        if found["buffers"]:
            use["buffers"] = [{**one, "bytes": _base64(one["bytes"])} for one in found["buffers"]]
        if found["push_constants"]:
            use["push_constants"] = _base64(found["push_constants"])
        images = [bound for bound in (self._bound(one, folder) for one in found["images"]) if bound]
        if images:
            use["images"] = images
        return use

    def _bound(self, found, folder):
        """A bound image as a trace has it, or None if its format could not be read."""
        bound = {key: value for key, value in found.items() if key not in ("sampler", "image", "shape", "array")}
        if "image" in found:
            with open(os.path.join(folder, found["image"] + ".pickle"), "rb") as file:
                image = pickle.load(file)
            if image is None:
                self.unread.add(found["image"])
                return None
            key = (hashlib.sha256(image["texels"]).digest(), image["width"], image["format"], found["shape"],
                   found["array"])
            bound["image"] = self.images.number(key, lambda: self._image_of(image, found))
        if "sampler" in found:
            key = json.dumps(found["sampler"], sort_keys=True)
            bound["sampler"] = self.samplers.number(key, lambda: found["sampler"])
        return bound

    def _image_of(self, image, found):
        return {"name": f"image{len(self.images.entries)}", "shape": found["shape"], **image,
                **({"array": True} if found["array"] else {}), "texels": np.frombuffer(image["texels"], "u1")}
