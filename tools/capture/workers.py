"""Replays a capture in several processes, each of which reads its share of the draws."""
import json
import os
import pickle
import subprocess
import sys
import time

from failure import Failure

def _result(path):
    if not os.path.exists(path):
        return None
    with open(path, "rb") as file:
        return pickle.load(file)


def _lines(path):
    with open(path, "rb") as file:
        text = file.read().decode(errors="replace").strip().splitlines()
    return f": {text[-1]}" if text else ""


def extract(processes, capture, folder, display, target, jobs, progress, deadline, pictures_only=False):
    """(pictures, draws in order) of a capture, as extract.py leaves them. `folder` must be new."""
    os.makedirs(folder, exist_ok=True)
    workers = []
    tasks = [("after", 0), ("before", 0)] + ([] if pictures_only else [(None, share) for share in range(jobs)])
    for pictures, share in tasks:
        stem = os.path.join(folder, pictures or f"draws{share}")
        with open(stem + ".json", "w") as file:
            json.dump({"capture": capture, "folder": folder, "share": share, "shares": jobs, "pictures": pictures,
                       "target": target}, file)
        environment = {**os.environ, "DISPLAY": display}
        with open(stem + ".log", "wb") as log:
            process = processes.start([sys.executable, "-B", os.path.join(os.path.dirname(__file__), "extract.py"),
                                       stem + ".json"], env=environment, stdin=subprocess.DEVNULL, stdout=log,
                                      stderr=log)
        workers.append((process, stem))
    pictures, total = None, ""
    while any(process.poll() is None for process, _ in workers):
        done = sum(os.path.getsize(stem + ".count") for _, stem in workers if os.path.exists(stem + ".count"))
        if pictures is None and workers[0][0].poll() is not None:
            pictures = _result(workers[0][1] + ".pickle")
            total = f" of {len(pictures['events'])}" if isinstance(pictures, dict) else ""
        progress.show(f"reading draw {done}{total}")
        if time.monotonic() > deadline:
            raise Failure("the capture was not read within the time limit (see --timeout)")
        if any(process.poll() not in (None, 0) for process, _ in workers):
            break
        time.sleep(0.05)
    results = []
    for process, stem in workers:
        if process.poll() is None and any(other.poll() not in (None, 0) for other, _ in workers):
            processes.end(process)
            continue
        is_loaded = process is workers[0][0] and pictures is not None
        result = pictures if is_loaded else _result(stem + ".pickle")
        if isinstance(result, str):
            raise Failure(result)
        if result is None:
            raise Failure(f"RenderDoc could not replay the capture (exit code {process.poll()}){_lines(stem + '.log')}")
        results.append(result)
    if len(results) < len(workers):
        raise Failure("RenderDoc could not replay the capture")
    draws = [None] * sum(len(result) for result in results[2:])
    for share, result in enumerate(results[2:]):
        draws[share::jobs] = result
    return {**results[0], **results[1]}, draws
