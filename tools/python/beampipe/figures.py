"""Figures for papers, by matplotlib: pictures in columns, crops, maps of errors on one scale, and numbers.

  scene = figures.scene_of(found)                       # of a Comparison, or of a Report
  figures.save(figures.draw([scene]), "figure.svg")     # or .pdf, .png
  figures.booktabs([scene])                             # its table for LaTeX
  figures.film([[scene], [next_scene]], "film.mp4")     # a figure for each frame
"""
from __future__ import annotations

import io
import itertools
import math
import os
import pathlib
import re
import subprocess
import tempfile
from dataclasses import dataclass
from typing import TYPE_CHECKING, Iterable, Optional, Sequence, Union

import numpy
from matplotlib import colormaps, rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import Normalize
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.patches import Rectangle
from matplotlib.patheffects import withStroke
from matplotlib.textpath import TextPath
from numpy.typing import NDArray

from .results import Error, Rate, Report, each_spec

if TYPE_CHECKING:
    from .comparing import Comparison

REFERENCE = "reference"
ENDINGS = (".svg", ".pdf", ".png")
WIDTH = 7.0  # inches: two columns of most proceedings
# The names of techniques are set in Matplotlib's own fonts, which are the same everywhere.
FONT = "DejaVu Sans"
STYLE = {"font.family": FONT, "axes.linewidth": 0.4, "pdf.fonttype": 42, "svg.hashsalt": "beampipe",
         "xtick.major.width": 0.4, "xtick.major.size": 2}
LARGEST, SMALLEST = 7.0, 5.0  # points: text is as large as fits the columns, and legible
CROP_COLORS = ("#e69f00", "#56b4e9", "#009e73", "#cc79a7")  # Okabe and Ito's, which most people can tell apart
MAP = "magma"
MAP_SHARE = 99.5  # per cent of the errors that the scale of maps shows; the rest has its last colour
DOTS_PER_INCH = 300
FRAMES_PER_SECOND = 30
Crop = tuple[int, int, int, int]  # x, y of the upper left pixel, width, height


@dataclass(frozen=True, eq=False)
class Column:
    """A technique: a picture (height x width x 3, linear), and, but for the reference, its errors for each pixel (root
    mean square over R, G and B), its RMSE and its equivalent MSAA rate over all frames."""
    name: str
    picture: NDArray
    errors: Optional[NDArray] = None
    rmse: Optional[float] = None
    rate: Optional[Rate] = None


@dataclass(frozen=True, eq=False)
class Scene:
    """A trace, with the reference as its last column. metric: what its rates are equivalent by."""
    title: str
    columns: list[Column]
    metric: str = "rmse"

    @property
    def size(self) -> tuple[int, int]:
        height, width = self.columns[0].picture.shape[:2]
        return width, height


def _column(name: str, picture: NDArray, truth: NDArray, rmse: float, rate: Optional[Rate]) -> Column:
    difference = picture.astype(float) - truth
    return Column(name, picture, numpy.sqrt(numpy.mean(difference ** 2, axis=2)), rmse, rate)


def scene_of(found: Union[Report, Comparison], *, techniques: Optional[Sequence[str]] = None, frame: int = 0,
             title: str = "") -> Scene:
    """A frame (counted from 0 within the results) of these techniques (None: all but other references), in this order."""
    if isinstance(found, Report):
        if REFERENCE not in found.techniques:
            raise Error(f"{found.folder}: expected results of `beampipe compare`, found no reference")
        names = [name for name in found.techniques if name != REFERENCE]
        count = len(found.frames(REFERENCE))
        title = title or pathlib.PurePath(found.json["trace"]).stem
    else:
        names, count = [each.name for each in found], len(found.reference)
    if not 0 <= frame < count:
        raise Error(f"{title or 'figure'}: expected a frame from 0 to {count - 1}, found {frame}")
    wanted = list(each_spec(techniques or ()))
    for name in wanted:
        if name not in names:
            raise Error(f"{title or 'figure'}: expected one of the techniques {', '.join(names)}, found {name}")
    wanted = wanted or [name for name in names if name.split(":")[0] != REFERENCE]
    if isinstance(found, Report):
        truth = found.picture(REFERENCE, frame)[..., :3]
        columns = [_column(name, found.picture(name, frame)[..., :3], truth, found[name]["error"]["rmse"],
                           found.rate(name)) for name in wanted]
    else:
        truth = found.reference[frame].picture
        columns = [_column(name, found[name].renderings[frame].picture, truth, found[name].errors["rmse"],
                           found[name].rate) for name in wanted]
    metric = found.json.get("metric", "rmse") if isinstance(found, Report) else found.metric
    return Scene(title, columns + [Column(REFERENCE, truth)], metric)


