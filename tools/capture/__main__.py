"""beampipe capture: makes a trace from a frame of a real program."""
import argparse
import datetime
import os
import shutil
import signal
import sys
import tempfile
import time

import packages
from failure import Failure, WrongUsage
from processes import Processes
from progress import Progress

DESCRIPTION = "Make a trace from frames of a real program that draws with OpenGL, OpenGL ES or Vulkan."
EXAMPLES = """What is kept: all triangles of the main pass as they leave the vertex, tessellation or geometry shader,
with the state of their draws (depth, blending, stencil, viewport, culling), their fragment shaders with all that these
read, and the program's own picture and depth buffer to compare with. OpenGL becomes Vulkan by Mesa's zink.
docs/manual.md says how it works and what a trace leaves out.

Examples:
  beampipe capture -o gears.json -- glxgears
  beampipe capture --frame 200 -o cube.json -- vkcube
  beampipe capture --after 20 --frames 8 -o game.json -- neverball    (8 frames in a row)
  beampipe capture --list -- glmark2 -b shadow                        (the passes of a frame)
  beampipe capture -o frame.json frame.rdc                            (a capture made with RenderDoc)
  beampipe compare gears.json -t beam msaa:8 -o out

Exit codes: 0 success, 1 failure, 2 wrong usage, 3 missing packages, 130 interrupted."""
DEBUG = "BEAMPIPE_CAPTURE_DEBUG"  # an environment variable
FILE_KINDS = (".rdc", ".trace", ".gfxr")


class _Parser(argparse.ArgumentParser):
    def error(self, message):
        raise WrongUsage(f"{message} (see beampipe capture --help)")


def _positive(kind, most):
    def parse(text):
        value = kind(text)
        if not 0 < value <= most:
            raise argparse.ArgumentTypeError(f"{text} is not above 0 and at most {most}")
        return value
    return parse


