"""Reads the state of the current draw from RenderDoc's replay, for OpenGL (and ES) and Vulkan, as plain numbers and
RenderDoc's names. state.py turns it into a trace's state."""
import struct

import renderdoc as rd

# SPIR-V instructions that end a fragment: OpKill, OpTerminateInvocation, OpDemoteToHelperInvocation.
_SPIRV_KILLS = {252, 4416, 5380}


def can_discard(shader):
    """Whether a fragment shader has an instruction that discards fragments."""
    if shader is None:
        return False
    code = bytes(shader.rawBytes)
    if shader.encoding != rd.ShaderEncoding.SPIRV:
        return b"discard" in code
    words = struct.unpack(f"<{len(code) // 4}I", code[: len(code) // 4 * 4])
    place = 5  # after the header
    while place < len(words):
        if words[place] & 0xFFFF in _SPIRV_KILLS:
            return True
        place += max(1, words[place] >> 16)
    return False


def _stencil(face):
    return {"function": face.function.name, "reference": face.reference, "compare_mask": face.compareMask,
            "write_mask": face.writeMask, "fail": face.failOperation.name, "depth_fail": face.depthFailOperation.name,
            "pass": face.passOperation.name}


def read_state(controller, is_vulkan, depth_format):
    """The state of the current draw; see state.state_of()."""
    pipe = controller.GetPipelineState()
    if is_vulkan:
        vulkan = controller.GetVulkanPipelineState()
        raster, depth = vulkan.rasterizer, vulkan.depthStencil
        blends = vulkan.colorBlend.blends
        api = {
            "y_up": False, "z_from_0": not vulkan.viewportScissor.depthNegativeOneToOne,
            "depth_clamp": not raster.depthClipEnable,
            "depth_test": depth.depthTestEnable, "depth_write": depth.depthWriteEnable,
            "stencil_test": depth.stencilTestEnable, "front": depth.frontFace, "back": depth.backFace,
            "bias_enabled": raster.depthBiasEnable, "bias_clamp": raster.depthBiasClamp,
            "discards_all": raster.rasterizerDiscardEnable,
        }
    else:
        gl = controller.GetGLPipelineState()
        raster, depth = gl.rasterizer.state, gl.depthState
        blends = gl.framebuffer.blendState.blends
        api = {
            "y_up": gl.vertexProcessing.clipOriginLowerLeft, "z_from_0": not gl.vertexProcessing.clipNegativeOneToOne,
            "depth_clamp": raster.depthClamp, "depth_test": depth.depthEnable, "depth_write": depth.depthWrites,
            "stencil_test": gl.stencilState.stencilEnable, "front": gl.stencilState.frontFace,
            "back": gl.stencilState.backFace, "bias_enabled": True, "bias_clamp": raster.offsetClamp,
            "discards_all": gl.vertexProcessing.discard,
        }
    viewport, scissor = pipe.GetViewport(0), pipe.GetScissor(0)
    blend = blends[0] if len(blends) else None
    front, back, stencil_test = api.pop("front"), api.pop("back"), api.pop("stencil_test")
    biased = api.pop("bias_enabled")
    api.update(
        viewport=[viewport.x, viewport.y, viewport.width, viewport.height],
        depth_range=[viewport.minDepth, viewport.maxDepth],
        scissor=[scissor.x, scissor.y, scissor.width, scissor.height] if scissor.enabled else None,
        depth_function=depth.depthFunction.name, bias=raster.depthBias if biased else 0,
        slope_bias=raster.slopeScaledDepthBias if biased else 0, depth_format=depth_format,
        front_ccw=raster.frontCCW, cull=raster.cullMode.name, fill=raster.fillMode.name,
        color_mask=blend.writeMask if blend else 0,
        blend={"source": blend.colorBlend.source.name, "destination": blend.colorBlend.destination.name,
               "operation": blend.colorBlend.operation.name} if blend and blend.enabled else None,
        stencil=_stencil(back if raster.cullMode.name == "Front" else front) if stencil_test else None,
        topology=pipe.GetPrimitiveTopology().name)
    return api


_WRAP = {"Wrap": "repeat", "Mirror": "mirror", "MirrorOnce": "mirror"}
_SWIZZLE = {"Red": "r", "Green": "g", "Blue": "b", "Alpha": "a", "Zero": "0", "One": "1"}


def _swizzle(swizzle):
    return "".join(_SWIZZLE.get(getattr(swizzle, channel).name, "0") for channel in ("red", "green", "blue", "alpha"))


class _Sampler:
    def __init__(self, u, v, filter):
        self.wrap = [_WRAP.get(mode.name, "clamp") for mode in (u, v)]
        self.nearest = filter.magnify.name == "Point"
        self.mips = filter.mip.name != "NoFilter"


def _binding(texture, swizzle, sampler):
    return {"id": int(texture), "swizzle": _swizzle(swizzle), "wrap": sampler.wrap if sampler else ["repeat", "repeat"],
            "nearest": bool(sampler and sampler.nearest), "mips": bool(not sampler or sampler.mips)}


def read_textures(controller, is_vulkan):
    """The textures that the current draw's fragment shader may read: dictionaries of id, swizzle,
    wrap (of u and v), nearest (the filter) and mips (whether levels are used)."""
    pipe = controller.GetPipelineState()
    found = []
    if is_vulkan:
        vulkan = controller.GetVulkanPipelineState()
        sets = vulkan.graphics.descriptorSets
        samplers = [_Sampler(bind.addressU, bind.addressV, bind.filter) for s in sets for b in s.bindings
                    for bind in list(b.binds)[:1] if bind.samplerResourceId != rd.ResourceId.Null()]
        for array in pipe.GetReadOnlyResources(rd.ShaderStage.Pixel, True):
            point = array.bindPoint
            if point.bindset < 0 or point.bindset >= len(sets) or point.bind >= len(sets[point.bindset].bindings):
                continue
            for element in list(sets[point.bindset].bindings[point.bind].binds)[:1]:
                if element.samplerResourceId != rd.ResourceId.Null():
                    sampler = _Sampler(element.addressU, element.addressV, element.filter)
                else:
                    sampler = samplers[0] if samplers else None
                found.append(_binding(element.resourceResourceId, element.swizzle, sampler))
    else:
        gl = controller.GetGLPipelineState()
        for array in pipe.GetReadOnlyResources(rd.ShaderStage.Pixel, True):
            unit = array.bindPoint.bind
            if not 0 <= unit < len(gl.textures):
                continue
            texture, state = gl.textures[unit], gl.samplers[unit]
            sampler = _Sampler(state.addressS, state.addressT, state.filter)
            found.append(_binding(texture.resourceId, texture.swizzle, sampler))
    return [texture for texture in found if texture["id"]]
