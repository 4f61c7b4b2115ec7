#!/usr/bin/env python3
"""Prints the table of docs/costs.md about what pixels need of the pool.

usage: docs/records.py PROGRAM TRACE...

For the first frame of each trace: of the pixels, how many ever had a record; the bytes of these records (the most that
each had), mean and greatest; the most that the records of a bin had together, per pixel; how many records continued in
memory; and collections, for each bin and as operations of composition beside those with a pool so large that there are
hardly any.
"""
import pathlib
import sys
import tempfile

from measure import print_head, print_row, results, stages

POOLS = {40: "beam", 60: "beam:pool=60", 128: "beam:pool=128"}


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__.strip())
    program, *traces = sys.argv[1:]
    print_head("scene", "pixels with a record", "bytes, mean", "greatest", "of a bin, per pixel",
               "records in memory, `pool=40`", "`pool=60`", "collections for a bin, `pool=40`", "`pool=60`",
               "operations of `compose`, `pool=40`", "`pool=60`")
    for trace in traces:
        with tempfile.TemporaryDirectory() as folder:
            found = results(program, "run", trace, POOLS.values(), folder, "--frames", "0", "--no-memory-model",
                            "--on-chip-memory", "320KB")
        of = {pool: found[spec]["frames"][0]["pixel_counters"] for pool, spec in POOLS.items()}
        operations = {pool: stages(found[spec])["compose"]["ops"]["total"] for pool, spec in POOLS.items()}
        record = of[40]["record_bytes"]
        print_row(pathlib.Path(trace).stem, f"{100 * record['share']:.0f} %",
                  f"{record['mean'] / record['share']:.0f}" if record["share"] else "", f"{record['max']:.0f}",
                  f"{of[40]['pool_bytes']['max']:.0f}",
                  *(f"{100 * of[pool]['memory_chunks']['share']:.1f} %" for pool in (40, 60)),
                  *(f"{of[pool]['collections']['mean']:.1f}" for pool in (40, 60)),
                  *(f"{operations[pool] / operations[128]:.3f}" for pool in (40, 60)))


main()
