"""One worker of the extraction: `python3 extract.py JOB`. Reads the draws that are its share out of a capture.

JOB is a JSON file: capture, folder (for results), share and shares (draws number share, share + shares, ...), pictures
("before" or "after" the draws, which this worker takes instead, or null), target (a colour target's number or null).
Results are pickles, also those of images, each of which whichever worker needs it first writes."""
import json
import os
import pickle
import sys
import traceback

import passes
import post_vertex
from api_state import read_state
from programs import Programs
from replay import FILTERING, Replay, ReplayError


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
        there = sorted({one.color for one in found if one.color})
        raise ReplayError(f"no pass draws to target {target}; expected one of {', '.join(map(str, there)) or 'none'} "
                          "(see --list)")
    return found, max(chosen, key=lambda one: one.vertices)


def image_key(replay, image, event):
    """The name of a bound image's texels as they are at an event, and of the file that has them."""
    version = replay.version(image["texture"], event)
    return f"image_{image['texture']}_{version}_{image['format'].name}"


def take_image(replay, image, key, folder):
    """Leaves an image's format and texels in the folder, unless another worker has."""
    path = os.path.join(folder, key + ".pickle")
    try:
        os.close(os.open(path + ".taken", os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        return
    found = replay.image(image["texture"], image["format"])
    texture = replay.textures[image["texture"]]
    write_pickle(path, found and {"format": found[0], "texels": found[1], "width": texture.width,
                                  "height": texture.height, "depth": texture.depth, "layers": texture.arraysize,
                                  "levels": texture.mips})


def read_draw(replay, programs, action, kept, folder):
    """What a draw is, as a dictionary; `left_out` says why it has no geometry."""
    controller = replay.controller
    controller.SetFrameEvent(action.event, False)
    color_format = replay.seen_format(kept.color)
    api = read_state(controller, replay.format_name(kept.depth), color_format.name if color_format else "")
    draw = {"event": action.event, "api": api, "vertices": action.vertices, "left_out": None, "primitives": 0}
    if api["discards_all"]:
        return {**draw, "left_out": "rasterization is off"}
    program = programs.read()
    try:
        clip, varyings, triangles = post_vertex.read_geometry(
            replay, replay.command(action.event), api, program["inputs"] if program else [],
            replay.samples_of(kept.color or kept.depth))
    except post_vertex.LeftOut as reason:
        return {**draw, "left_out": reason.reason, "primitives": reason.primitives}
    for image in program["images"] if program else []:
        if "texture" in image:
            key = image_key(replay, image, action.event)
            take_image(replay, image, key, folder)
            del image["texture"], image["format"]
            image["image"] = key
    return {**draw, "clip": clip, "varyings": varyings, "triangles": triangles, "program": program}


def take_pictures_before(replay, kept):
    """What the targets have before their first draw."""
    replay.controller.SetFrameEvent(kept.draws[0].event - 1, True)
    color = replay.color_picture(kept.color, replay.seen_format(kept.color)) if kept.color else None
    depth, stencil = replay.depth_and_stencil(kept.depth)
    return {"color_before": color, "depth_before": depth, "stencil_before": stencil}


def take_pictures(replay, found, kept):
    """What the targets have after their last draw, and what all passes are."""
    # Some draws may see the target in another format, such as a menu that is not encoded for sRGB as the scene is.
    most, last = max(kept.draws, key=lambda draw: draw.vertices).event, kept.draws[-1].event
    replay.controller.SetFrameEvent(most, False)
    color_format = replay.seen_format(kept.color)
    replay.controller.SetFrameEvent(last, True)
    size = replay.size_of(kept.color or kept.depth)
    drawn = [action.event for action in replay.actions() if action.is_draw]
    return {
        "api": replay.api, "driver": replay.driver, "filtering": FILTERING, "size": size,
        "samples": replay.samples_of(kept.color or kept.depth),
        "color_format": color_format.name if color_format else "", "depth_format": replay.format_name(kept.depth),
        "is_window": replay.is_of_a_window(kept.color),
        "color": replay.color_picture(kept.color, color_format) if kept.color else None,
        "depth": replay.depth_and_stencil(kept.depth)[0],
        "kept": kept.name, "kept_color": kept.color, "cleared_before": kept.cleared_before,
        "cleared_first": kept.cleared_first,
        "events": [draw.event for draw in kept.draws], "later_draws": sum(event > last for event in drawn),
        "passes": [{"name": one.name, "color": one.color, "size": replay.size_of(one.color or one.depth),
                    "draws": len(one.draws), "vertices": one.vertices, "triangles": one.vertices // 3,
                    "kept": one is kept, "reason": "" if one is kept else passes.reason_left_out(one, kept)}
                   for one in found if one.color or one.depth]}


def main(job_path):
    """The exit code."""
    with open(job_path) as file:
        job = json.load(file)
    result = os.path.splitext(job_path)[0]
    try:
        replay = Replay(job["capture"], is_one_of_many=not job["pictures"])
        found, kept = kept_pass(replay, job["target"])
        # One worker does not take both: where depth with stencil has samples, RenderDoc crashes when it replays more
        # after it was read.
        if job["pictures"] == "before":
            value = take_pictures_before(replay, kept)
        elif job["pictures"] == "after":
            value = take_pictures(replay, found, kept)
        else:
            programs, value = Programs(replay), []
            with open(result + ".count", "wb", buffering=0) as count:
                for action in kept.draws[job["share"]:: job["shares"]]:
                    value.append(read_draw(replay, programs, action, kept, job["folder"]))
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
