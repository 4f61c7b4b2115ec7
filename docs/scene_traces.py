#!/usr/bin/env python3
"""Makes traces of the 17 scenes that docs/*.md measure: nine procedural ones, and eight OBJ models with their cameras.

usage: docs/scene_traces.py PROGRAM [MODELS] WIDTH HEIGHT -o FOLDER

PROGRAM is for instance beampipe. MODELS has the models, each as NAME.obj or NAME.obj.xz, with NAME.mtl. Writes
FOLDER/NAME.json for each scene, and for each model that is there.
"""
import pathlib
import sys

import measure

CAMERAS = {  # eye, target, fovy in degrees, near, far; up is y
    "schooner": ("26.5,16,32", "0,12.2,-3.2", 36, 1, 200),
    "cesium_man_t0.5": ("2.4,1.2,2.9", "-0.03,0.76,-0.02", 26, 0.1, 20),
    "breakfast_room": ("-3.6,2.7,8.8", "2.2,2.2,0.2", 44, 0.05, 60),
    "fur_ratboy": ("0.75,0.78,-0.55", "0.0,0.78,-0.08", 38, 0.05, 10),
    "maple": ("780,520,1250", "69,370,72", 32, 20, 6000),
    "wire_fans": ("-22,24,46", "14,14,-60", 36, 2, 1000),
    "lattice_site": ("18,9,75", "8,18,-20", 40, 1, 500),
    "truck": ("1150,380,1000", "0,10,-560", 36, 50, 8000),
}
BOTH_SIDES = ["breakfast_room"]  # triangles of one wall are wound both ways


def make_model(program, models, name, trace, *options):
    eye, target, fovy, near, far = CAMERAS[name]
    with measure.unpacked(models / f"{name}.obj") as model:
        if not pathlib.Path(model).exists():
            sys.exit(f"{models}: expected {name}.obj or {name}.obj.xz, found neither")
        measure.make(program, model, trace, "--materials", "none", f"--eye={eye}", f"--target={target}", "--fovy",
                     str(fovy), "--near", str(near), "--far", str(far), "--background", "0.25,0.45,0.8", *options)


def main(program, models, width, height, folder, other_way=False):
    """Culled as `make` does it: back faces of closed meshes, none of models; or the other way: none, all of models."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    size = ("--width", width, "--height", height)
    for name in measure.PROCEDURAL:
        measure.make(program, name, folder / f"{name}.json", *size, *(("--cull", "none") if other_way else ()))
    for name in CAMERAS if models else ():
        culled = ("--cull", "back") if other_way and name not in BOTH_SIDES else ()
        make_model(program, pathlib.Path(models), name, folder / f"{name}.json", *size, *culled)


if __name__ == "__main__":
    if len(sys.argv) not in (6, 7) or sys.argv[-2] != "-o":
        sys.exit(__doc__.strip())
    main(sys.argv[1], sys.argv[2] if len(sys.argv) == 7 else None, *sys.argv[-4:-2], sys.argv[-1])
