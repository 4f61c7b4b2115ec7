"""Figures for papers, by matplotlib: pictures in columns, crops, maps of errors on one scale, and numbers.

  scene = figures.scene_of(found)                       # of a Comparison, or of a Report
  figures.save(figures.draw([scene]), "figure.svg")     # or .pdf, .png
  figures.booktabs([scene])                             # its table for LaTeX
  figures.film([[scene], [next_scene]], "film.mp4")     # a figure for each frame
"""
from __future__ import annotations

import io
import itertools
import os
import pathlib
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
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from .results import Error, Rate, Report

if TYPE_CHECKING:
    from .comparing import Comparison

REFERENCE = "reference"
ENDINGS = (".svg", ".pdf", ".png")
WIDTH = 7.0  # inches: two columns of most proceedings
# The names of techniques are set in Matplotlib's own fonts, which are the same everywhere.
STYLE = {"font.family": "DejaVu Sans", "font.size": 7, "axes.linewidth": 0.4, "axes.titlesize": 7.5, "pdf.fonttype": 42,
         "svg.hashsalt": "beampipe", "xtick.major.width": 0.4, "xtick.major.size": 2}
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
    """A frame (counted from 0 within the results) of these techniques (None: all), in this order."""
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
    for name in techniques or ():
        if name not in names:
            raise Error(f"{title or 'figure'}: expected one of the techniques {', '.join(names)}, found {name}")
    wanted = list(techniques or names)
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
    (with one technique: are largest). They do not overlap."""
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
        boxes[max(0, y - side + 1):y + side, max(0, x - side + 1):x + side] = -numpy.inf
    return crops


def check_crops(crops: Sequence[Crop], scene: Scene) -> None:
    width, height = scene.size
    for x, y, w, h in crops:
        if not (0 <= x and 0 <= y and w >= 1 and h >= 1 and x + w <= width and y + h <= height):
            raise Error(f"crop {x},{y},{w},{h}: expected a part of the {width} x {height} pixels of {scene.title}")


def _on_screen(picture: NDArray) -> NDArray:
    """Bytes in sRGB."""
    linear = numpy.clip(picture.astype(float), 0, 1)
    encoded = numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return numpy.round(255 * encoded).astype(numpy.uint8)


def _cut(array: NDArray, crop: Crop) -> NDArray:
    x, y, width, height = crop
    return array[y:y + height, x:x + width]


def _rate_name(metric: str) -> str:
    return "EMR" if metric == "rmse" else f"EMR by {metric}"


def _numbers(column: Column, metric: str) -> str:
    if column.errors is None:
        return ""
    name = _rate_name(metric)
    rate = f"{name} {column.rate}" if column.rate and not column.rate.does_not_converge else f"no {name}"
    return f"{rate}\nRMSE {1000 * column.rmse:.3g} × 10⁻³"


class _Page:
    """Places axes on a figure, from the top down. Lengths are in inches."""

    def __init__(self, width: float, height: float):
        self.width, self.height, self.y = width, height, height
        self.figure = Figure(figsize=(width, height))
        FigureCanvasAgg(self.figure)

    def axes(self, x: float, width: float, height: float):
        axes = self.figure.add_axes((x / self.width, (self.y - height) / self.height, width / self.width,
                                     height / self.height))
        axes.set_xticks([])
        axes.set_yticks([])
        return axes

    def text(self, x: float, text: str, **how) -> None:
        self.figure.text(x / self.width, self.y / self.height, text, **how)


LEFT, GAP, TITLE, NUMBERS, BAR = 0.16, 0.04, 0.19, 0.30, 0.42  # inches


def _rows(scene: Scene, crops: Sequence[Crop], column: float) -> tuple[float, list[tuple[float, float]]]:
    """The height of the picture, and the size of each crop, which stand beside each other below it."""
    width, height = scene.size
    sizes = []
    if crops:
        shapes = [w / h for _, _, w, h in crops]
        tall = min((column - GAP * (len(crops) - 1)) / sum(shapes), column)
        sizes = [(shape * tall, tall) for shape in shapes]
    return column * height / width, sizes


def _draw_scene(page: _Page, scene: Scene, crops: Sequence[Crop], column: float, scale: Normalize) -> None:
    picture_height, sizes = _rows(scene, crops, column)
    crop_height = sizes[0][1] + GAP if sizes else 0
    top = page.y
    for i, each in enumerate(scene.columns):
        page.y, x = top, LEFT + i * (column + GAP)
        page.y -= TITLE - GAP
        page.text(x + column / 2, each.name, ha="center", va="bottom", fontsize=STYLE["axes.titlesize"])
        page.y -= GAP
        layers = [(_on_screen(each.picture), {"interpolation": "none"})]
        if each.errors is not None:
            layers.append((each.errors, {"interpolation": "none", "cmap": MAP, "norm": scale}))
        for array, shown in layers:
            axes = page.axes(x, column, picture_height)
            axes.imshow(array, aspect="auto", **shown)
            for number, (left, upper, w, h) in enumerate(crops):
                axes.add_patch(Rectangle((left - 0.5, upper - 0.5), w, h, fill=False, linewidth=0.8,
                                         edgecolor=CROP_COLORS[number % len(CROP_COLORS)]))
            page.y -= picture_height + GAP
            at = x
            for number, (w, h) in enumerate(sizes):
                axes = page.axes(at, w, h)
                axes.imshow(_cut(array, crops[number]), aspect="auto", **shown)
                for spine in axes.spines.values():
                    spine.set(color=CROP_COLORS[number % len(CROP_COLORS)], linewidth=1)
                at += w + GAP
            page.y -= crop_height
        if each.errors is not None:
            page.text(x + column / 2, _numbers(each, scene.metric), ha="center", va="top", linespacing=1.3)
    page.y = top - TITLE - 2 * (picture_height + GAP + crop_height)
    _draw_scale(page, scale, LEFT + (len(scene.columns) - 1) * (column + GAP), column, picture_height + crop_height)
    page.y = top - TITLE - (picture_height + crop_height)
    page.text(0.01, scene.title, ha="left", va="center", rotation=90)
    page.y = top - _height(scene, crops, column)


def _draw_scale(page: _Page, scale: Normalize, x: float, width: float, height: float) -> None:
    """In place of the reference's map of errors, which would be black. page.y is its lower end."""
    page.y += min(height, BAR + 0.1)
    axes = page.axes(x + 0.08 * width, 0.8 * width, 0.08)
    bar = page.figure.colorbar(ScalarMappable(scale, colormaps[MAP]), cax=axes, orientation="horizontal", extend="max",
                               ticks=[scale.vmin, scale.vmax / 2, scale.vmax], format="%.2g")
    bar.outline.set_linewidth(0.4)
    bar.set_label("error of a pixel (RMS of\nlinear R, G, B)", labelpad=1.5)


