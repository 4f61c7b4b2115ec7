"""Reads what the program beampipe writes: reports, pictures and counters, and tables of sweeps. Needs numpy alone."""
from __future__ import annotations

import contextlib
import csv
import dataclasses
import json
import operator
import pathlib
import re
import sqlite3
import struct
import zlib
from typing import Iterable, Iterator, Optional

import numpy


class Error(Exception):
    """One line: the file, and what is wrong with it."""


@contextlib.contextmanager
def expecting(what: str) -> Iterator[None]:
    """Says this in place of the compiled module's errors, many lines of types, where a type of an argument is wrong."""
    try:
        yield
    except TypeError:
        raise Error(what) from None


@dataclasses.dataclass(frozen=True)
class Rate:
    """An equivalent MSAA rate (EMR): samples per pixel.

    is_lower_bound: it is more than `samples`, the last rung; is_upper_bound: it is less than `samples`, the first.
    does_not_converge: there is none, because the ladder falls no more. low, high: its range, about a standard deviation
    to each side, as far as it is known.
    """
    samples: float
    is_lower_bound: bool = False
    is_upper_bound: bool = False
    does_not_converge: bool = False
    low: Optional[float] = None
    high: Optional[float] = None

    @property
    def text(self) -> str:
        """Without its range."""
        if self.does_not_converge:
            return "does not converge"
        return ("≥ " if self.is_lower_bound else "< " if self.is_upper_bound else "") + _samples_text(self.samples)

    @property
    def within(self) -> str:
        """Its range, "659..938", as far as it is known."""
        return "" if self.low is None and self.high is None else "..".join(
            "" if end is None else _samples_text(end) for end in (self.low, self.high))

    def __str__(self) -> str:
        return f"{self.text} ({self.within})" if self.within else self.text


def _samples_text(samples: float) -> str:
    return f"{samples:.0f}" if samples >= 100 else f"{samples:.3g}"


def each_spec(specs: Iterable) -> Iterator:
    """msaa:8,32 is short for msaa:8 and msaa:32."""
    for spec in specs:
        if isinstance(spec, str) and re.fullmatch("msaa:[0-9,]+", spec):
            yield from (f"msaa:{samples}" for samples in spec[len("msaa:"):].split(","))
        else:
            yield spec


class Exr(dict):
    """Channels by name, each height x width, row 0 on top; `attributes` has the header's texts by name."""

    def __init__(self, attributes):
        super().__init__()
        self.attributes = attributes


MOST_PIXELS = 16384 * 16384
TYPES = {1: numpy.dtype("<f2"), 2: numpy.dtype("<f4")}  # as numbered in a list of channels
ROWS_OF_ZIP, ZIP, ZIPS, NONE = 16, 3, 2, 0


def _text(data, at):
    """The text that ends in a zero byte, and where it ends."""
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def _channels(value):
    """The channels of a picture in the order of their data: names and types."""
    channels, at = [], 0
    while value[at] != 0:
        name, at = _text(value, at)
        kind, _, x_sampling, y_sampling = struct.unpack_from("<iIii", value, at)
        if kind not in TYPES or (x_sampling, y_sampling) != (1, 1):
            raise Error(f"channel {name}: expected half or float at every pixel")
        channels.append((name, TYPES[kind]))
        at += 16
    return channels


def _unzip(block, size):
    """What ZIP compression of OpenEXR stands for: deflate of differences of bytes, with even bytes before odd ones."""
    if len(block) == size:  # as it is, because it would not have become smaller
        return block
    differences = numpy.frombuffer(zlib.decompressobj().decompress(block, size), numpy.uint8)
    if len(differences) != size:
        raise Error(f"a block of {len(differences)} bytes in place of {size}")
    values = differences.astype(numpy.int64)
    values[1:] -= 128
    values = (numpy.cumsum(values) & 255).astype(numpy.uint8)
    result = numpy.empty(size, numpy.uint8)
    half = (size + 1) // 2
    result[0::2], result[1::2] = values[:half], values[half:]
    return result.tobytes()


def read_exr(file):
    """The channels of a scanline picture whose data window is the whole picture, uncompressed or with ZIP compression."""
    try:
        data = pathlib.Path(file).read_bytes()
    except FileNotFoundError:
        raise Error(f"{file}: expected an EXR file, found none") from None
    try:
        return _read_exr(data)
    except (Error, ValueError, LookupError, struct.error, zlib.error, UnicodeDecodeError) as error:
        raise Error(f"{file}: expected an EXR file as beampipe writes it: {error}") from None


