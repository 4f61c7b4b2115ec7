"""The meshes, materials and textures of a trace, gathered from the draws of one or more frames."""
import numpy as np

import geometry
import motion
import srgb


class Mesh:
    """One stored mesh. Baked colours are sums over all frames that show it."""

    def __init__(self, name, draw, material):
        self.name, self.material = name, material
        self.bakes = draw.look is None  # its triangles have colours of their own, from the picture
        self.clip, self.triangles, self.topology = draw.clip, draw.triangles, draw.topology
        look = draw.look
        uv = look.uv if look else draw.alpha_test.uv if draw.alpha_test else None
        self.uv = np.ascontiguousarray(draw.attributes[uv][:, :2]) if uv else None
        self.lit = bool(look and look.light is not None)  # its vertices' colours are from the first frame's picture
        self.vertex_colors = (_color_codes(look.light) if self.lit else
                              _color_codes(draw.attributes[look.color]) if look and look.color else None)
        self.sums = np.zeros((len(draw.triangles), 3))
        self.counts = np.zeros(len(draw.triangles), np.int64)
        self.middle = np.zeros((len(draw.triangles), 3))

    def matrix_to(self, other):
        """The matrix that makes this mesh the other one, or None."""
        same = (self.material == other.material and self.topology == other.topology
                and self.clip.shape == other.clip.shape and np.array_equal(self.triangles, other.triangles)
                and _equal(self.uv, other.uv) and self.lit == other.lit
                and (self.lit or _equal(self.vertex_colors, other.vertex_colors)))
        return motion.find_matrix(self.clip, other.clip) if same else None

    def add_colors(self, sums, counts, middle):
        if not self.counts.any():
            self.middle = middle
        self.sums += sums
        self.counts += counts

    def welded(self):
        """(positions4, uv0 or None, vertex_colors or None, indices, linear colours of triangles or None)."""
        clip, uv, vertex_colors, triangles, colors = self.clip, self.uv, self.vertex_colors, self.triangles, None
        if self.bakes:
            owned = self.counts > 0
            colors = np.where(owned[:, None], self.sums / np.maximum(1, self.counts)[:, None], self.middle)
        if self.bakes and self.material:  # a material's colours are its vertices': each triangle gets its own
            corners = triangles.ravel()
            clip, uv, triangles = clip[corners], uv[corners], np.arange(len(corners)).reshape(-1, 3)
            vertex_colors = _color_codes(np.repeat(srgb.from_linear(np.clip(colors, 0, 1)), 3, 0))
            colors = None
        columns, indices, kept = geometry.weld([clip] + [c for c in (uv, vertex_colors) if c is not None], triangles)
        rest = iter(columns[1:])
        return (columns[0], next(rest) if uv is not None else None, next(rest) if vertex_colors is not None else None,
                indices, None if colors is None else colors[kept])


def _color_codes(values):
    """RGBA as 8 bits. The program's colours count as sRGB-encoded, as its picture does."""
    codes = np.full((len(values), 4), 255, np.uint8)
    codes[:, : values.shape[1]] = np.rint(np.clip(values[:, :4], 0, 1) * 255)
    return codes


def _equal(a, b):
    return (a is None and b is None) or (a is not None and b is not None and np.array_equal(a, b))


class Collection:
    """Gathers frames. `meshes`, `materials` (by name) and `images` (name -> RGB or RGBA texels) are the result."""

    def __init__(self, textures):
        self.textures = textures
        self.meshes, self.materials, self.images = [], {}, {}
        self._by_size, self._material_names = {}, {}

    def add_frame(self, frame, colors):
        """The frame's draws as a trace has them; `colors`: shading.picture_colors()."""
        draws, taken = [], set()
        for draw in frame.draws:
            material = self._material_of(draw)
            part = slice(draw.first, draw.first + len(draw.triangles))
            mesh, matrix = self._mesh_of(draw, material, taken)
            taken.add(mesh.name)
            if mesh.bakes:
                mesh.add_colors(*(values[part] for values in colors))
            entry = {"mesh": mesh.name, "cull": draw.cull}
            if not np.array_equal(matrix, np.eye(4)):
                entry["transform"] = [float(value) for value in matrix.T.ravel()]
            state = dict(draw.state)
            if draw.look is None or not draw.look.mixes:
                state.pop("blend", None)  # the picture's colours are what blending has made
            if draw.is_ground:
                state.pop("color_mask")
            if state:
                entry["state"] = state
            draws.append(entry)
        return draws

    def _mesh_of(self, draw, material, taken):
        """A mesh of an earlier frame that only moved, or a new one."""
        new = Mesh(f"mesh{len(self.meshes)}", draw, material)
        size = (len(draw.clip), len(draw.triangles), draw.topology, material)
        for mesh in self._by_size.get(size, []):
            if mesh.name in taken:  # draws of one frame do not share a mesh: each has its own colours
                continue
            matrix = mesh.matrix_to(new)
            if matrix is not None:
                return mesh, matrix
        self.meshes.append(new)
        self._by_size.setdefault(size, []).append(new)
        return new, np.eye(4)

    def _material_of(self, draw):
        """The name of the draw's material, or None if its triangles have colours of their own and no alpha test."""
        look, test = draw.look, draw.alpha_test
        if look is None and test is None:
            return None
        material = {"unlit": True, "double_sided": True}
        blends = draw.blends and look is not None and look.mixes
        slot = look.slot if look else test.slot
        if slot is not None:
            binding = draw.textures[slot]
            texture = self.textures.get(binding)
            channels = "a" if look is None else "rgba" if texture.has_alpha and (blends or test) else "rgb"
            found = {"image": self._image_of(binding, texture, channels)}
            for key, mode in zip(("wrap_u", "wrap_v"), texture.wrap):
                if mode != "repeat":
                    found[key] = mode
            if texture.nearest:
                found["magnify"] = "nearest"
            if len(texture.levels) == 1:
                found["mip"] = "none"
            material["base_texture"] = found
        if test:
            material.update(alpha_mode="mask", alpha_cutoff=round(test.cutoff, 6))
        if blends and "alpha_mode" not in material:
            material["alpha_mode"] = "blend"
        if look and look.constant is not None:
            material["base_color"] = [round(float(c), 6) for c in look.constant] + [1]
        key = repr(sorted(material.items()))
        if key not in self._material_names:
            self._material_names[key] = f"material{len(self.materials)}"
            self.materials[self._material_names[key]] = material
        return self._material_names[key]

    def _image_of(self, binding, texture, channels):
        """The name of the texture's image with some of its channels; "a": white with the texture's opacity."""
        name = f"texture{binding['id']}{'' if binding['swizzle'] == 'rgba' else '_' + binding['swizzle']}_{channels}"
        if name not in self.images:
            texels = np.rint(texture.texels * 255).astype(np.uint8)
            if channels == "a":
                texels[..., :3] = 255
            self.images[name] = texels[..., :3] if channels == "rgb" else texels
        return name
