"""Primitives from what a graphics API draws: lists, strips and fans, vertices shared again, user clip planes.
The first corner of a primitive is its provoking vertex, which gives it its flat inputs (Vulkan 1.3, section 21.1).

Positions are clip positions, n x 4 float32; triangles are m x 3 indices. Nothing here knows RenderDoc."""
import numpy as np


def split_at_restart(indices, restart):
    """The runs of indices between restart indices; `restart` is None where there is no restart index."""
    if restart is None:
        return [indices]
    runs = np.split(indices, np.flatnonzero(indices == restart))
    return [runs[0]] + [run[1:] for run in runs[1:]]


def _list(run):
    return run[: len(run) // 3 * 3].reshape(-1, 3)


def _strip(run):
    triangles = np.stack([run[:-2], run[1:-1], run[2:]], 1)
    triangles[1::2] = triangles[1::2][:, [0, 2, 1]]  # every second triangle of a strip turns the other way
    return triangles


def _fan(run):
    return np.stack([run[1:-1], run[2:], np.full(len(run) - 2, run[0])], 1)


def _list_with_neighbours(run):
    return run[: len(run) // 6 * 6].reshape(-1, 6)[:, ::2]


def _points(run):
    return run.reshape(-1, 1)


def _line_list(run):
    return run[: len(run) // 2 * 2].reshape(-1, 2)


def _line_strip(run):
    return np.stack([run[:-1], run[1:]], 1)


def _line_list_with_neighbours(run):
    return run[: len(run) // 4 * 4].reshape(-1, 4)[:, 1:3]


def _line_strip_with_neighbours(run):
    return _line_strip(run[1:-1])


# With how many corners a primitive has.
_SHAPES = {"PointList": (1, _points), "LineList": (2, _line_list), "LineStrip": (2, _line_strip),
           "LineList_Adj": (2, _line_list_with_neighbours), "LineStrip_Adj": (2, _line_strip_with_neighbours),
           "TriangleList": (3, _list), "TriangleStrip": (3, _strip), "TriangleFan": (3, _fan),
           "TriangleList_Adj": (3, _list_with_neighbours)}


def corners_of(topology, indices, restart=None):
    """The corners of points, lines or triangles, n x 1, 2 or 3 indices; None for other topologies (patches).

    `topology` is the name of RenderDoc's topology. Incomplete primitives at the end of a run are left out, as in the
    APIs."""
    if topology not in _SHAPES:
        return None
    corners, shape = _SHAPES[topology]
    parts = [shape(run) for run in split_at_restart(indices, restart) if len(run) >= corners]
    return np.concatenate(parts) if parts else np.zeros((0, corners), indices.dtype)


def primitives_of(topology, count):
    """How many points, lines or triangles so many vertices are, roughly: for reports of what is left out."""
    if topology.startswith("Point"):
        return count
    if topology.startswith("LineList"):
        return count // 2
    if topology.startswith("Line"):
        return max(0, count - 1)
    return count // 3


def weld(columns, triangles):
    """Shares vertices that are identical, bit for bit, in all of `columns` (arrays with a row per vertex).

    Returns the columns without duplicates and without vertices that no triangle uses, in the order of their first
    use; the triangles without those that have two equal corners; and which triangles these are."""
    used = triangles.ravel()
    if not len(used):
        return [column[:0] for column in columns], triangles, np.zeros(0, np.int64)
    # -0 and 0 are the same number. Adding 0 makes them the same bits.
    rows = np.concatenate([np.ascontiguousarray(column[used] + column.dtype.type(0)).view(np.uint8).reshape(
        len(used), -1) for column in columns], 1)
    keys = rows.view(np.dtype((np.void, rows.shape[1]))).ravel()
    _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
    corners = inverse.reshape(-1, 3)
    kept = ((corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2]) & (corners[:, 2] != corners[:, 0]))
    corners = corners[kept]
    live, first_use = np.unique(corners.ravel(), return_index=True)
    live = live[np.argsort(first_use, kind="stable")]
    place = np.zeros(len(first), np.int64)
    place[live] = np.arange(len(live))
    vertices = used[first[live]]
    return [column[vertices] for column in columns], place[corners], np.flatnonzero(kept)


def clip_to_planes(columns, triangles, distances):
    """Cuts triangles where one of the vertices' clip distances (n x planes) is negative.

    Returns columns with the new vertices appended, and the triangles of what is left."""
    for plane in range(distances.shape[1]):
        distance = distances[:, plane]
        inside = distance[triangles] >= 0
        whole = inside.all(1)
        cut = np.flatnonzero(inside.any(1) & ~whole)
        extra, corners, count = [], [], len(distance)
        for t in triangles[cut]:
            polygon = []
            for a, b in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0])):
                if distance[a] >= 0:
                    polygon.append(a)
                if (distance[a] >= 0) != (distance[b] >= 0):
                    # From the lower index to the higher, so that both triangles at an edge get the same vertex.
                    low, high = min(a, b), max(a, b)
                    extra.append((low, high, distance[low] / (distance[low] - distance[high])))
                    polygon.append(count + len(extra) - 1)
            corners += [(polygon[0], polygon[k], polygon[k + 1]) for k in range(1, len(polygon) - 1)]
        triangles = np.concatenate([triangles[whole], np.array(corners, np.int64).reshape(-1, 3)])
        if extra:
            low, high = (np.array([e[k] for e in extra]) for k in (0, 1))
            share = np.array([e[2] for e in extra])[:, None]
            grow = lambda values: np.concatenate(
                [values, (values[low] + (values[high] - values[low]) * share).astype(values.dtype)])
            columns, distances = [grow(column) for column in columns], grow(distances)
            distances[count:, plane] = 0
    return columns, triangles
