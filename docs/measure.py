"""What the scripts of this folder share: making traces, and running the program on them."""
import json
import subprocess

PROCEDURAL = ["hairball", "classroom", "boat", "pickets", "terrain", "sphere", "fence", "soup", "foliage"]


def make(program, what, trace, *options):
    """A trace of a procedural scene or of a model; returns its path."""
    subprocess.run([program, "make", what, *options, "-o", trace], check=True, stdout=subprocess.DEVNULL)
    return trace


def results(program, command, trace, specs, folder, *options):
    """What `run` or `compare` reports, by technique; the pictures stay in the folder."""
    subprocess.run([program, command, trace, "-t", *specs, *options, "-o", folder], check=True,
                   stdout=subprocess.DEVNULL)
    with open(f"{folder}/report.json", encoding="utf-8") as file:
        return {result["technique"]: result for result in json.load(file)["results"]}


def stages(result, frame=0):
    """A frame's counters by stage."""
    return {stage["stage"]: stage for stage in result["frames"][frame]["stages"]}


def difference(program, a, b):
    """Of picture a from picture b: rmse, bias, and so on."""
    answer = subprocess.run([program, "diff", a, b, "--json"], check=True, stdout=subprocess.PIPE)
    return json.loads(answer.stdout)


def print_row(*cells):
    print("| " + " | ".join(map(str, cells)) + " |")


def print_head(*cells):
    print_row(*cells)
    print("|---" * len(cells) + "|")
