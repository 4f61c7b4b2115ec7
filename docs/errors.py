#!/usr/bin/env python3
"""Prints the errors of finished comparisons, with the memory that each technique takes.

usage: docs/errors.py [--names] DIR...

`beampipe compare TRACE -t SPEC... -o DIR` wrote the folders. Bytes are per pixel, each at its peak: on chip, a bin's buffers
over its pixels; off chip, the framebuffer and the A-buffer. With --names, a column says what each technique is.
"""
import json
import pathlib
import sys

from measure import print_head, print_row

NAMES = {"beam": "ours", "beam:order=sorted": "ours, with an A-buffer", "casav": "Crassin et al. 2018",
         "msaa": "multisampling"}


def name_of(spec):
    return NAMES.get(spec, NAMES.get(spec.split(":")[0], ""))


def emr(result):
    bound = ("≥ " if result.get("equivalent_msaa_is_lower_bound") else
             "< " if result.get("equivalent_msaa_is_upper_bound") else "")
    rate = result.get("equivalent_msaa")
    if rate is None:
        return "does not converge"
    return bound + (f"{rate:.0f}" if rate >= 100 else f"{rate:.3g}")


def main(folders):
    has_names = folders[:1] == ["--names"]
    folders = folders[has_names:]
    if not folders:
        sys.exit(__doc__.strip())
    for folder in folders:
        path = pathlib.Path(folder) / "report.json"
        if not path.exists():
            sys.exit(f"{path}: expected a comparison, found no such file")
        report = json.loads(path.read_text(encoding="utf-8"))
        print_head("technique", *["what it is"] * has_names, "bytes on chip", "bytes off chip", "RMSE × 1000", "bias × 1000", "EMR")
        for result in report["results"]:
            if result["technique"] == "reference":
                continue
            print_row(f"`{result['technique']}`", *[name_of(result["technique"])] * has_names,
                      *(f"{result[f'{place}_chip_bytes_per_pixel']:.0f}" for place in ("on", "off")),
                      f"{1000 * result['error']['rmse']:.2f}", f"{1000 * result['error']['bias']:+.2f}", emr(result))


if __name__ == "__main__":
    main(sys.argv[1:])
