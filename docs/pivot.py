#!/usr/bin/env python3
"""Prints one column of a sweep's table as Markdown, by two others.

usage: docs/pivot.py TABLE ROWS COLUMNS VALUE [--scale FACTOR] [--digits N]

TABLE is table.csv of `beampipe sweep`; ROWS, COLUMNS and VALUE are names of its columns. A cell is the geometric mean over
the rows of the table that agree in both, times FACTOR: `docs/pivot.py l2/table.csv technique memory_system.l2_bytes
dram_bytes --scale 1e-6` prints megabytes for each technique and size of L2.
"""
import argparse
import csv
import math

from measure import print_head, print_row


def title(name, value):
    """A number of bytes in KiB or MiB, anything else as it is."""
    if not name.endswith("_bytes"):
        return value
    kib = int(value) / 1024
    return f"{kib:g} KiB" if kib < 1024 else f"{kib / 1024:g} MiB"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("table", "rows", "columns", "value"):
        parser.add_argument(name)
    parser.add_argument("--scale", type=float, default=1)
    parser.add_argument("--digits", type=int, default=1)
    options = parser.parse_args()
    cells = {}
    with open(options.table, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            missing = {options.rows, options.columns, options.value} - set(row)
            if missing:
                parser.error(f"{options.table}: expected a column {min(missing)}, found none")
            cells.setdefault((row[options.rows], row[options.columns]), []).append(float(row[options.value]))
    rows = list(dict.fromkeys(row for row, _ in cells))
    columns = list(dict.fromkeys(column for _, column in cells))
    print_head(options.rows, *(title(options.columns, column) for column in columns))
    for row in rows:
        means = [math.exp(sum(map(math.log, cells[row, column])) / len(cells[row, column])) for column in columns]
        print_row(f"`{row}`", *(f"{options.scale * mean:.{options.digits}f}" for mean in means))


main()
