"""Traces: recorded frames of triangles."""
from __future__ import annotations

import os
from typing import Optional, Sequence, Union

import numpy
from numpy.typing import ArrayLike

from . import _native
from ._native import Trace
from .results import Error, expecting

DEFAULT_COLOR = 0.8  # grey, linear


def make(scene: str, *, triangles: int = 0, seed: int = 1, width: int = 320, height: int = 180, frames: int = 1,
         orbit: float = 0, pan: Sequence[float] = (0, 0)) -> Trace:
    """A procedural scene, as `beampipe make` makes it; scenes() lists their names.

    triangles: about as many; 0: the scene's own number. width, height: pixels. Of several frames, the camera turns by
    `orbit` degrees in all, or the picture moves by `pan` pixels (right, down) from each to the next.
    """
    with expecting("make: expected whole numbers from 0 for triangles, seed, width, height and frames, and numbers for "
                   "orbit and pan"):
        return _native.make(scene, triangles, seed, width, height, frames, orbit, pan)


def scenes() -> list[str]:
    """The names of all procedural scenes."""
    return _native.scenes()


def open_trace(file: Union[str, os.PathLike], *, allow_outside: bool = False) -> Trace:
    """Reads a trace, a JSON file. allow_outside: the trace may name files outside its own folder."""
    return _native.open_trace(file, allow_outside)


def _array(values: ArrayLike, name: str, kind: type) -> numpy.ndarray:
    try:
        array = numpy.asarray(values)
        if kind is int and not numpy.issubdtype(array.dtype, numpy.integer):
            raise TypeError
        return array.astype(numpy.int64 if kind is int else float)
    except (TypeError, ValueError):
        raise Error(f"trace: {name}: expected an array of {'integers' if kind is int else 'numbers'}") from None


def trace_from_arrays(positions: ArrayLike, triangles: ArrayLike, colors: Optional[ArrayLike] = None, *,
                      width: int, height: int, background: ArrayLike = (0, 0, 0),
                      eye: Optional[Sequence[float]] = None, target: Sequence[float] = (0, 0, 0),
                      up: Sequence[float] = (0, 1, 0), fovy: float = 45, near: float = 0.1, far: float = 1000,
                      view: Optional[ArrayLike] = None, projection: Optional[ArrayLike] = None) -> Trace:
    """A trace of one frame with one mesh of flat, unlit triangles, whose both sides are drawn.

    positions: N x 3, scene units. triangles: T x 3 indices into them. colors: T x 3 or 3, linear RGB (default: grey,
    0.8). background: linear RGB. The camera is at `eye` and looks at `target`; fovy is its full vertical angle in
    degrees; 0 < near < far. In its place, `view` and `projection` are 4 x 4 matrices that multiply column vectors
    (default: identities, so that positions are in clip space: x to the right, y up, z from -1 near to 1 far).
    """
    vertices = _array(positions, "positions", float)
    indices = _array(triangles, "triangles", int)
    shades = _array(DEFAULT_COLOR if colors is None else colors, "colors", float)
    if shades.ndim < 2 and indices.ndim == 2:
        shades = numpy.broadcast_to(shades, (len(indices), 3)) if shades.size in (1, 3) else shades
    mesh = (vertices, indices, shades, _array(background, "background", float), width, height)
    if eye is None:
        matrices = [numpy.eye(4) if matrix is None else _array(matrix, name, float)
                    for name, matrix in (("view", view), ("projection", projection))]
        return _native.trace_with_matrices(*mesh, *matrices)
    if view is not None or projection is not None:
        raise Error("trace: expected either eye, or view and projection, found both")
    return _native.trace_with_camera(*mesh, eye, target, up, fovy, near, far)
