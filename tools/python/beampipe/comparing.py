"""Errors of techniques against the reference, and the MSAA rates that are as accurate."""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from operator import index
from typing import Callable, Iterable, Iterator, Optional, Sequence, Union

import numpy
from numpy.typing import ArrayLike

from . import _native, rendering
from ._native import Trace
from .rendering import AnyTechnique, Rendering
from .results import Error, Rate, each_spec

# The key of a measure (measures.METRICS), or a function of (image, reference), both height x width x 3 in linear light,
# that returns 0 where they are equal, and more the worse the image is.
AnyMetric = Union[str, Callable[[numpy.ndarray, numpy.ndarray], float]]


def equivalent_rate(error: float, ladder: Sequence[tuple[int, float]]) -> Rate:
    """The rate at which msaa:N has this error. ladder: (N, error) for rising N."""
    samples = [n for n, _ in ladder]
    if not samples or samples != sorted(set(samples)):
        raise Error(f"ladder: expected (N, error) for rising N, found {', '.join(map(str, samples)) or 'none'}")
    for name, each in [("error", error), *((f"error of msaa:{n}", height) for n, height in ladder)]:
        if not (math.isfinite(each) and each >= 0):
            raise Error(f"{name}: expected a number that is at least 0, found {each}")
    return Rate(**_native.equivalent_rate(error, ladder, None, None))


@dataclass(frozen=True, eq=False)
class Result:
    """What compare() found of a technique: errors by the keys of measures.MEANINGS, the error by the metric (sRGB RMSE
    for psnr, 1 - SSIM for ssim), and its equivalent MSAA rate; `renderings` has the frames."""
    name: str
    errors: dict[str, float]
    error: float
    rate: Rate
    renderings: list[Rendering] = field(repr=False)


@dataclass(frozen=True, eq=False)
class Comparison:
    """Results by name, in the order of the techniques; `title` is what errors by the metric are, `ladder` has (N, error
    by the metric) of msaa:N, and `reference_error` the RMSE of the reference itself, if it was measured."""
    metric: str
    title: str
    results: dict[str, Result]
    reference: list[Rendering]
    ladder: list[tuple[int, float]]
    reference_error: Optional[float] = None

    def __getitem__(self, name: str) -> Result:
        if name not in self.results:
            raise Error(f"comparison: expected one of the techniques {', '.join(self.results)}, found {name}")
        return self.results[name]

    def __iter__(self) -> Iterator[Result]:
        return iter(self.results.values())

    def __len__(self) -> int:
        return len(self.results)

    def __repr__(self) -> str:
        return self.table()

    def table(self) -> str:
        """One line for each technique: RMSE x 1000, the error by the metric, the equivalent rate and its range."""
        rows = [("technique", "RMSE x 1000", self.title, "EMR", "within")]
        rows += [(each.name, f"{1000 * each.errors['rmse']:.3f}", f"{each.error:.4g}", each.rate.text, each.rate.within)
                 for each in self]
        widths = [max(len(row[column]) for row in rows) for column in range(5)]
        return "\n".join("  ".join(text.ljust(width) for text, width in zip(row, widths)).rstrip() for row in rows)


class _Metric:
    """Errors of pictures by a metric; those of several frames as if they were one picture."""

    def __init__(self, metric: AnyMetric, reference: list[Rendering], pixels_per_degree: float):
        if not callable(metric) and metric not in _native.metric_names:
            raise Error(f"metric: expected one of {', '.join(_native.metric_names)}, or a function, found {metric}")
        self.metric, self.name = metric, metric if isinstance(metric, str) else rendering.name_of(metric)
        # What equivalent rates compare of a metric of beampipe (find_metric() in tools/evaluate/measures.h).
        titles = {key: title for key, (title, _, _) in _native.meanings.items()}
        titles.update(psnr=titles["srgb_rmse"], ssim=f"1 - {titles['ssim']}")
        self.title = titles[metric] if isinstance(metric, str) else self.name
        self.truths, self.pixels_per_degree = [each.picture for each in reference], pixels_per_degree

    def _own(self, pictures: list) -> float:
        errors = [float(self.metric(picture, truth)) for picture, truth in zip(pictures, self.truths)]
        error = numpy.average(errors, weights=[truth.size for truth in self.truths])
        if not (numpy.isfinite(error) and error >= 0):
            raise Error(f"metric {self.name}: expected a number that is at least 0, found {error}")
        return float(error)

    def of(self, renderings: list[Rendering]) -> float:
        pictures = [each.picture for each in renderings]
        if not isinstance(self.metric, str):
            return self._own(pictures)
        return _native.measure(pictures, self.truths, self.pixels_per_degree, self.metric)[1][self.metric]

    def blocks_of(self, renderings: list[Rendering]) -> list[float]:
        """Squared errors of parts of the picture, which say how far a rate by RMSE is open; of other metrics, none."""
        return _native.block_squares([each.picture for each in renderings], self.truths) if self.metric == "rmse" else []

    def all_of(self, renderings: list[Rendering]) -> tuple[dict[str, float], float]:
        pictures = [each.picture for each in renderings]
        values, errors = _native.measure(pictures, self.truths, self.pixels_per_degree, "")
        if isinstance(self.metric, str):
            return values, errors[self.metric]
        own = self._own(pictures)
        return {**values, self.name: own}, own


