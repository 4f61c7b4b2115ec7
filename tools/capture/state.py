"""The state of a draw as a trace's "state" has it, from the names and numbers of the graphics API.

Windows are given in the picture's coordinates, whose row 0 is on top."""

COMPARE = {"Never": "never", "AlwaysTrue": "always", "Less": "less", "LessEqual": "less_equal", "Greater": "greater",
           "GreaterEqual": "greater_equal", "Equal": "equal", "NotEqual": "not_equal"}
FACTOR = {"Zero": "zero", "One": "one", "SrcCol": "source_color", "InvSrcCol": "one_minus_source_color",
          "DstCol": "destination_color", "InvDstCol": "one_minus_destination_color", "SrcAlpha": "source_alpha",
          "InvSrcAlpha": "one_minus_source_alpha", "DstAlpha": "destination_alpha",
          "InvDstAlpha": "one_minus_destination_alpha", "SrcAlphaSat": "source_alpha_saturate",
          "FactorRGB": "constant", "InvFactorRGB": "one_minus_constant", "FactorAlpha": "constant_alpha",
          "InvFactorAlpha": "one_minus_constant_alpha"}
OPERATION = {"Add": "add", "Subtract": "subtract", "ReversedSubtract": "reverse_subtract", "Minimum": "min",
             "Maximum": "max"}
STENCIL = {"Keep": "keep", "Zero": "zero", "Replace": "replace", "IncSat": "increment", "DecSat": "decrement",
           "Invert": "invert", "IncWrap": "increment_wrap", "DecWrap": "decrement_wrap"}
CULL = {"NoCull": "none", "Back": "back", "Front": "front", "FrontAndBack": "all"}
# The smallest difference of a depth format, by its name: what a constant bias of 1 adds. Floats have no fixed one; this
# is theirs for depths from 0.5 to 1.
RESOLUTION = {"D16": 2.0**-16, "D16S8": 2.0**-16, "D24": 2.0**-24, "D24S8": 2.0**-24, "D32": 2.0**-24,
              "D32S8": 2.0**-24}


def picture_viewport(x, y, width, height):
    """Vulkan's viewport for clip space with y up: Vulkan's own has y down, so that the height changes its sign."""
    return [x, y + height, width, -height]


def picture_scissor(x, y, width, height, target_width, target_height):
    """A scissor rectangle within the target."""
    x0, y0 = max(0, x), max(0, y)
    x1, y1 = min(target_width, x + width), min(target_height, y + height)
    return [x0, y0, max(0, x1 - x0), max(0, y1 - y0)]


def stencil_of(face):
    return {"function": COMPARE[face["function"]], "reference": face["reference"] & 255,
            "mask": face["compare_mask"] & 255, "write_mask": face["write_mask"] & 255,
            "fail": STENCIL[face["fail"]], "depth_fail": STENCIL[face["depth_fail"]], "pass": STENCIL[face["pass"]]}


def _equation_of(blend):
    if not {blend["source"], blend["destination"]} <= FACTOR.keys():
        raise ValueError("blending with two source colours")
    return {"source": FACTOR[blend["source"]], "destination": FACTOR[blend["destination"]],
            "operation": OPERATION[blend["operation"]]}


def blend_of(blend):
    """How what is stored is blended, or None where the new colour replaces it. `alpha`: where it differs from the
    colours' equation. ValueError if it cannot be told."""
    color, alpha = _equation_of(blend["color"]), _equation_of(blend["alpha"])
    if color == alpha == {"source": "one", "destination": "zero", "operation": "add"}:
        return None
    if alpha != color:
        color["alpha"] = alpha
    if "constant" in repr(color):
        color["constant"] = blend["constant"]
    return color


def state_of(api, width, height, has_alpha=True):
    """A draw's state from `api`, what api_state.py has read, on a target of width x height pixels. What equals the
    trace format's default is left out. ValueError if the format has no words for it."""
    state = {}
    viewport = picture_viewport(*api["viewport"])
    if viewport != [0, 0, width, height]:
        state["viewport"] = viewport
    if api["depth_range"] != [0, 1]:
        state["depth_range"] = api["depth_range"]
    if api["scissor"]:
        scissor = picture_scissor(*api["scissor"], width, height)
        if scissor != [0, 0, width, height]:
            state["scissor"] = scissor
    if not api["depth_test"]:
        state["depth_test"] = False
    if not (api["depth_test"] and api["depth_write"]):  # without the test, the APIs do not write depth either
        state["depth_write"] = False
    function = COMPARE[api["depth_function"]]
    if api["depth_test"] and function != "less":
        state["depth_function"] = function
    if api["bias"] or api["slope_bias"]:
        state["depth_bias"] = {"constant": api["bias"] * RESOLUTION.get(api["depth_format"], 2.0**-24),
                               "slope": api["slope_bias"], "clamp": api["bias_clamp"]}
    if api["depth_clamp"]:
        state["depth_clip"] = False
    # Vulkan's formula for areas has the sign for y down: it means what one sees in the picture.
    if not api["front_ccw"]:
        state["front_face"] = "clockwise"
    if api["logic_operation"] not in (None, "Copy"):
        raise ValueError(f"logic operation {api['logic_operation']}")
    if api["blend"] and not api["logic_operation"]:
        blend = blend_of(api["blend"])
        if blend:
            state["blend"] = blend
    channels = "rgba" if has_alpha else "rgb"
    mask = "".join(channel for bit, channel in enumerate(channels) if api["color_mask"] >> bit & 1)
    if mask != "rgba":
        state["color_mask"] = mask
    if api["alpha_to_coverage"]:
        state["alpha_to_coverage"] = True
    if api["stencil"]:  # what is culled does not matter
        front, back = (stencil_of(face) for face in api["stencil"])
        state["stencil"] = back if api["cull"] == "Front" else front
        if api["cull"] == "NoCull" and back != front:
            state["stencil_back"] = back
    return state
