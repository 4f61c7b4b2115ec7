"""Measures of a picture's error, by name: measures.rmse(image, reference), measures.ssim(...), and so on.

Pictures are height x width x 3 (a fourth channel is ignored), linear RGB. MEANINGS says what each measure is; METRICS
are those by which compare() finds equivalent rates, and MAPS those that error_map() gives for each pixel.
"""
from __future__ import annotations

from typing import Callable

import numpy
from numpy.typing import ArrayLike, NDArray

from . import _native

MEANINGS: dict[str, tuple[str, str, str]] = _native.meanings  # title, unit and meaning by key
METRICS: list[str] = _native.metric_names
MAPS: list[str] = _native.map_names
PIXELS_PER_DEGREE: float = _native.pixels_per_degree  # of the view, for FLIP: a 4K screen of 0.7 m from 0.7 m


def measure_all(image: ArrayLike, reference: ArrayLike, pixels_per_degree: float = PIXELS_PER_DEGREE) -> dict[str, float]:
    """All measures by key. Equal pictures have no PSNR."""
    return _native.measure([numpy.asarray(image)], [numpy.asarray(reference)], pixels_per_degree, "")[0]


def error_map(key: str, image: ArrayLike, reference: ArrayLike,
              pixels_per_degree: float = PIXELS_PER_DEGREE) -> NDArray[numpy.float32]:
    """height x width: the measure of each pixel."""
    return _native.map(key, numpy.asarray(image), numpy.asarray(reference), pixels_per_degree)


def _function(key: str) -> Callable[..., float]:
    def measure(image: ArrayLike, reference: ArrayLike, pixels_per_degree: float = PIXELS_PER_DEGREE) -> float:
        values = _native.measure([numpy.asarray(image)], [numpy.asarray(reference)], pixels_per_degree, key)[0]
        return values.get(key, float("inf"))  # PSNR of equal pictures
    title, unit, meaning = MEANINGS[key]
    measure.__name__ = measure.__qualname__ = key
    measure.__doc__ = f"{title}{f' ({unit})' if unit else ''}: {meaning}"
    return measure


rmse = _function("rmse")
bias = _function("bias")
p99 = _function("p99")
p999 = _function("p999")
maximum = _function("max")
mae = _function("mae")
rel_mse = _function("rel_mse")
srgb_rmse = _function("srgb_rmse")
psnr = _function("psnr")
ssim = _function("ssim")
flip = _function("flip")
hdr_flip = _function("hdr_flip")
