"""Rendering with techniques: those of beampipe, sample patterns, and functions of the user's."""
from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from inspect import signature
from typing import TYPE_CHECKING, Any, Callable, Iterable, Optional, Union

import numpy
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._native import Trace
from .results import Error, expecting

if TYPE_CHECKING:
    from .own import Merge


@dataclass(frozen=True, eq=False)
class Rendering:
    """A frame as a technique rendered it.

    picture: height x width x 3, float32, linear RGB, row 0 on top. alpha: height x width, the part of each pixel that
    geometry covers, 0..1. counters: by name, height x width, what was counted in each pixel. stages: counters by stage
    and name, as in report.json (`beampipe counters` explains them); operations are "ops.add" and so on. buffers: the
    most bytes that each held at once. on_chip_bytes_per_pixel, off_chip_bytes_per_pixel: as in report.json, all that a
    bin has on chip, and the framebuffer in memory with what triangles take beside it. times: modelled milliseconds by
    implementation of the hardware: "in_turn", "on_cores", "at_once", and the "busiest" unit; none without the model of
    memory. Functions of the user's count nothing.
    """
    technique: str
    frame: int
    picture: NDArray[numpy.float32] = field(repr=False)
    alpha: NDArray[numpy.float32] = field(repr=False)
    counters: dict[str, NDArray[numpy.float32]] = field(default_factory=dict, repr=False)
    stages: dict[str, dict[str, int]] = field(default_factory=dict)
    buffers: dict[str, int] = field(default_factory=dict)
    on_chip_bytes_per_pixel: float = 0
    off_chip_bytes_per_pixel: float = 0
    times: dict[str, dict[str, Any]] = field(default_factory=dict)

    @property
    def dram_bytes(self) -> int:
        """Bytes that move to and from the modelled DRAM, in all stages."""
        return sum(stage.get("dram_bytes", 0) for stage in self.stages.values())


class Pattern:
    """Multisampling with samples of one's own: RGB16F and 32-bit depth for each, shaded once per triangle and pixel.

    places: N x 2 positions (1 to 32), x to the right and y down from the pixel's upper left corner, 0 <= x, y < 1; they
    are rounded to 1/256 px. Or a function of (x, y) that returns them for the pixels of a tile of tile = (width,
    height), which repeats over the picture. Of such a pattern no stages are counted: each place in the tile is rendered
    by itself.
    """

    def __init__(self, places: Union[ArrayLike, Callable[[int, int], ArrayLike]], *, name: str = "pattern",
                 tile: Optional[tuple[int, int]] = None):
        if callable(places) and tile is None:
            raise Error(f"{name}: expected tile=(width, height) beside a function of x and y")
        tile = tile or (1, 1)
        self.name, self.tile = name, tile
        if min(tile) < 1:
            raise Error(f"{name}: expected a tile of at least 1 x 1 pixels, found {tile[0]} x {tile[1]}")
        self._techniques = {(x, y): _native.msaa_at(name, self._units(places(x, y) if callable(places) else places))
                            for y in range(tile[1]) for x in range(tile[0])}
        self.technique = self._techniques[0, 0]  # of the tile's first pixel

    def _units(self, places: ArrayLike) -> list:
        try:
            units = numpy.round(256 * numpy.asarray(places, float))
        except (TypeError, ValueError):
            units = numpy.empty(0)
        if units.ndim != 2 or units.shape[1] != 2 or not numpy.isfinite(units).all():
            raise Error(f"{self.name}: expected an array of N x 2 positions")
        return numpy.clip(units, -1, 256).astype(int).tolist()

    def render(self, trace: Trace, frame: int, **how: Any) -> Rendering:
        if self.tile == (1, 1):
            return _render_native(self.technique, trace, frame, **how)
        width, height = self.tile
        whole = None
        for (x, y), technique in self._techniques.items():
            part = _render_native(technique, trace, frame, **how)
            whole = whole or Rendering(self.name, frame, part.picture.copy(), part.alpha.copy(),
                                       on_chip_bytes_per_pixel=part.on_chip_bytes_per_pixel,
                                       off_chip_bytes_per_pixel=part.off_chip_bytes_per_pixel)
            whole.picture[y::height, x::width] = part.picture[y::height, x::width]
            whole.alpha[y::height, x::width] = part.alpha[y::height, x::width]
        return whole