def compare(trace: Trace, techniques: Iterable[AnyTechnique], *, metric: AnyMetric = "rmse",
            frames: Union[int, Iterable[int], None] = None, measure_from: int = 0, width: int = 0, height: int = 0,
            threads: int = 0, ladder: Optional[Sequence[int]] = None, memory_model: bool = False,
            reference_error: bool = False, pixels_per_degree: float = _native.pixels_per_degree) -> Comparison:
    """Renders frames (None: all) with techniques and with the reference, and measures how wrong they are.

    techniques: as for render(). metric: the measure by which equivalent MSAA rates are found, or a function of (image,
    reference), both height x width x 3, linear, that returns 0 for equal pictures. measure_from: draw the first N of
    the frames only with techniques that keep a history, and measure the others. ladder: MSAA rates to measure (default:
    1, 2, 4, ... 256, and 512 and 1024 while a technique is better). memory_model: as for render(), but off unless asked
    for, so that renderings have no `times`. reference_error: render reference:set=2 too, measure the reference's own
    error, and widen the ranges of rates by it. pixels_per_degree: of the view, for FLIP.
    """
    one = isinstance(techniques, str) or not isinstance(techniques, Iterable)
    wanted = list(each_spec([techniques] if one else techniques))
    if reference_error and _native.second_reference_spec not in wanted:
        wanted.append(_native.second_reference_spec)
    names = [rendering.technique_name(each) for each in wanted]
    for name in names:
        if names.count(name) > 1:
            raise Error(f"technique {name} is given twice")
    rungs = sorted(set(_native.default_rungs if ladder is None else ladder))
    own_rungs = {each: _native.Technique(each).rung for each in wanted if isinstance(each, str)}
    for n in rungs:
        _native.Technique(f"msaa:{n}")  # or an error before anything is rendered
    trace = rendering.resized(trace, width, height)
    chosen = rendering._frames(frames, trace)
    if not chosen:
        raise Error("frames: expected at least one, found none")
    wrong = f"measure_from: expected a number from 0 to {len(chosen) - 1}, found {measure_from}"
    with rendering.expecting(wrong):
        measure_from = index(measure_from)
    if measure_from not in range(len(chosen)):
        raise Error(wrong)

    def rendered(technique: AnyTechnique, models: bool = False) -> list[Rendering]:
        keeps_history = isinstance(technique, str) and _native.Technique(technique).keeps_history
        drawn = chosen if keeps_history else chosen[measure_from:]
        all_drawn = rendering.render_frames(trace, technique, drawn, threads=threads, memory_model=models)
        return all_drawn[measure_from:] if keeps_history else all_drawn

    reference = rendered(_native.reference_spec)
    measured = _Metric(metric, reference, pixels_per_degree)
    found = {}
    for name, technique in zip(names, wanted):
        renderings = rendered(technique, memory_model)
        found[name] = (renderings, *measured.all_of(renderings))

    blocks = {name: measured.blocks_of(renderings) for name, (renderings, _, _) in found.items()}

    def rung(n: int) -> tuple[int, float]:
        spec = f"msaa:{n}"
        if spec in found:
            return n, found[spec][2]
        renderings = rendered(spec)
        blocks[spec] = measured.blocks_of(renderings)
        return n, measured.of(renderings)

    heights = [rung(n) for n in rungs]
    others = [error for name, (_, _, error) in found.items()
              if not own_rungs.get(name) and name.split(":")[0] != _native.reference_spec]
    for n in _native.more_rungs if ladder is None else ():
        if not any(error < min(height for _, height in heights) for error in others):
            break
        heights.append(rung(n))

    second = found.get(_native.second_reference_spec)  # two independent references differ by the errors of both
    own_error = second[1]["rmse"] / math.sqrt(2) if second else None
    results = {}
    for name, (renderings, errors, error) in found.items():
        own = own_rungs.get(name)
        of_blocks = (blocks[name], [blocks[f"msaa:{n}"] for n, _ in heights]) if metric == "rmse" else None
        rate = Rate(own) if own else Rate(**_native.equivalent_rate(error, heights, of_blocks,
                                                                    own_error if metric == "rmse" else None))
        results[name] = Result(name, errors, error, rate, renderings)
    return Comparison(measured.name, measured.title, results, reference, heights, own_error)