def _height(scene: Scene, crops: Sequence[Crop], column: float) -> float:
    picture_height, sizes = _rows(scene, crops, column)
    return TITLE + 2 * (picture_height + GAP + (sizes[0][1] + GAP if sizes else 0)) + NUMBERS


def draw(scenes: Sequence[Scene], *, crops: Optional[Sequence[Crop]] = None, width: float = WIDTH) -> Figure:
    """A row of pictures and a row of maps of errors for each scene, with crops below; all maps have one scale.

    crops: (x, y, width, height) in pixels, of all scenes; None: where techniques differ most. width: of the figure, in
    inches.
    """
    return _draw(scenes, _cuts(scenes, crops), _scale(scenes), width)


def _cuts(scenes: Sequence[Scene], crops: Optional[Sequence[Crop]]) -> list[list[Crop]]:
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
    most = max(len(scene.columns) for scene in scenes)
    column = (width - LEFT - GAP * (most - 1) - 0.01) / most
    with rc_context(STYLE):
        page = _Page(width, sum(_height(scene, cut, column) for scene, cut in zip(scenes, cuts)))
        for scene, cut in zip(scenes, cuts):
            _draw_scene(page, scene, cut, column, scale)
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
    cuts, scale = _cuts(first, crops), _scale(first)
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


def _tex_rate(rate: Optional[Rate]) -> str:
    if rate is None or rate.does_not_converge:
        return "--"
    return str(rate).replace("≥ ", r"$\geq$\,").replace("< ", "$<$\\,")


def booktabs(scenes: Sequence[Scene]) -> str:
    """A table for LaTeX's booktabs: for each scene and technique, RMSE and EMR."""
    names = dict.fromkeys(_rate_name(scene.metric) for scene in scenes)
    lines = [r"\begin{tabular}{llrr}", r"\toprule",
             rf"Scene & Technique & RMSE $\times 10^3$ & {_tex(', '.join(names))} \\"]
    for scene in scenes:
        lines.append(r"\midrule")
        for i, column in enumerate(each for each in scene.columns if each.errors is not None):
            lines.append(f"{_tex(scene.title) if i == 0 else ''} & {_tex(column.name)} & {1000 * column.rmse:.2f} & "
                         rf"{_tex_rate(column.rate)} \\")
    return "\n".join(lines + [r"\bottomrule", r"\end{tabular}", ""])
