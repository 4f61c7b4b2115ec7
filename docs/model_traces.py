#!/usr/bin/env python3
"""Makes traces of the eight OBJ models that docs/*.md measure, each with the camera used there.

usage: docs/model_traces.py FOLDER WIDTH HEIGHT

Writes NAME.json next to each NAME.obj in FOLDER that is one of the models. The light comes over the viewer's shoulder.
"""
import json
import math
import pathlib
import sys

CAMERAS = {  # eye, target, fovy in degrees, near, far; up is y
    "schooner": ((26.5, 16, 32), (0, 12.2, -3.2), 36, 1, 200),
    "cesium_man_t0.5": ((2.4, 1.2, 2.9), (-0.03, 0.76, -0.02), 26, 0.1, 20),
    "breakfast_room": ((-3.6, 2.7, 8.8), (2.2, 2.2, 0.2), 44, 0.05, 60),
    "fur_ratboy": ((0.75, 0.78, -0.55), (0.0, 0.78, -0.08), 38, 0.05, 10),
    "maple": ((780, 520, 1250), (69, 370, 72), 32, 20, 6000),
    "wire_fans": ((-22, 24, 46), (14, 14, -60), 36, 2, 1000),
    "lattice_site": ((18, 9, 75), (8, 18, -20), 40, 1, 500),
    "truck": ((1150, 380, 1000), (0, 10, -560), 36, 50, 8000),
}
BACKGROUND = [0.25, 0.45, 0.8]


def trace(model, width, height):
    eye, target, fovy, near, far = CAMERAS[model]
    view = [t - e for t, e in zip(target, eye)]
    length = math.hypot(*view)
    light = [v / length + offset for v, offset in zip(view, (0.2, -0.5, 0.1))]
    return {"beampipe_trace": 1, "meshes": {"m": {"obj": model + ".obj"}}, "frames": [{
        "width": width, "height": height, "background": BACKGROUND,
        "camera": {"eye": eye, "target": target, "up": [0, 1, 0], "fovy_deg": fovy, "near": near, "far": far},
        "light": {"direction": light}, "draws": [{"mesh": "m", "shading": "lambert"}]}]}


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__.strip())
    folder = pathlib.Path(sys.argv[1])
    for model in CAMERAS:
        if (folder / (model + ".obj")).exists():
            text = json.dumps(trace(model, int(sys.argv[2]), int(sys.argv[3])), indent=1)
            (folder / (model + ".json")).write_text(text + "\n")