def where_techniques_differ(scene: Scene, count: int = 2) -> list[Crop]:
    """The `count` squares, a sixth of the picture high, over which the errors of techniques differ most from each other
    (with one technique: are largest). They are at least a square apart."""
    errors = [column.errors for column in scene.columns if column.errors is not None]
    spread = numpy.max(errors, axis=0) - numpy.min(errors, axis=0) if len(errors) > 1 else errors[0]
    height, width = spread.shape
    side = max(1, min(width, height, max(8, height // 6)))
    sums = numpy.pad(spread.astype(float).cumsum(0).cumsum(1), ((1, 0), (1, 0)))
    boxes = sums[side:, side:] - sums[:-side, side:] - sums[side:, :-side] + sums[:-side, :-side]
    crops: list[Crop] = []
    for _ in range(count):
        if not numpy.isfinite(boxes).any():
            break
        y, x = numpy.unravel_index(numpy.nanargmax(numpy.where(numpy.isfinite(boxes), boxes, numpy.nan)), boxes.shape)
        crops.append((int(x), int(y), side, side))
        boxes[max(0, y - 2 * side + 1):y + 2 * side, max(0, x - 2 * side + 1):x + 2 * side] = -numpy.inf
    return crops


def check_crops(crops: Sequence[Crop], scene: Scene) -> None:
    width, height = scene.size
    for x, y, w, h in crops:
        if not (0 <= x and 0 <= y and w >= 1 and h >= 1 and x + w <= width and y + h <= height):
            raise Error(f"crop {x},{y},{w},{h}: expected a part of the {width} x {height} pixels of {scene.title}")


def _means(values: NDArray, most: int) -> NDArray:
    """Of at most so many boxes of one size along the first axis."""
    count = len(values)
    if count <= most:
        return values
    before = numpy.clip(numpy.linspace(0, count, most + 1)[:, None] - numpy.arange(count), 0, 1)  # a box's upper edge
    return numpy.tensordot(numpy.diff(before, axis=0), values, 1) * (most / count)


def _reduced(values: NDArray, width: int, height: int) -> NDArray:
    """To at most width x height by means, so that what is thinner than a dot stays."""
    return _means(_means(values, height).swapaxes(0, 1), width).swapaxes(0, 1)


def _on_screen(linear: NDArray) -> NDArray:
    """Bytes in sRGB."""
    encoded = numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return numpy.round(255 * encoded).astype(numpy.uint8)


def _cut(array: NDArray, crop: Crop) -> NDArray:
    x, y, width, height = crop
    return array[y:y + height, x:x + width]


def _rate_name(metric: str) -> str:
    return "EMR" if metric == "rmse" else f"EMR by {metric}"


def _numbers(column: Column, metric: str) -> list[str]:
    if column.errors is None:
        return []
    name = _rate_name(metric)
    rate = f"{name} {column.rate.text}" if column.rate and not column.rate.does_not_converge else f"no {name}"
    digits, exponent = f"{column.rmse:.2e}".split("e")
    return [rate, f"RMSE {digits}e{int(exponent)}"]


LEFT, RIGHT, GAP = 0.16, 0.01, 0.04  # inches
LINE = 1.4 / 72  # inches of each point of the text
SCALE_LABEL = ["RMS error", "of a pixel"]


def _width(text: str) -> float:
    """Inches for each point of its size."""
    return TextPath((0, 0), text, size=100, prop=FontProperties(family=FONT)).get_extents().width / 100 / 72


def _pieces(name: str) -> list[str]:
    """Where a technique's name may be broken into lines."""
    return re.findall("[^:,]*[:,]|[^:,]+", name)


def _lines(name: str, room: float) -> list[str]:
    """room: inches for each point of the text's size."""
    lines = [""]
    for piece in _pieces(name):
        if lines[-1] and _width(lines[-1] + piece) > room:
            lines.append("")
        lines[-1] += piece
    return lines


@dataclass(frozen=True)
class _Layout:
    """column: the width of a technique's pictures, inches; size: of all text, points."""
    column: float
    size: float

    @property
    def line(self) -> float:
        return LINE * self.size

    def title(self, column: Column) -> list[str]:
        return _lines(column.name, self.column / self.size)

    def title_height(self, scene: Scene) -> float:
        return self.line * max(len(self.title(each)) for each in scene.columns) + GAP / 2

    def rows(self, scene: Scene, crops: Sequence[Crop]) -> tuple[float, list[tuple[float, float]]]:
        """The height of the picture, and the size of each crop, which stand beside each other below it."""
        width, height = scene.size
        sizes = []
        if crops:
            shapes = [w / h for _, _, w, h in crops]
            tall = min((self.column - GAP * (len(crops) - 1)) / sum(shapes), self.column)
            sizes = [(shape * tall, tall) for shape in shapes]
        return self.column * height / width, sizes

    def height(self, scene: Scene, crops: Sequence[Crop]) -> float:
        picture_height, sizes = self.rows(scene, crops)
        return self.title_height(scene) + 2 * (picture_height + GAP + (sizes[0][1] + GAP if sizes else 0)) + 2 * self.line


def _layout(scenes: Sequence[Scene], width: float) -> _Layout:
    most = max(len(scene.columns) for scene in scenes)
    texts = [*SCALE_LABEL, *(text for scene in scenes for each in scene.columns
                             for text in _pieces(each.name) + _numbers(each, scene.metric))]
    widest = 1.03 * max(map(_width, texts))
    column = (width - LEFT - RIGHT + GAP) / most - GAP
    least = SMALLEST * widest
    if column < least:
        inches = math.ceil(10 * (LEFT + RIGHT - GAP + most * (least + GAP))) / 10
        fit = math.floor((width - LEFT - RIGHT + GAP) / (least + GAP)) - 1
        raise Error(f"figure: {most - 1} techniques and the reference need {inches} inches for their texts, found {width:g}" +
                    (f", where {fit} techniques fit" if fit > 0 else ""))
    return _Layout(column, min(LARGEST, column / widest))


class _Page:
    """Places axes on a figure, from the top down. Lengths are in inches. Edges of axes are those of dots, so that a
    picture of as many pixels is shown as it is."""

    def __init__(self, width: float, height: float):
        self.width, self.height, self.y = width, _in_dots(height), _in_dots(height)
        self.figure = Figure(figsize=(self.width, self.height))
        FigureCanvasAgg(self.figure)

    def axes(self, x: float, width: float, height: float):
        left, right, low, high = map(_in_dots, (x, x + width, self.y - height, self.y))
        axes = self.figure.add_axes((left / self.width, low / self.height, (right - left) / self.width,
                                     (high - low) / self.height))
        axes.set_xticks([])
        axes.set_yticks([])
        return axes

    def picture(self, x: float, width: float, height: float, values: NDArray, scale: Optional[Normalize]):
        """values: linear RGB, or with a scale errors. Pixels that are smaller than dots are reduced to these."""
        axes = self.axes(x, width, height)
        dots = [round(DOTS_PER_INCH * each) for each in
                axes.get_position().size * (self.width, self.height)]
        rows, columns = values.shape[:2]
        if scale is None:
            shown, how = _on_screen(_reduced(numpy.clip(values.astype(float), 0, 1), *dots)), {}
        else:
            shown, how = numpy.sqrt(_reduced(values ** 2, *dots)), {"cmap": MAP, "norm": scale}
        # Squares that stay squares in every viewer; or a picture that viewers may smooth.
        how["interpolation"] = "none" if shown.shape == values.shape else "nearest"
        axes.imshow(shown, aspect="auto", extent=(-0.5, columns - 0.5, rows - 0.5, -0.5), **how)
        return axes

    def text(self, x: float, text: str, **how) -> None:
        self.figure.text(x / self.width, self.y / self.height, text, **how)


def _in_dots(inches: float) -> float:
    return round(inches * DOTS_PER_INCH) / DOTS_PER_INCH


def _draw_scene(page: _Page, scene: Scene, crops: Sequence[Crop], layout: _Layout, scale: Normalize) -> None:
    column = layout.column
    picture_height, sizes = layout.rows(scene, crops)
    crop_height = sizes[0][1] + GAP if sizes else 0
    top = page.y
    pictures = top - layout.title_height(scene)
    for i, each in enumerate(scene.columns):
        page.y, x = pictures + GAP / 2, LEFT + i * (column + GAP)
        page.text(x + column / 2, "\n".join(layout.title(each)), ha="center", va="bottom")
        page.y = pictures
        for values, norm in [(each.picture, None)] + ([(each.errors, scale)] if each.errors is not None else []):
            axes = page.picture(x, column, picture_height, values, norm)
            for color, (left, upper, w, h) in zip(itertools.cycle(CROP_COLORS), crops):
                axes.add_patch(Rectangle((left - 0.5, upper - 0.5), w, h, fill=False, linewidth=0.8, edgecolor=color,
                                         path_effects=[withStroke(linewidth=1.4, foreground="black")]))
            page.y -= picture_height + GAP
            at = x
            for color, crop, (w, h) in zip(itertools.cycle(CROP_COLORS), crops, sizes):
                axes = page.picture(at, w, h, _cut(values, crop), norm)
                for spine in axes.spines.values():
                    spine.set(color=color, linewidth=1)
                at += w + GAP
            page.y -= crop_height
        page.text(x + column / 2, "\n".join(_numbers(each, scene.metric)), ha="center", va="top")
    page.y = pictures - picture_height - crop_height
    page.text(0.01, scene.title, ha="left", va="center", rotation=90)
    page.y -= GAP + crop_height
    _draw_scale(page, scale, LEFT + (len(scene.columns) - 1) * (column + GAP), layout)
    page.y = top - layout.height(scene, crops)


def _draw_scale(page: _Page, scale: Normalize, x: float, layout: _Layout) -> None:
    """In place of the reference's map of errors, which would be black."""
    axes = page.axes(x + 0.06 * layout.column, 0.88 * layout.column, 0.08)
    bar = page.figure.colorbar(ScalarMappable(scale, colormaps[MAP]), cax=axes, orientation="horizontal", extend="max",
                               ticks=[scale.vmin, scale.vmax], format="%.2g")
    bar.outline.set_linewidth(0.4)
    for label, side in zip(axes.get_xticklabels(), ("left", "right")):  # within the column
        label.set_horizontalalignment(side)
    bar.set_label("\n".join(SCALE_LABEL), labelpad=1.5)


def draw(scenes: Sequence[Scene], *, crops: Optional[Sequence[Crop]] = None, width: float = WIDTH) -> Figure:
    """A row of pictures and a row of maps of errors for each scene, with crops below; all maps have one scale.

    crops: (x, y, width, height) in pixels, of all scenes; None: where techniques differ most. width: of the figure, in
    inches.
    """
    return _draw(scenes, crops_of(scenes, crops), _scale(scenes), width)


def crops_of(scenes: Sequence[Scene], crops: Optional[Sequence[Crop]] = None) -> list[list[Crop]]:
    """Those that draw() takes for each scene."""
    if not scenes or any(len(scene.columns) < 2 for scene in scenes):
        raise Error("figure: expected at least one scene with a technique")
    cuts = [where_techniques_differ(scene) if crops is None else list(crops) for scene in scenes]
    for scene, cut in zip(scenes, cuts):
        check_crops(cut, scene)
    return cuts


def _scale(scenes: Sequence[Scene]) -> Normalize:
    errors = numpy.concatenate([each.errors.ravel() for scene in scenes for each in scene.columns
                                if each.errors is not None])
    return Normalize(0, float(numpy.percentile(errors, MAP_SHARE)) or float(errors.max()) or 1.0, clip=True)


def _draw(scenes: Sequence[Scene], cuts: Sequence[Sequence[Crop]], scale: Normalize, width: float) -> Figure:
    layout = _layout(scenes, width)
    with rc_context({**STYLE, "font.size": layout.size}):
        page = _Page(width, sum(layout.height(scene, cut) for scene, cut in zip(scenes, cuts)))
        for scene, cut in zip(scenes, cuts):
            _draw_scene(page, scene, cut, layout, scale)
    return page.figure


def write_atomically(file: Union[str, os.PathLike], data: bytes) -> None:
    """The file is complete or stays as it was."""
    path = pathlib.Path(file)
    try:
        with tempfile.NamedTemporaryFile(dir=path.parent, prefix=f".{path.name}.", delete=False) as unfinished:
            try:
                unfinished.write(data)
                unfinished.flush()
                os.fsync(unfinished.fileno())
                os.chmod(unfinished.name, 0o666 & ~_umask())
                os.replace(unfinished.name, path)
            except BaseException:
                os.unlink(unfinished.name)
                raise
    except OSError as error:
        raise Error(f"{path}: cannot be written: {error.strerror}") from None


def _umask() -> int:
    mask = os.umask(0o077)
    os.umask(mask)
    return mask


def save(figure: Figure, file: Union[str, os.PathLike]) -> None:
    """Writes .svg, .pdf or .png. The same figure gives the same bytes."""
    ending = pathlib.Path(file).suffix
    if ending not in ENDINGS:
        raise Error(f"{file}: expected a name that ends in {', '.join(ENDINGS[:-1])} or {ENDINGS[-1]}")
    dateless = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}, ".png": {}}[ending]
    with rc_context(STYLE), tempfile.SpooledTemporaryFile(max_size=1 << 26) as drawn:
        figure.savefig(drawn, format=ending[1:], dpi=DOTS_PER_INCH, metadata=dateless)
        drawn.seek(0)
        write_atomically(file, drawn.read())


def film(frames: Iterable[Sequence[Scene]], file: Union[str, os.PathLike], *, crops: Optional[Sequence[Crop]] = None,
         width: float = WIDTH) -> None:
    """Writes .mp4 with the program ffmpeg: a figure for each frame. Crops and the scale of maps are those of the first
    frame."""
    frames = iter(frames)
    first = next(frames)
    cuts, scale = crops_of(first, crops), _scale(first)
    with tempfile.TemporaryDirectory() as folder:
        written = pathlib.Path(folder) / "film.mp4"
        command = ["ffmpeg", "-loglevel", "error", "-f", "image2pipe", "-framerate", str(FRAMES_PER_SECOND), "-i", "-",
                   "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p", str(written)]
        try:
            with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as process:
                try:
                    for scenes in itertools.chain([first], frames):
                        process.stdin.write(_png(_draw(scenes, cuts, scale, width)))
                except BrokenPipeError:
                    pass  # it says why
                _, said = process.communicate()
        except FileNotFoundError:
            raise Error("ffmpeg is missing: please install the Debian package ffmpeg") from None
        if process.returncode or not written.exists():
            raise Error(f"{file}: ffmpeg failed: {' '.join(said.decode(errors='replace').split()) or process.returncode}")
        write_atomically(file, written.read_bytes())


def _png(figure: Figure) -> bytes:
    drawn = io.BytesIO()
    with rc_context(STYLE):
        figure.savefig(drawn, format="png", dpi=DOTS_PER_INCH)
    return drawn.getvalue()


def _tex(text: str) -> str:
    special = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}",
               **{each: "\\" + each for each in "&%$#_{}"}}
    return "".join(special.get(each, each) for each in text)