# A spec, a Pattern, a Merge (own.py), or a function of (trace, frame) that returns a picture: height x width x 3 or 4,
# linear RGB and alpha.
AnyTechnique = Union[str, Pattern, "Merge", Callable[[Trace, int], ArrayLike]]


def spec(technique: str, **options: Any) -> str:
    """The spec of a technique with these options: spec("beam", pool=60) is "beam:pool=60". True sets a flag."""
    items = [key if value is True else f"{key}={value}" for key, value in options.items() if value is not False]
    return technique + "".join(("," if ":" in technique or i else ":") + item for i, item in enumerate(items))


def techniques() -> str:
    """All techniques and their options, as text."""
    return _native.techniques()


def name_of(technique: AnyTechnique) -> str:
    if isinstance(technique, str):
        return technique
    is_class = isinstance(technique, type)  # Pattern in place of Pattern(...)
    if hasattr(technique, "render") and not is_class:
        return technique.name
    if callable(technique) and not is_class:
        return getattr(technique, "__name__", type(technique).__name__)
    found = f"the class {technique.__name__}" if is_class else type(technique).__name__
    raise Error(f"technique: expected a spec, a Pattern, a Merge or a function, found {found}")


def technique_name(technique: AnyTechnique) -> str:
    """Its name; an error if it cannot be a technique."""
    name = name_of(technique)
    if not isinstance(technique, str) and not hasattr(technique, "render"):
        try:
            signature(technique).bind(None, 0)
        except TypeError:
            raise Error(f"{name}: expected a function of (trace, frame), or Merge(f) for a merge rule") from None
        except ValueError:
            pass  # a function of a compiled module, which does not tell its arguments
    return name


def floats_of(returned: Any) -> NDArray[numpy.float32]:
    """What a function of the user's returned; empty if it is no array of numbers."""
    try:
        return numpy.asarray([] if returned is None else returned, numpy.float32)
    except (TypeError, ValueError):
        return numpy.empty(0, numpy.float32)


def _render_native(technique: _native.Technique, trace: Trace, frame: int, *, threads: int, memory_model: bool,
                   hardware: Union[str, os.PathLike], history: Optional[_native.History] = None) -> Rendering:
    found = _native.render(trace, technique, frame, threads, memory_model, os.fspath(hardware), history)
    rgba = found.pop("rgba")
    return Rendering(technique.spec, frame, numpy.ascontiguousarray(rgba[..., :3]), rgba[..., 3].copy(), **found)


def _render_own(function: Callable, trace: Trace, frame: int) -> Rendering:
    name, (width, height) = name_of(function), trace.size(frame)
    returned = function(trace, frame)
    picture = floats_of(returned)
    if picture.shape not in ((height, width, 3), (height, width, 4)):
        found = picture.shape if picture.size else type(returned).__name__
        raise Error(f"{name}: expected a picture of {height} x {width} x 3 or 4 numbers, found {found}")
    for y, x in numpy.argwhere(~numpy.isfinite(picture).all(axis=2))[:1]:
        raise Error(f"{name}, frame {frame}, pixel ({x}, {y}): expected finite numbers, found {picture[y, x]}")
    alpha = picture[..., 3].copy() if picture.shape[2] == 4 else numpy.ones((height, width), numpy.float32)
    return Rendering(name, frame, numpy.ascontiguousarray(picture[..., :3]), alpha)


