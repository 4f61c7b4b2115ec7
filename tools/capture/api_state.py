"""Reads the state of the current draw from RenderDoc's replay of Vulkan, as plain numbers and RenderDoc's names.
state.py turns it into a trace's state."""


def _stencil(face):
    return {"function": face.function.name, "reference": face.reference, "compare_mask": face.compareMask,
            "write_mask": face.writeMask, "fail": face.failOperation.name, "depth_fail": face.depthFailOperation.name,
            "pass": face.passOperation.name}


def _equation(blend):
    return {"source": blend.source.name, "destination": blend.destination.name, "operation": blend.operation.name}


def color_view(controller, target):
    """RenderDoc's format in which the current draw sees a colour target; None if it does not draw to it. Views decide
    whether colours are encoded for sRGB: those of a program that turns GL_FRAMEBUFFER_SRGB on and off, for instance,
    differ from the image's own format."""
    attachments = controller.GetVulkanPipelineState().currentPass.framebuffer.attachments
    return next((one.viewFormat for one in attachments if int(one.imageResourceId) == target), None)


def read_state(controller, depth_format, color_format):
    """The state of the current draw; see state.state_of()."""
    pipe, vulkan = controller.GetPipelineState(), controller.GetVulkanPipelineState()
    raster, depth, biased = vulkan.rasterizer, vulkan.depthStencil, vulkan.rasterizer.depthBiasEnable
    blend = vulkan.colorBlend.blends[0] if len(vulkan.colorBlend.blends) else None
    viewport, scissor = pipe.GetViewport(0), pipe.GetScissor(0)
    return {
        "z_from_0": not vulkan.viewportScissor.depthNegativeOneToOne, "depth_clamp": not raster.depthClipEnable,
        "depth_test": depth.depthTestEnable, "depth_write": depth.depthWriteEnable,
        "depth_function": depth.depthFunction.name, "depth_format": depth_format,
        "color_format": color_format,
        "bias": raster.depthBias if biased else 0, "slope_bias": raster.slopeScaledDepthBias if biased else 0,
        "bias_clamp": raster.depthBiasClamp, "discards_all": raster.rasterizerDiscardEnable,
        "viewport": [viewport.x, viewport.y, viewport.width, viewport.height],
        "depth_range": [viewport.minDepth, viewport.maxDepth],
        "scissor": [scissor.x, scissor.y, scissor.width, scissor.height] if scissor.enabled else None,
        "line_width": raster.lineWidth, "line_mode": raster.lineRasterMode.name,
        "has_stipple": raster.lineStippleFactor > 0 and raster.lineStipplePattern != 0xFFFF,
        "front_ccw": raster.frontCCW, "cull": raster.cullMode.name, "fill": raster.fillMode.name,
        # OpenGL has it without multisampling, too, where it does nothing.
        "alpha_to_coverage": vulkan.colorBlend.alphaToCoverageEnable and vulkan.multisample.rasterSamples > 1,
        "logic_operation": blend.logicOperation.name if blend and blend.logicOperationEnabled else None,
        "color_mask": blend.writeMask if blend else 0,
        "blend": {"color": _equation(blend.colorBlend), "alpha": _equation(blend.alphaBlend),
                  "constant": list(vulkan.colorBlend.blendFactor)} if blend and blend.enabled else None,
        "stencil": (_stencil(depth.frontFace), _stencil(depth.backFace)) if depth.stencilTestEnable else None}
