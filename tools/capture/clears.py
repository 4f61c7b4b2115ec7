"""What a Vulkan command clears, from RenderDoc's record of its parameters."""
from passes import Clears, clears_of

_COLOR, _DEPTH, _STENCIL = 1, 2, 4  # aspects


def _child(value, *names):
    for name in names:
        value = value.FindChild(name) if value is not None else None
    return value


def _children(value):
    return [value.GetChild(k) for k in range(value.NumChildren())] if value is not None else []


def _depth_stencil(value, clears_depth, clears_stencil):
    """(depth, stencil) of a clear value, those that are cleared."""
    depth, stencil = _child(value, "depth"), _child(value, "stencil")
    return (depth.AsFloat() if clears_depth and depth is not None else 1.0 if clears_depth else None,
            stencil.AsInt() if clears_stencil and stencil is not None else 0 if clears_stencil else None)


def of_render_pass(chunk, name):
    """`chunk`: the command that begins a render pass; `name`: RenderDoc's, which says what it clears."""
    color, clears_depth, clears_stencil = clears_of(name)
    if not (clears_depth or clears_stencil):
        return Clears(color)
    dynamic = _child(chunk, "pRenderingInfo")
    if dynamic is None:  # one value for each attachment; depth comes last
        values = _children(chunk.FindChildRecursively("pClearValues"))
        return Clears(color, *_depth_stencil(_child(values[-1], "depthStencil") if values else None, clears_depth,
                                             clears_stencil))
    at = lambda attachment: _child(dynamic, attachment, "clearValue", "depthStencil")
    depth, _ = _depth_stencil(at("pDepthAttachment"), clears_depth, False)
    _, stencil = _depth_stencil(at("pStencilAttachment"), False, clears_stencil)
    return Clears(color, depth, stencil)


def of_attachments(chunk, size):
    """vkCmdClearAttachments within a render pass to targets of `size`."""
    corners = [[_child(rectangle, "rect", part, side).AsInt() for part, side in (
        ("offset", "x"), ("offset", "y"), ("extent", "width"), ("extent", "height"))]
        for rectangle in _children(_child(chunk, "pRects"))]
    if not any(x <= 0 and y <= 0 and x + width >= size[0] and y + height >= size[1] for x, y, width, height in corners):
        return Clears(parts=bool(corners))
    found = Clears()
    for attachment in _children(_child(chunk, "pAttachments")):
        aspects = _child(attachment, "aspectMask").AsInt()
        value = _child(attachment, "clearValue", "depthStencil")
        found = found.then(Clears(bool(aspects & _COLOR), *_depth_stencil(value, aspects & _DEPTH, aspects & _STENCIL)))
    return found


def of_depth_image(chunk):
    """vkCmdClearDepthStencilImage."""
    aspects = 0
    for each in _children(_child(chunk, "pRanges")):
        aspects |= _child(each, "aspectMask").AsInt()
    return Clears(False, *_depth_stencil(_child(chunk, "pDepthStencil"), aspects & _DEPTH, aspects & _STENCIL))
