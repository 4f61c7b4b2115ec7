"""One worker of the extraction: `python3 extract.py JOB`. Reads the draws that are its share out of a capture.

JOB is a JSON file: capture, folder (for results), share and shares (draws number share, share + shares, ...), pictures
(whether this worker takes the pictures instead), target (a colour target's number or null). Results are pickles, and
each texture is a .npy file that whichever worker needs it first writes."""
import json
import os
import pickle
import sys
import traceback

import numpy as np

import passes
import post_vertex
from api_state import can_discard, read_state, read_textures
from replay import Replay, ReplayError


def write_pickle(path, value):
    with open(path + ".part", "wb") as file:
        pickle.dump(value, file, pickle.HIGHEST_PROTOCOL)
    os.rename(path + ".part", path)


def kept_pass(replay, target):
    """(all passes, the one to keep)."""
    actions = replay.actions()
    found = passes.group(actions)
    if not found:
        raise ReplayError("the frame draws nothing")
    presented = next((action.presented for action in reversed(actions) if action.presented), 0)
    if target is None:
        return found, passes.choose(found, presented)
    chosen = [one for one in found if one.color == target]
    if not chosen:
        raise ReplayError(f"no pass draws to target {target} (see --list)")
    return found, max(chosen, key=lambda one: one.vertices)


def take_texture(replay, texture, folder):
    """Leaves a texture's texels in the folder, unless another worker has."""
    path = os.path.join(folder, f"texture_{texture}.npy")
    try:
        os.close(os.open(path + ".taken", os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        return
    texels = replay.texture_texels(texture)
    if texels is not None:
        np.save(path, np.rint(texels.clip(0, 1) * 255).astype(np.uint8))


def read_draw(replay, action, targets, depth_format, folder):
    """What a draw is, as a dictionary; `left_out` says why it has no geometry."""
    import renderdoc as rd
    controller = replay.controller
    controller.SetFrameEvent(action.event, False)
    command = replay.command(action.event)
    api = read_state(controller, replay.is_vulkan, depth_format)
    pipe = controller.GetPipelineState()
    draw = {"event": action.event, "api": api, "vertices": action.vertices, "left_out": None, "primitives": 0}
    if api["discards_all"]:
        return {**draw, "left_out": "rasterization is off"}
    if api["cull"] == "FrontAndBack":
        return {**draw, "left_out": "both faces are culled"}
    if api["fill"] != "Solid":
        return {**draw, "left_out": "triangles drawn as lines or points", "primitives": action.vertices // 3}
    try:
        clip, attributes, triangles = post_vertex.read_geometry(replay, command, api["z_from_0"])
    except post_vertex.LeftOut as reason:
        return {**draw, "left_out": reason.reason, "primitives": reason.primitives}
    draw.update(clip=clip, attributes=attributes, triangles=triangles,
                discards=can_discard(pipe.GetShaderReflection(rd.ShaderStage.Pixel)),
                shader=int(pipe.GetShader(rd.ShaderStage.Pixel)), textures=[])
    for texture in read_textures(controller, replay.is_vulkan):
        # What this frame draws itself, such as a shadow map, is not a texture that a file can hold.
        if texture["id"] in replay.textures and texture["id"] not in targets:
            texture["mips"] = texture["mips"] and replay.textures[texture["id"]].mips > 1
            take_texture(replay, texture["id"], folder)
            draw["textures"].append(texture)
    return draw


def take_pictures(replay, found, kept):
    """The target before its first draw and after its last one, and what all passes are."""
    first, last = kept.draws[0].event, kept.draws[-1].event
    replay.controller.SetFrameEvent(first - 1, True)
    color, depth = replay.color_picture(kept.color) if kept.color else None, replay.depth_picture(kept.depth)
    replay.controller.SetFrameEvent(last, True)
    size = replay.size_of(kept.color or kept.depth)
    return {
        "api": replay.api, "driver": replay.driver, "size": size,
        "samples": replay.samples_of(kept.color or kept.depth),
        "color_format": replay.format_name(kept.color), "depth_format": replay.format_name(kept.depth),
        "color_before": color, "depth_before": depth,
        "color": replay.color_picture(kept.color) if kept.color else None, "depth": replay.depth_picture(kept.depth),
        "kept": kept.name, "kept_color": kept.color, "cleared_before": sorted(kept.cleared_before),
        "events": [draw.event for draw in kept.draws],
        "passes": [{"name": one.name, "color": one.color, "size": replay.size_of(one.color or one.depth),
                    "draws": len(one.draws), "triangles": one.vertices // 3, "kept": one is kept,
                    "reason": "" if one is kept else passes.reason_left_out(one, kept)}
                   for one in found if one.color or one.depth]}


def main(job_path):
    """The exit code."""
    with open(job_path) as file:
        job = json.load(file)
    result = os.path.splitext(job_path)[0]
    try:
        replay = Replay(job["capture"], vertices_only=not job["pictures"])
        found, kept = kept_pass(replay, job["target"])
        if job["pictures"]:
            value = take_pictures(replay, found, kept)
        else:
            targets = {one.color for one in found} | {one.depth for one in found}
            value = []
            with open(result + ".count", "wb", buffering=0) as count:
                for action in kept.draws[job["share"]:: job["shares"]]:
                    value.append(read_draw(replay, action, targets, replay.format_name(kept.depth), job["folder"]))
                    count.write(b".")
        write_pickle(result + ".pickle", value)
        replay.close()
    except ReplayError as error:
        write_pickle(result + ".pickle", str(error))
    except Exception:  # the supervisor prints it as one line
        write_pickle(result + ".pickle", traceback.format_exc(limit=-1).strip().splitlines()[-1])
        traceback.print_exc()
        return 1
    return 0


if __name__ == "__main__":
    code = main(sys.argv[1])
    sys.stderr.flush()
    os._exit(code)  # where a capture could not be opened, RenderDoc's threads now and then never end
