"""beampipe from Python: renders traces, measures and explains errors, and reads what the program writes.

  trace = beampipe.make("fence", triangles=3000)          # or open_trace("fence.json"), trace_from_arrays(...)
  picture = beampipe.render(trace, "beam", pool=60).picture   # height x width x 3, linear RGB, row 0 on top
  found = beampipe.compare(trace, ["beam", "msaa:8"])
  print(found.table())                                    # errors and equivalent MSAA rates
  print(beampipe.inspect(trace, "beam", 160, 90))         # what happened in a pixel

`compare` also takes techniques of your own (functions), rules that merge fragments (Merge), sample patterns (Pattern)
and metrics (functions). `program` is the command line with such techniques. Rendering lets other Python threads run, and
Ctrl-C ends it.

  report = beampipe.Report("out")                         # of `beampipe run` or `beampipe compare`
  report["beam"]["error"]["rmse"]
  beampipe.read_exr("out/beam/frame_0000.exr"), beampipe.read_table("sweep/table.csv")

Errors are beampipe.Error, with one line that names what was wrong and what was expected.
"""
from importlib.util import find_spec

from .results import Error, Exr, Rate, Report, read_exr, read_table

__all__ = ["Error", "Exr", "Rate", "Report", "read_exr", "read_table"]

if find_spec(f"{__name__}._native"):  # without it, the package reads results
    from . import _native, measures
    from ._native import Trace
    from .comparing import Comparison, Result, compare, equivalent_rate
    from .own import Merge, program
    from .rendering import Inspection, Pattern, Rendering, inspect, reference, render, spec, techniques
    from .traces import make, open_trace, scenes, trace_from_arrays

    __version__: str = _native.version
    __all__ += ["Comparison", "Inspection", "Merge", "Pattern", "Rendering", "Result", "Trace", "compare",
                "equivalent_rate", "inspect", "make", "measures", "open_trace", "program", "reference", "render",
                "scenes", "spec", "techniques", "trace_from_arrays"]


def __getattr__(name: str):
    raise AttributeError(f"beampipe.{name}: there is no such name" +
                         ("" if "_native" in globals() else ", or it needs the compiled module, which is not here"))
