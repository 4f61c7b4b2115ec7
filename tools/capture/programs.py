"""Reads from RenderDoc's replay what the current draw's fragment shader is and what is bound to it, as plain numbers
and bytes, in the words of a trace."""
import struct

import renderdoc as rd

import spirv
from state import COMPARE

_NULL = rd.ResourceId.Null()
_STAGE = rd.ShaderStage.Pixel
_WRAP = {"Wrap": "repeat", "Mirror": "mirror", "MirrorOnce": "mirror_clamp", "ClampEdge": "clamp_to_edge",
         "ClampBorder": "clamp_to_border"}
_SWIZZLE = {"Red": "r", "Green": "g", "Blue": "b", "Alpha": "a", "Zero": "0", "One": "1"}
_SHAPE = {"Texture1D": ("1d", False), "Texture1DArray": ("1d", True), "Texture2D": ("2d", False),
          "TextureRect": ("2d", False), "Texture2DArray": ("2d", True), "Texture3D": ("3d", False),
          "TextureCube": ("cube", False), "TextureCubeArray": ("cube", True)}
_INTEGERS = ("UInt", "SInt")
POINT_COORDINATES = 31  # the location of gl_PointCoord, which a trace has as a varying


def input_of(parameter, ways):
    """A trace's input from a parameter of RenderDoc's signature; `ways`: spirv.interpolations()."""
    mask = parameter.regChannelMask
    found = {"location": parameter.regIndex, "count": parameter.compCount}
    component = (mask & -mask).bit_length() - 1
    if component > 0:
        found["component"] = component
    way = spirv.interpolation_at(ways, parameter.regIndex)
    if way != "smooth":
        found["interpolation"] = way
    if parameter.varType.name in _INTEGERS:
        found["integer"] = True
    return found


def _sampler(bind):
    is_linear = lambda mode: "nearest" if mode.name in ("Point", "NoFilter") else "linear"
    found = {"mag": is_linear(bind.filter.magnify), "min": is_linear(bind.filter.minify),
             "mip": is_linear(bind.filter.mip),
             "wrap": [_WRAP[mode.name] for mode in (bind.addressU, bind.addressV, bind.addressW)],
             "lod_bias": bind.mipBias, "least_lod": bind.minLOD, "most_lod": bind.maxLOD,
             "anisotropy": max(1, bind.maxAnisotropy), "border": list(bind.borderColor),
             "unnormalized": bind.unnormalized}
    if bind.filter.filter.name == "Comparison":
        found["compare"] = COMPARE[bind.compareFunction.name]
    return found


class Programs:
    """Reads the programs of a replay's draws."""

    def __init__(self, replay):
        self.replay, self.controller = replay, replay.controller

    def read(self):
        """The current draw's program, as a dictionary; None if it has no fragment shader. `images`: with the number of
        the texture in place of the image."""
        self.pipe, self.vulkan = self.controller.GetPipelineState(), self.controller.GetVulkanPipelineState()
        shader, mapping = self.pipe.GetShaderReflection(_STAGE), self.pipe.GetBindpointMapping(_STAGE)
        if shader is None:
            return None
        module = bytes(shader.rawBytes)
        ways = spirv.interpolations(module)
        module, has_coordinates = spirv.with_point_coordinates(module, POINT_COORDINATES)
        coordinates = [{"location": POINT_COORDINATES, "count": 2}] if has_coordinates else []
        buffers, specialization = self._blocks(shader, mapping)
        images, storage = self._resources(shader, mapping)
        return {"spirv": module, "specialization": specialization, "buffers": buffers + storage, "images": images,
                "inputs": [input_of(one, ways) for one in shader.inputSignature
                           if one.systemValue == rd.ShaderBuiltin.Undefined] + coordinates,
                "push_constants": bytes(self.vulkan.pushconsts)}

    def _bytes(self, buffer, offset, size):
        return bytes(self.controller.GetBufferData(buffer, offset, size)) if size else b""

    def _blocks(self, shader, mapping):
        """(uniform buffers, specialization constants)."""
        buffers, specialization = [], []
        for slot, block in enumerate(shader.constantBlocks):
            if block.compileConstants:
                data = bytes(self.vulkan.fragmentShader.specializationData)
                for number, one in zip(self.vulkan.fragmentShader.specializationIds, block.variables):
                    bits = data[one.byteOffset: one.byteOffset + 4].ljust(4, b"\0")
                    specialization.append({"id": number, "bits": struct.unpack("<I", bits)[0]})
            elif block.bufferBacked:
                point = mapping.constantBlocks[block.bindPoint]
                for element in range(min(point.arraySize, 1 << 10)):
                    bound = self.pipe.GetConstantBuffer(_STAGE, slot, element)
                    data = bytes(bound.inlineData)
                    if bound.resourceId != _NULL:
                        data = self._bytes(bound.resourceId, bound.byteOffset, min(bound.byteSize, block.byteSize))
                    if data:
                        buffers.append({"set": point.bindset, "binding": point.bind, "element": element,
                                        "bytes": data})
        return buffers, specialization

    def _elements(self, point):
        """(place, binding) of each element that is bound at a bind point."""
        bindings = self.vulkan.graphics.descriptorSets[point.bindset].bindings
        if not point.used or point.bind >= len(bindings):
            return
        for element, bind in enumerate(bindings[point.bind].binds):
            yield {"set": point.bindset, "binding": point.bind, "element": element}, bind

    def _resources(self, shader, mapping):
        """(images, storage buffers)."""
        images, buffers = [], []
        for resource in shader.readOnlyResources:
            for place, bind in self._elements(mapping.readOnlyResources[resource.bindPoint]):
                if bind.resourceResourceId == _NULL:
                    continue
                if resource.resType.name in _SHAPE:
                    images.append({**place, **self._view(resource, bind)})
                elif not resource.isTexture:
                    data = self._bytes(bind.resourceResourceId, bind.byteOffset, bind.byteSize)
                    buffers.append({**place, "bytes": data})
        for resource in shader.readWriteResources:
            for place, bind in self._elements(mapping.readWriteResources[resource.bindPoint]):
                if not resource.isTexture and bind.resourceResourceId != _NULL:
                    data = self._bytes(bind.resourceResourceId, bind.byteOffset, bind.byteSize)
                    buffers.append({**place, "bytes": data})
        for sampler in shader.samplers:
            for place, bind in self._elements(mapping.samplers[sampler.bindPoint]):
                if bind.samplerResourceId != _NULL:
                    images.append({**place, "sampler": _sampler(bind)})
        return images, buffers

    def _view(self, resource, bind):
        texture = self.replay.textures[int(bind.resourceResourceId)]
        shape, is_array = _SHAPE[resource.resType.name]
        found = {"texture": int(bind.resourceResourceId), "format": self.replay.format_named(bind.viewFormat),
                 "shape": shape, "array": is_array}
        if bind.samplerResourceId != _NULL:
            found["sampler"] = _sampler(bind)
        swizzle = "".join(_SWIZZLE.get(getattr(bind.swizzle, channel).name, "0")
                          for channel in ("red", "green", "blue", "alpha"))
        layers = texture.arraysize if shape != "3d" else 1
        for key, value, usual in (("swizzle", swizzle, "rgba"), ("base_level", bind.firstMip, 0),
                                  ("base_layer", bind.firstSlice if shape != "3d" else 0, 0),
                                  ("levels", min(bind.numMips, texture.mips - bind.firstMip), texture.mips),
                                  ("layers", min(bind.numSlices, layers - bind.firstSlice) if shape != "3d" else 1,
                                   layers)):
            if value != usual:
                found[key] = value
        return found