def _read_exr(data):
    if data[:4] != b"\x76\x2f\x31\x01":
        raise Error("its first bytes are others")
    header, at = {}, 8
    while data[at] != 0:
        name, at = _text(data, at)
        kind, at = _text(data, at)
        size, = struct.unpack_from("<i", data, at)
        header[name] = (kind, data[at + 4:at + 4 + size])
        at += 4 + size
    at += 1
    x0, y0, x1, y1 = struct.unpack("<4i", header["dataWindow"][1])
    width, height, compression = x1 + 1, y1 + 1, header["compression"][1][0]
    if (x0, y0) != (0, 0) or width < 1 or height < 1 or width * height > MOST_PIXELS:
        raise Error(f"a data window from ({x0}, {y0}) to ({x1}, {y1})")
    if compression not in (NONE, ZIPS, ZIP):
        raise Error(f"compression {compression}; expected none or ZIP")
    channels = _channels(header["channels"][1])
    row_bytes = width * sum(kind.itemsize for _, kind in channels)
    if row_bytes * height > 1100 * len(data):
        raise Error(f"it claims {width} x {height} pixels, too many for its {len(data)} bytes")
    exr = Exr({name: value.decode("utf-8", "replace") for name, (kind, value) in header.items() if kind == "string"})
    for name, kind in channels:
        exr[name] = numpy.empty((height, width), kind)
    rows = ROWS_OF_ZIP if compression == ZIP else 1
    for index in range((height + rows - 1) // rows):
        offset, = struct.unpack_from("<Q", data, at + 8 * index)
        first, size = struct.unpack_from("<ii", data, offset)
        count = min(rows, height - first)
        block = data[offset + 8:offset + 8 + size]
        if compression != NONE:
            block = _unzip(block, count * row_bytes)
        place = 0
        for row in range(first, first + count):
            for name, kind in channels:
                exr[name][row] = numpy.frombuffer(block, kind, width, place)
                place += width * kind.itemsize
    return exr


class Report:
    """The results in a folder of `beampipe run` or `beampipe compare`, by technique. `json` is all of report.json."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        file = self.folder / "report.json"
        try:
            self.json = json.loads(file.read_text(encoding="utf-8"))
            self._results = {result["technique"]: result for result in self.json["results"]}
        except FileNotFoundError:
            raise Error(f"{file}: expected the report of a finished run, found none") from None
        except (ValueError, KeyError, TypeError):
            raise Error(f"{file}: expected the report of a run") from None

    @property
    def techniques(self):
        return list(self._results)

    def __iter__(self):
        return iter(self._results.values())

    def __len__(self):
        return len(self._results)

    def __repr__(self):
        return f"Report({str(self.folder)!r}) of {', '.join(self._results)}"

    def __getitem__(self, technique):
        if technique not in self._results:
            raise Error(f"{self.folder}: expected one of the techniques {', '.join(self._results)}, found {technique}")
        return self._results[technique]

    def rate(self, technique) -> Optional[Rate]:
        """The equivalent MSAA rate, if the run compared techniques with the reference."""
        result, key = self[technique], "equivalent_msaa"
        if result.get(f"{key}_does_not_converge"):
            return Rate(numpy.inf, does_not_converge=True)
        if key not in result:
            return None
        return Rate(result[key], bool(result.get(f"{key}_is_lower_bound")), bool(result.get(f"{key}_is_upper_bound")),
                    low=result.get(f"{key}_low"), high=result.get(f"{key}_high"))

    def frames(self, technique):
        return self[technique]["frames"]

    def _frame(self, technique, frame):
        frames = self.frames(technique)
        with expecting(f"{self.folder}: expected a whole number as a frame, found {frame}"):
            frame = operator.index(frame)
        if frame not in range(len(frames)):
            raise Error(f"{self.folder}: expected a frame from 0 to {len(frames) - 1}, found {frame}")
        return frames[frame]

    def stages(self, technique):
        """Counters by stage and name, summed over the frames. Those of operations are named "ops.add" and so on."""
        sums = {}
        for frame in self.frames(technique):
            for stage in frame["stages"]:
                of_stage = sums.setdefault(stage["stage"], {})
                for name, value in stage.items():
                    numbers = {f"{name}.{key}": each for key, each in value.items()} if name == "ops" else {name: value}
                    for key, number in numbers.items():
                        if isinstance(number, (int, float)) and not isinstance(number, bool):
                            of_stage[key] = of_stage.get(key, 0) + number
        return sums

    def picture(self, technique, frame=0):
        """Linear RGBA of a frame (counted from 0 within the report): height x width x 4."""
        exr = read_exr(self.folder / self._frame(technique, frame)["image"])
        return numpy.stack([exr[name] for name in "RGBA"], axis=-1)

    def counters(self, technique, frame=0):
        """What was counted for each pixel of a frame, by name; none if nothing was."""
        file = self._frame(technique, frame).get("counters")
        return read_exr(self.folder / file) if file else Exr({})


def _column(values):
    """An array of integers, of numbers (NaN where there is none), or of texts."""
    with contextlib.suppress(ValueError, OverflowError):
        return numpy.array([int(str(value)) for value in values], numpy.int64)
    try:
        return numpy.array([float(value) if value not in (None, "") else numpy.nan for value in values])
    except ValueError:
        return numpy.array([str(value) for value in values])


def _table(file):
    """The names of its columns, and its rows."""
    if file.suffix == ".sqlite":
        with sqlite3.connect(f"file:{file}?mode=ro", uri=True) as database:
            tables = "SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY rowid"
            (name,), *_ = database.execute(tables).fetchall()
            cursor = database.execute(f'SELECT * FROM "{name}"')
            return [column[0] for column in cursor.description], cursor.fetchall()
    with open(file, newline="", encoding="utf-8") as stream:
        names, *rows = (row for row in csv.reader(stream) if row)
    if names[0].startswith(("{", "[")) or any(len(row) != len(names) for row in rows):  # JSON, for example
        raise ValueError
    return names, rows


def read_table(file):
    """The columns of a table by name, from CSV (also those of `beampipe report`) or SQLite (the first table). Columns
    are arrays of integers, of numbers (NaN where there is none), or of texts."""
    file = pathlib.Path(file)
    if not file.is_file():
        raise Error(f"{file}: expected a table, found no file")
    try:
        names, rows = _table(file)
    except (ValueError, IndexError, csv.Error, sqlite3.Error):
        raise Error(f"{file}: expected a table, CSV or SQLite (.sqlite)") from None
    return {name: _column([row[i] for row in rows]) for i, name in enumerate(names)}