def _frames(frames: Union[int, Iterable[int], None], trace: Trace) -> list[int]:
    if frames is None:
        return list(range(trace.frames))
    chosen = list(frames) if isinstance(frames, Iterable) else [frames]
    for frame in chosen:
        if frame not in range(trace.frames):
            raise Error(f"{trace.name}: expected frames from 0 to {trace.frames - 1}, found {frame}")
    return [int(frame) for frame in chosen]


def _require_trace(trace: Trace) -> None:
    if not isinstance(trace, Trace):
        raise Error(f"trace: expected a Trace, as open_trace() returns it, found {type(trace).__name__}")


def resized(trace: Trace, width: int, height: int) -> Trace:
    _require_trace(trace)
    with expecting(f"width and height: expected whole numbers from 0, found {width} and {height}"):
        return trace.resized(width, height)


def render_frames(trace: Trace, technique: AnyTechnique, frames: list[int], *, threads: int = 0,
                  memory_model: bool = True, hardware: Union[str, os.PathLike] = "titan_v") -> list[Rendering]:
    """The frames in this order; techniques with a history keep it from one to the next."""
    how = {"threads": threads, "memory_model": memory_model, "hardware": hardware}
    if hasattr(technique, "render"):
        return [technique.render(trace, frame, **how) for frame in frames]
    if not isinstance(technique, str):
        _native.check_hardware(os.fspath(hardware))  # the others read it
        return [_render_own(technique, trace, frame) for frame in frames]
    native, history = _native.Technique(technique), _native.History()
    return [_render_native(native, trace, frame, history=history, **how) for frame in frames]


def render(trace: Trace, technique: AnyTechnique, *, frames: Union[int, Iterable[int], None] = 0, width: int = 0,
           height: int = 0, threads: int = 0, memory_model: bool = True, hardware: Union[str, os.PathLike] = "titan_v",
           **options: Any) -> Union[Rendering, list[Rendering]]:
    """Renders a frame, or, as a list, several (None: all), with which techniques over time keep their history.

    technique: a spec ("beam", "msaa:8"), a Pattern, or a function of (trace, frame) that returns height x width x 3 or
    4 finite, linear values. Options of a spec may be keywords: render(trace, "beam", pool=60). width, height: pixels;
    0: as the trace says, or in proportion to the other. threads: 0: one per core; results do not depend on it.
    memory_model: count what moves through caches and DRAM, and model times. hardware: a built-in name or a
    description's file. Unless told otherwise, compare() renders all frames without that model, and this one frame with.
    """
    technique_name(technique)  # or it is none
    if options:
        if not isinstance(technique, str):
            raise Error(f"{name_of(technique)}: expected no options, found {', '.join(options)}")
        technique = spec(technique, **options)
    trace = resized(trace, width, height)
    found = render_frames(trace, technique, _frames(frames, trace), threads=threads, memory_model=memory_model,
                          hardware=hardware)
    return found if frames is None or isinstance(frames, Iterable) else found[0]


def reference(trace: Trace, *, frames: Union[int, Iterable[int], None] = 0, width: int = 0, height: int = 0,
              threads: int = 0) -> Union[Rendering, list[Rendering]]:
    """What errors are measured against: 4096 samples per pixel. Arguments and results are those of render()."""
    return render(trace, _native.reference_spec, frames=frames, width=width, height=height, threads=threads)


class Inspection(dict):
    """What `beampipe inspect --json` prints of a pixel; str() is the text of `beampipe inspect`."""

    def __init__(self, values: dict, text: str):
        super().__init__(values)
        self.text = text

    def __str__(self) -> str:
        return self.text


def inspect(trace: Trace, technique: str, x: int, y: int, *, frame: int = 0, threads: int = 0,
            **options: Any) -> Inspection:
    """What happened in pixel (x, y), which counts from the upper left one, and why it is wrong."""
    _require_trace(trace)
    native = _native.Technique(spec(technique, **options))
    with expecting(f"pixel {x},{y}, frame {frame}: expected whole numbers from 0"):
        text = _native.inspect(trace, native, x, y, frame, threads)
    return Inspection(json.loads(text[0]), text[1])
