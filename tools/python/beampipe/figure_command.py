"""beampipe figure: a figure for a paper from the folders of `beampipe compare`."""
import argparse
import logging
import pathlib
import sys

from .results import Error, Report

EXAMPLES = """The figure has a column for each technique and one for the reference: pictures with boxes, what is in the
boxes, maps of the errors on one scale for all, the equivalent MSAA rate (EMR) and the RMSE.

Examples:
  beampipe figure out -o figure.pdf
  beampipe figure out -o film.mp4
  beampipe figure fence leaves -t beam msaa:8 --crop 150,60,24,24 -o figure.svg --tex table.tex

Debian packages: python3-matplotlib python3-numpy."""

FILM = ".mp4"


class WrongUsage(Exception):
    """What the user asked for makes no sense: exit code 2."""


class _Parser(argparse.ArgumentParser):
    def error(self, message):
        raise WrongUsage(f"{message} (see beampipe figure --help)")


def _crop(text):
    words = text.split(",")
    if len(words) != 4 or not all(word.isascii() and word.isdigit() for word in words):
        raise argparse.ArgumentTypeError(f"{text}: expected X,Y,WIDTH,HEIGHT in pixels")
    return tuple(map(int, words))


def _inches(text):
    try:
        value = float(text)
    except ValueError:
        value = 0
    if not 1 <= value <= 40:
        raise argparse.ArgumentTypeError(f"{text}: expected 1 to 40 inches")
    return value


def parse(words):
    parser = _Parser(prog="beampipe figure", description="Make a figure for a paper: pictures, crops, maps of errors.",
                     epilog=EXAMPLES, allow_abbrev=False, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", metavar="DIR", help="what `beampipe compare` wrote; a row for each")
    parser.add_argument("-o", "--output", required=True, metavar="FILE",
                        help="the figure: .svg, .pdf or .png; or .mp4, a film of all frames (needs the program ffmpeg)")
    parser.add_argument("-t", "--technique", nargs="+", action="extend", metavar="SPEC",
                        help="only these techniques, in this order (default: all but other references)")
    parser.add_argument("--crop", type=_crop, action="append", metavar="X,Y,W,H",
                        help="enlarge these pixels; may be repeated (default: two squares where techniques differ most)")
    parser.add_argument("--frame", type=int, metavar="N", help="the frame of the results (default: 0)")
    parser.add_argument("--inches", type=_inches, default=7.0, metavar="N", help="the figure's width (default: 7)")
    parser.add_argument("--tex", metavar="FILE", help="also write the numbers as a LaTeX table (booktabs)")
    return parser.parse_args(words)


def work(arguments):
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # or it would say that it cannot keep a list of fonts
    try:
        from . import figures
    except ModuleNotFoundError as missing:
        raise Error(f"{missing.name} is missing: please install the Debian packages python3-matplotlib "
                    "python3-numpy") from None
    ending = pathlib.Path(arguments.output).suffix
    if ending not in (*figures.ENDINGS, FILM):
        raise WrongUsage(f"-o {arguments.output}: expected a name that ends in .svg, .pdf, .png or .mp4")
    if ending == FILM and arguments.frame is not None:
        raise WrongUsage(f"--frame {arguments.frame}: a film shows all frames")
    reports = [Report(folder) for folder in arguments.folders]

    def scenes(frame):
        return [figures.scene_of(report, techniques=arguments.technique, frame=frame) for report in reports]

    how = {"crops": arguments.crop, "width": arguments.inches}
    shown = scenes(arguments.frame or 0)
    if ending == FILM:
        counts = {len(report.frames(figures.REFERENCE)) for report in reports}
        if len(counts) > 1:
            raise Error(f"{arguments.output}: expected folders with as many frames, found {' and '.join(map(str, sorted(counts)))}")
        figures.film(map(scenes, range(counts.pop())), arguments.output, **how)
    else:
        figures.save(figures.draw(shown, **how), arguments.output)
    print(f"figure: {arguments.output}")
    for scene, crops in zip(shown, figures.crops_of(shown, arguments.crop)):
        print(f"{scene.title}: " + " ".join(f"--crop {x},{y},{w},{h}" for x, y, w, h in crops))
    if arguments.tex:
        figures.write_atomically(arguments.tex, figures.booktabs(shown).encode())
        print(f"table: {arguments.tex}")


def main():
    try:
        work(parse(sys.argv[1:]))
    except WrongUsage as error:
        sys.exit(_say(error, 2))
    except Error as error:
        sys.exit(_say(error, 1))


def _say(error, code):
    print(f"beampipe: error: {error}", file=sys.stderr)
    return code