def _three_digits(value: float) -> str:
    exponent = int(f"{value:.2e}".split("e")[1])
    return f"{value:.{max(0, 2 - exponent)}f}"


def _tex_rate(rate: Optional[Rate]) -> str:
    if rate is None or rate.does_not_converge:
        return "--"
    text = rate.text.replace("≥ ", r"$\geq$\,").replace("< ", "$<$\\,")
    return text + (f" ({rate.within.replace('..', '--')})" if rate.within else "")


def booktabs(scenes: Sequence[Scene]) -> str:
    """A table for LaTeX's booktabs: for each scene and technique, RMSE and EMR with its range."""
    names = dict.fromkeys(_rate_name(scene.metric) for scene in scenes)
    lines = [r"\begin{tabular}{llrr}", r"\toprule",
             rf"Scene & Technique & RMSE $\times 10^3$ & {_tex(', '.join(names))} \\"]
    for scene in scenes:
        lines.append(r"\midrule")
        for i, column in enumerate(each for each in scene.columns if each.errors is not None):
            lines.append(f"{_tex(scene.title) if i == 0 else ''} & {_tex(column.name)} & {_three_digits(1000 * column.rmse)} & "
                         rf"{_tex_rate(column.rate)} \\")
    return "\n".join(lines + [r"\bottomrule", r"\end{tabular}", ""])
