"""Functions that the scripts of this folder share: making traces, and running the program on them."""
import contextlib
import json
import lzma
import pathlib
import shutil
import subprocess
import sys
import tempfile

PROCEDURAL = ["hairball", "classroom", "boat", "pickets", "terrain", "sphere", "fence", "soup", "foliage"]
HELD_OUT = ["shrubs", "library", "scaffold", "cables", "crowd"]  # only measured: nothing was or may be chosen on them


def make(program, what, trace, *options):
    """Makes a trace of a procedural scene or of a model, and returns its path."""
    subprocess.run([program, "make", what, *options, "-o", trace], check=True, stdout=subprocess.DEVNULL)
    return trace


@contextlib.contextmanager
def unpacked(model):
    """The path of a model, or of its copy if there is only MODEL.xz, which is unpacked for as long."""
    packed = pathlib.Path(f"{model}.xz")
    if pathlib.Path(model).exists() or not packed.exists():
        yield str(model)
        return
    with tempfile.TemporaryDirectory() as folder:
        copy = pathlib.Path(folder) / pathlib.Path(model).name
        with lzma.open(packed) as source, open(copy, "wb") as to:
            shutil.copyfileobj(source, to)
        materials = pathlib.Path(model).with_suffix(".mtl")
        if materials.exists():
            shutil.copy(materials, folder)
        yield str(copy)


def results(program, command, trace, specs, folder, *options):
    """Returns the results of `run` or `compare` by technique; the pictures stay in the folder, in place of earlier ones.

    Exits if the program fails, which says why.
    """
    finished = subprocess.run([program, command, trace, "-t", *specs, *options, "--force", "-o", folder],
                              stdout=subprocess.DEVNULL)
    if finished.returncode:
        sys.exit(finished.returncode)
    with open(f"{folder}/report.json", encoding="utf-8") as file:
        return {result["technique"]: result for result in json.load(file)["results"]}


def stages(result, frame=0):
    """Returns a frame's counters by stage."""
    return {stage["stage"]: stage for stage in result["frames"][frame]["stages"]}


def difference(program, a, b):
    """Returns the error of picture a against picture b: rmse, bias, and so on."""
    answer = subprocess.run([program, "diff", a, b, "--json"], check=True, stdout=subprocess.PIPE)
    return json.loads(answer.stdout)


def print_row(*cells):
    print("| " + " | ".join(map(str, cells)) + " |")


def print_head(*cells):
    print_row(*cells)
    print("|---" * len(cells) + "|")