def parse(words):
    parser = _Parser(prog="beampipe capture", description=DESCRIPTION, epilog=EXAMPLES, allow_abbrev=False,
                     usage="beampipe capture -o FRAME.json [OPTIONS] -- PROGRAM ARGS\n"
                           "       beampipe capture -o FRAME.json [OPTIONS] FILE.rdc|FILE.trace|FILE.gfxr",
                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", metavar="FRAME.json", help="the trace to write")
    when = parser.add_mutually_exclusive_group()
    when.add_argument("--after", type=_positive(float, 86400), default=5, metavar="S",
                      help="capture the frame that is shown S seconds after the program's start (default: 5)")
    when.add_argument("--frame", type=_positive(int, 10**9), metavar="N", help="capture frame N, counted from 1")
    parser.add_argument("--frames", type=_positive(int, 1000), default=1, metavar="K",
                        help="capture K frames in a row into one trace (default: 1)")
    parser.add_argument("--list", action="store_true", help="list the passes of the frame and write nothing")
    parser.add_argument("--target", type=_positive(int, 2**64), metavar="ID",
                        help="keep the pass that draws to colour target ID (see --list)")
    parser.add_argument("--timeout", type=_positive(float, 86400), default=300, metavar="S",
                        help="give up after S seconds (default: 300)")
    parser.add_argument("--jobs", type=_positive(int, 256), default=os.cpu_count() or 1, metavar="N",
                        help="processes that read the capture (default: the number of processors)")
    parser.add_argument("program", nargs="*", metavar="PROGRAM ARGS", help="the program, after --, or a file")
    cut = words.index("--") if "--" in words else len(words)
    arguments = parser.parse_args(words[:cut])
    arguments.program += words[cut + 1:]
    arguments.is_file = len(arguments.program) == 1 and arguments.program[0].endswith(FILE_KINDS)
    if not arguments.program:
        raise WrongUsage("capture needs a program after --, or a file (see beampipe capture --help)")
    if not arguments.output and not arguments.list:
        raise WrongUsage("capture needs -o FRAME.json")
    if cut == len(words) and not arguments.is_file:
        raise WrongUsage("the program comes after --, and files end in .rdc, .trace or .gfxr "
                         "(see beampipe capture --help)")
    has_recording = not (arguments.is_file and arguments.program[0].endswith(".rdc"))
    if has_recording and arguments.frame is None and arguments.timeout <= arguments.after:
        raise WrongUsage(f"--timeout {arguments.timeout:g} is over before the frame at --after {arguments.after:g}")
    if arguments.output and not arguments.output.endswith(".json"):
        raise WrongUsage(f"-o {arguments.output}: expected a name that ends in .json")
    return arguments


def launch_of(arguments):
    """The words to start for what the user named; none for a capture that is there already."""
    named = arguments.program[0]
    if not arguments.is_file:
        if shutil.which(named) is None:
            raise Failure(f"{named}: there is no such program")
        return arguments.program
    if not os.path.isfile(named):
        raise Failure(f"{named}: there is no such file")
    if named.endswith(".trace"):  # the last frame of the recording, again and again
        return ["glretrace", "--loop=1000000", named]
    if named.endswith(".gfxr"):
        return ["gfxrecon-replay", "--remove-unsupported", named]
    return []


def print_passes(pictures):
    rows = [("target", "size", "draws", "vertices", "kept", "why not")]
    for one in pictures["passes"]:
        rows.append((str(one["color"] or "-"), f"{one['size'][0]} x {one['size'][1]}", str(one["draws"]),
                     str(one["vertices"]), "yes" if one["kept"] else "no", one["reason"]))
    widths = [max(len(row[k]) for row in rows) for k in range(6)]
    for row in rows:
        print("  ".join(text.ljust(width) for text, width in zip(row, widths)).rstrip())


def source_of(arguments, recording, pictures):
    import renderdoc
    source = {"program": os.path.basename(arguments.program[0]), "api": pictures["api"], "driver": pictures["driver"],
              "date": datetime.date.today().isoformat(), "tool": f"RenderDoc {renderdoc.GetVersionString()}",
              "shading": "the program's fragment shaders; pictures are of a replay with GALLIVM_PERF="
                         + pictures["filtering"]}
    if recording and recording.frame is not None:
        source["frame"] = recording.frame
    return source


def counted(number, noun):
    return f"{number} {noun}{'' if number == 1 else 'es' if noun.endswith('sh') else 's'}"


def summary(path, trace, size):
    """Lines that say what is in a trace; `size`: bytes of its files."""
    import frame
    frames, meshes, first = trace["frames"], trace["meshes"], trace["source"].get("frame")
    if first is None:
        numbers = counted(len(frames), "frame")
    else:
        numbers = f"frame {first}" if len(frames) == 1 else f"frames {first} to {first + len(frames) - 1}"
    draws = [draw for each in frames for draw in each["draws"]]
    triangles = sum(meshes[draw["mesh"]]["indices"]["count"] // 3 for draw in draws)
    yield (f"{path}: {numbers}, {frames[0]['width']} x {frames[0]['height']} pixels, {counted(len(draws), 'draw')}, "
           f"{counted(triangles, 'triangle')}, {counted(len(meshes), 'mesh')}, "
           f"{counted(len(trace['programs']), 'fragment shader')}, "
           f"{counted(len(trace['program_images']), 'image')}, {size / 1e6:.1f} MB")
    left_out = {}
    for one in (one for each in frames for one in each["left_out"]):
        draws, primitives = left_out.get(one["reason"], (0, 0))
        left_out[one["reason"]] = (draws + one["draws"], primitives + one["primitives"])
    for reason, (draws, primitives) in sorted(left_out.items()):
        what = counted(draws, frame.COUNTED.get(reason, "draw"))
        yield (f"left out: {what}: {reason.removeprefix('a clear ')}" if reason in frame.COUNTED else
               f"left out: {what}, {counted(primitives, 'primitive')}: {reason}")


def make_trace(arguments, recording, extracted, folder, progress):
    """Writes the trace; prints what is in it."""
    import frame as frames_module
    import meshes
    import trace_file
    collection = meshes.Collection()
    frames, draws = [], []
    for number, (pictures, found) in enumerate(extracted):
        progress.show(f"frame {number + 1} of {len(extracted)}")
        frame = frames_module.Frame(pictures, found)
        if not frame.draws:
            reasons = ", ".join(f"{counted(count, 'draw')}: {reason}" for reason, (count, _) in frame.left_out.items())
            raise Failure(f"the pass has no triangles ({reasons or 'all are empty'})")
        draws.append(collection.add_frame(frame, os.path.join(folder, str(number))))
        frames.append(frame)
    trace, size = trace_file.write_trace(arguments.output, frames, draws, collection,
                                         source_of(arguments, recording, extracted[0][0]))
    progress.clear()
    print("\n".join(summary(arguments.output, trace, size)))
    for image in sorted(collection.unread):
        print(f"left out: {image}: no format that a trace has")
    if frames[0].is_bottom_up:
        print(f"target {extracted[0][0]['kept_color'] or '-'} is a framebuffer object of OpenGL: its rows are stored "
              "bottom up, and the picture stands on its head")
    if later := frames[0].later_draws:
        print(f"after this pass: {counted(later, 'draw')}, for instance to filter the picture")


def run(arguments):
    progress = Progress()
    start = time.monotonic()
    deadline = start + arguments.timeout
    words = launch_of(arguments)
    if arguments.output:
        folder = os.path.dirname(arguments.output) or "."
        os.makedirs(folder, exist_ok=True)
        if not os.access(folder, os.W_OK):
            raise Failure(f"{folder}: cannot be written to")
    packages.require(True, words[0] if words else "")
    from display import display_for
    from workers import extract
    with tempfile.TemporaryDirectory(prefix="beampipe-capture-") as folder, Processes() as processes:
        # Of all that is started, and of RenderDoc in this process: it writes logs.
        os.environ.update(TMPDIR=folder, RENDERDOC_TEMP=folder)
        progress.show("starting")
        display = display_for(processes)
        recording, captures = None, arguments.program
        if words:
            from record import Wishes, record
            wishes = Wishes(arguments.after, arguments.frame, arguments.frames, words[0] == "glretrace")
            recording = record(processes, words, display, folder, wishes, progress, arguments.timeout)
            captures = recording.paths
        recorded = time.monotonic()
        extracted = [extract(processes, capture, os.path.join(folder, str(number)), display, arguments.target,
                             arguments.jobs, progress, deadline, pictures_only=arguments.list)
                     for number, capture in enumerate(captures)]
        progress.clear()
        if arguments.list:
            print_passes(extracted[0][0])
            return
        make_trace(arguments, recording, extracted, folder, progress)
        print(f"seconds: capture {recorded - start:.1f}, extraction {time.monotonic() - recorded:.1f}")


def main(words):
    for number in (signal.SIGTERM, signal.SIGHUP):  # end what was started, as Ctrl-C does
        if signal.getsignal(number) != signal.SIG_IGN:  # nohup
            signal.signal(number, signal.default_int_handler)
    try:
        run(parse(words))
        return 0
    except Failure as error:
        print(f"beampipe: error: {' '.join(str(error).split())}", file=sys.stderr)
        return error.exit_code
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        print(f"beampipe: error: {place}{error.strerror or error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("beampipe: interrupted", file=sys.stderr)
        return 130
    except Exception as error:
        if os.environ.get(DEBUG):
            raise
        print(f"beampipe: error: internal error: {' '.join(f'{type(error).__name__}: {error}'.split())} "
              f"(with {DEBUG}=1 in the environment, it says where)", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
