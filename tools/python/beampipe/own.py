"""Techniques of the user's: rules that merge fragments, and the program `beampipe` with such techniques."""
from __future__ import annotations

import hashlib
import inspect
import os
import re
import sys
from typing import Any, Callable, Iterable, Optional, Union

import numpy
from numpy.typing import ArrayLike, NDArray

from . import _native, rendering
from ._native import Trace
from .rendering import AnyTechnique, Pattern, Rendering
from .results import Error


class Merge:
    """A technique that merges the fragments of each pixel by a rule of one's own.

    rule(fragments) returns linear R, G and B times A, and A, the part of the pixel that is covered, 0..1; the background
    shows through the rest. `fragments` is a structured array of at least one fragment, near to far by depth:
    fragments["area"] is a column of it, and fragments[0]["area"] a number.

      area    of the triangle in the pixel, 0..1
      mask    `positions` booleans: which of the positions it covers; a small triangle may cover none
      color   linear R, G and B, shaded at the centroid
      depth   at the centroid, from -1 (near) to 0 (far)
      plane   depth is plane[0] + plane[1] (x - 1/2) + plane[2] (y - 1/2), x and y as in `places`
      front   whether the front of the triangle is seen

    A cutout or translucent surface has less area and fewer positions. places: positions x 2, x to the right and y down
    from the pixel's upper left corner, 0..1. All stages are counted but the rule itself, whose cost is in no counter
    and no modelled time. It may run in any thread.
    """

    def __init__(self, rule: Callable[[NDArray], ArrayLike], *, positions: int = 256, name: str = ""):
        if not callable(rule):
            raise Error(f"rule: expected a function, found {type(rule).__name__}")
        if positions not in (32, 64, 128, 256):
            raise Error(f"positions: expected 32, 64, 128 or 256, found {positions}")
        self.rule, self.name, self.positions = rule, name or rendering.name_of(rule), positions
        self.has_run = False  # for the note of program()
        self.places: NDArray[numpy.float64] = numpy.array(_native.places_of_positions(positions)) / 256
        self.technique = _native.merge_technique(self.name, self._merge, positions)
        self._record = numpy.dtype([("area", "f4"), ("depth", "f4"), ("plane", "f4", 3), ("front", "?"),
                                    ("color", "f4", 3), ("mask", "?", positions)])

    def _merge(self, place: tuple[int, int, int, int], first: NDArray, *columns: NDArray) -> NDArray:
        """The pixels of a bin at a place (frame, left, top, width). The fragments of pixel i are those from first[i] to
        first[i + 1]."""
        self.has_run = True
        fragments = numpy.empty(len(columns[0]), self._record)
        for key, column in zip(self._record.names, columns):
            fragments[key] = column
        merged = numpy.zeros((len(first) - 1, 4), numpy.float32)
        for pixel in numpy.flatnonzero(numpy.diff(first)):
            returned = self._merged(fragments[first[pixel]:first[pixel + 1]])
            found = rendering.floats_of(returned)
            if found.shape != (4,):
                raise self._wrong(place, pixel, found.shape if found.ndim and found.size else type(returned).__name__)
            merged[pixel] = found
        color, alpha = merged[:, :3], merged[:, 3]
        lowest = -1e-3 * numpy.maximum(1, color.max(axis=1))  # rounding may lead to less than 0
        right = numpy.isfinite(merged).all(axis=1) & (color.min(axis=1) >= lowest) & (abs(alpha - 0.5) <= 0.501)
        if not right.all():
            raise self._wrong(place, numpy.argmin(right), merged[numpy.argmin(right)])
        return merged

    def _wrong(self, place: tuple[int, int, int, int], pixel: int, found: Any) -> Error:
        frame, left, top, width = place
        at = f"frame {frame}, pixel ({left + pixel % width}, {top + pixel // width})"
        return Error(f"{self.name}, {at}: expected 4 finite numbers from the rule, R, G and B from 0 and A from 0 to 1"
                     f", found {found}")

    def _merged(self, fragments: NDArray) -> ArrayLike:
        try:
            return self.rule(fragments)
        except ValueError as error:
            if "no field" not in str(error):
                raise
            expected = f"{self.name}: {error}: expected {', '.join(self._record.names)}"
            raise Error(expected).with_traceback(error.__traceback__) from None  # where the rule asks for it

    def render(self, trace: Trace, frame: int, **how: Any) -> Rendering:
        return rendering._render_native(self.technique, trace, frame, **how)


def _code_of(technique: AnyTechnique) -> tuple[str, str]:
    """The file that the technique's code is in, and a digest of that file and of the script that runs."""
    function = getattr(technique, "rule", technique)
    try:
        file: Optional[str] = inspect.getsourcefile(function if callable(function) else type(function))
    except TypeError:
        file = None
    script = getattr(sys.modules["__main__"], "__file__", None)
    digest = hashlib.sha256()
    for each in sorted({file, script} - {None}):
        if os.path.isfile(each):
            with open(each, "rb") as code:
                digest.update(code.read())
    named = script if isinstance(technique, Pattern) else file  # a pattern's class is ours
    return os.path.basename(named or "Python"), digest.hexdigest()[:16]


def _own_kind(technique: AnyTechnique) -> _native.OwnKind:
    name = rendering.technique_name(technique)
    if isinstance(technique, str):
        raise Error(f"technique: expected a function, a Merge or a Pattern, found the spec {name}")
    if not re.fullmatch("[a-z][a-z0-9_]*", name):
        raise Error(f"technique {name}: expected a name of small letters, digits and _")
    if isinstance(technique, Merge):
        native, described = technique.technique, technique.rule
    elif isinstance(technique, Pattern) and technique.tile == (1, 1):
        native, described = technique.technique, None
    else:
        def render(trace: Trace, frame: int) -> NDArray[numpy.float32]:
            found = rendering.render(trace, technique, frames=frame, memory_model=False)
            return numpy.dstack([found.picture, found.alpha])
        native, described = _native.function_technique(name, render), technique
    text = inspect.getdoc(described) if inspect.isroutine(described) else None
    file, code = _code_of(technique)
    return _native.OwnKind(native, (text or "a technique of one's own").splitlines()[0].rstrip("."), file, code)


def program(arguments: Iterable[Union[str, os.PathLike]], techniques: Iterable[AnyTechnique] = ()) -> int:
    """Runs the program `beampipe`, whose commands know these techniques by their names, and returns its exit code.

    arguments: those of the command line, such as sys.argv[1:]. techniques: functions and patterns as for compare(), and
    Merge. A script that ends in sys.exit(beampipe.program(sys.argv[1:], [mine])) is a program of its own:
    `python3 script.py compare fence.json -t mine beam -o out`. Results of a script that has changed since are not taken
    for those of this one. Where the rule of a Merge ran, a note on stderr says that its cost is left out. Call it from
    the main thread. Ctrl-C ends the process.
    """
    own = list(techniques)
    kinds = [_own_kind(each) for each in own]
    script = getattr(sys.modules["__main__"], "__file__", None)
    start = [sys.executable, os.path.abspath(script)] if script else []
    for each in own:
        if isinstance(each, Merge):
            each.has_run = False
    code = _native.program(["beampipe", *map(os.fspath, arguments)], start, kinds)
    rules = ", ".join(each.name for each in own if isinstance(each, Merge) and each.has_run)
    if rules and code == 0:
        print(f"beampipe: note: {rules}: what the rule itself computes is in no counter and no modelled time",
              file=sys.stderr)
    return code
