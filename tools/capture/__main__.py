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
    rows = [("target", "size", "draws", "triangles", "kept", "why not")]
    for one in pictures["passes"]:
        rows.append((str(one["color"] or "-"), f"{one['size'][0]} x {one['size'][1]}", str(one["draws"]),
                     str(one["triangles"]), "yes" if one["kept"] else "no", one["reason"]))
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
            reasons = ", ".join(f"{count} draws: {reason}" for reason, (count, _) in frame.left_out.items())
            raise Failure(f"the pass has no triangles ({reasons or 'all are empty'})")
        draws.append(collection.add_frame(frame, os.path.join(folder, str(number))))
        frames.append(frame)
    size = trace_file.write_trace(arguments.output, frames, draws, collection,
                                  source_of(arguments, recording, extracted[0][0]))
    progress.clear()
    first = frames[0]
    drawn = sum(len(frame.draws) for frame in frames)
    print(f"{arguments.output}: {len(frames)} frame{'s' if len(frames) > 1 else ''}, {first.width} x {first.height} "
          f"pixels, {drawn} draws, {sum(frame.triangles for frame in frames)} triangles, "
          f"{len(collection.meshes)} meshes, {len(collection.programs.entries)} fragment shaders, "
          f"{len(collection.images.entries)} images, {size / 1e6:.1f} MB")
    for reason, (count, primitives) in sorted(first.left_out.items()):
        print(f"left out: {count} draws, {primitives} primitives: {reason}")
    for image in sorted(collection.unread):
        print(f"left out: {image}: no format that a trace has")
    if first.later_draws:
        print(f"after this pass the program draws {first.later_draws} times, for instance to filter the picture")


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
