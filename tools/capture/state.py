"""The state of a draw as a trace's "state" has it, from the names and numbers of the graphics API.

Windows are given in the picture's coordinates, whose row 0 is on top."""

COMPARE = {"Never": "never", "AlwaysTrue": "always", "Less": "less", "LessEqual": "less_equal", "Greater": "greater",
           "GreaterEqual": "greater_equal", "Equal": "equal", "NotEqual": "not_equal"}
FACTOR = {"Zero": "zero", "One": "one", "SrcCol": "source_color", "InvSrcCol": "one_minus_source_color",
          "DstCol": "destination_color", "InvDstCol": "one_minus_destination_color", "SrcAlpha": "source_alpha",
          "InvSrcAlpha": "one_minus_source_alpha", "DstAlpha": "destination_alpha",
          "InvDstAlpha": "one_minus_destination_alpha", "SrcAlphaSat": "source_alpha_saturate",
          "FactorRGB": "constant", "FactorAlpha": "constant"}
OPERATION = {"Add": "add", "Subtract": "subtract", "ReversedSubtract": "reverse_subtract", "Minimum": "min",
             "Maximum": "max"}
STENCIL = {"Keep": "keep", "Zero": "zero", "Replace": "replace", "IncSat": "increment", "DecSat": "decrement",
           "Invert": "invert", "IncWrap": "increment_wrap", "DecWrap": "decrement_wrap"}
CULL = {"NoCull": "none", "Back": "back", "Front": "front", "FrontAndBack": "all"}
# The smallest difference of a depth format, by its name: what a constant bias of 1 adds. Floats have no fixed one; this
# is theirs for depths from 0.5 to 1.
RESOLUTION = {"D16": 2.0**-16, "D16S8": 2.0**-16, "D24": 2.0**-24, "D24S8": 2.0**-24, "D32": 2.0**-24,
              "D32S8": 2.0**-24}


def picture_viewport(x, y, width, height, target_height, y_up):
    """A viewport in the picture's coordinates, for clip space with y up. `y_up`: OpenGL's window (row 0 at the bottom);
    otherwise Vulkan's, whose clip space has y down, so that its height changes its sign."""
    return [x, target_height - y - height, width, height] if y_up else [x, y + height, width, -height]


def picture_scissor(x, y, width, height, target_width, target_height, y_up):
    """A scissor rectangle within the target, in the picture's coordinates."""
    top = target_height - y - height if y_up else y
    x0, y0 = max(0, x), max(0, top)
    x1, y1 = min(target_width, x + width), min(target_height, top + height)
    return [x0, y0, max(0, x1 - x0), max(0, y1 - y0)]


def stencil_of(face):
    return {"function": COMPARE[face["function"]], "reference": face["reference"] & 255,
            "mask": face["compare_mask"] & 255, "write_mask": face["write_mask"] & 255,
            "fail": STENCIL[face["fail"]], "depth_fail": STENCIL[face["depth_fail"]], "pass": STENCIL[face["pass"]]}


def blend_of(blend):
    """The blending of RGB, or None where the new colour replaces the old one. ValueError if it cannot be told."""
    source, destination = blend["source"], blend["destination"]
    for factor in (source, destination):
        if factor not in FACTOR:
            raise ValueError(f"blend factor {factor}")
    if (source, destination, blend["operation"]) == ("One", "Zero", "Add"):
        return None
    return {"source": FACTOR[source], "destination": FACTOR[destination], "operation": OPERATION[blend["operation"]]}


def state_of(api, width, height):
    """A draw's state from `api`, what api_state.py has read, on a target of width x height pixels. What equals the
    trace format's default is left out."""
    state = {}
    viewport = picture_viewport(*api["viewport"], height, api["y_up"])
    if viewport != [0, 0, width, height]:
        state["viewport"] = viewport
    if api["depth_range"] != [0, 1]:
        state["depth_range"] = api["depth_range"]
    if api["scissor"]:
        scissor = picture_scissor(*api["scissor"], width, height, api["y_up"])
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
    # OpenGL looks at its window with y up, and Vulkan's formula for areas has the opposite sign for y down: both mean
    # what one sees in the picture.
    if not api["front_ccw"]:
        state["front_face"] = "clockwise"
    if api["blend"]:
        blend = blend_of(api["blend"])
        if blend:
            state["blend"] = blend
    mask = "".join(channel for bit, channel in enumerate("rgba") if api["color_mask"] >> bit & 1)
    if mask != "rgba":
        state["color_mask"] = mask
    if api["stencil"]:
        state["stencil"] = stencil_of(api["stencil"])
    return state
