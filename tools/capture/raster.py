"""A small rasterizer in numpy: which triangle of a captured frame owns which pixel, and its depth buffer.

It follows the APIs' rules for one sample per pixel: snapped to 1/256 pixel, the top-left rule, depth and stencil tests
in the order of the draws. It is as exact as captured depths let one check; beampipe's own rasterizers are not used."""
import numpy as np

SUBPIXELS = 256
GUARD = 16.0  # triangles farther outside than so many times the viewport's half width are cut, to keep numbers small
CHUNK = 1 << 21  # fragments that are worked on at once

# Where sample 0 of a pixel is, by the number of samples: the APIs' standard positions.
SAMPLE_0 = {1: (0.5, 0.5), 2: (0.75, 0.75), 4: (0.375, 0.125), 8: (0.5625, 0.3125), 16: (0.5625, 0.5625)}

_TESTS = {"never": lambda a, b: np.zeros(np.shape(a), bool), "always": lambda a, b: np.ones(np.shape(a), bool),
          "less": np.less, "less_equal": np.less_equal, "greater": np.greater, "greater_equal": np.greater_equal,
          "equal": np.equal, "not_equal": np.not_equal}


class Target:
    """What is drawn to: depth, stencil, and for each pixel the number of the last triangle that coloured it (-1: none);
    `solid` is the last one that did not blend, and `front` the last one that wrote depth.

    `levels`: the steps of an integer depth format, or None. `sample`: where in the pixel is looked."""

    def __init__(self, width, height, depth, levels=None, samples=1):
        self.width, self.height, self.levels = width, height, levels
        self.sample = SAMPLE_0.get(samples, SAMPLE_0[1])
        self.depth = (np.ones(width * height) if depth is None else depth.astype(np.float64).ravel().copy())
        self.stencil = np.zeros(width * height, np.int64)
        self.owner = np.full(width * height, -1, np.int64)
        self.solid, self.front = self.owner.copy(), self.owner.copy()
        self.touched = np.zeros(width * height, bool)


class Fragments:
    """`pixel` (row * width + column), `triangle` and `depth` of each fragment, in the order of triangles."""

    def __init__(self, pixel, triangle, depth, front):
        self.pixel, self.triangle, self.depth, self.front = pixel, triangle, depth, front

    def where(self, keep):
        return Fragments(self.pixel[keep], self.triangle[keep], self.depth[keep], self.front[keep])


def window_of(state, width, height):
    """(x, y, width, height) of the viewport."""
    return state.get("viewport", [0, 0, width, height])


def _planes(depth_clip):
    planes = [np.array([0, 0, 0, 1.0])]  # w, compared with a tiny number
    if depth_clip:
        planes += [np.array([0, 0, 1.0, 1.0]), np.array([0, 0, -1.0, 1.0])]
    planes += [np.array([s, 0, 0, GUARD]) for s in (1.0, -1.0)] + [np.array([0, s, 0, GUARD]) for s in (1.0, -1.0)]
    return planes


def _cut(polygon, plane, least):
    distance = polygon @ plane - least
    if (distance >= 0).all():
        return polygon
    out = []
    for i in range(len(polygon)):
        j = (i + 1) % len(polygon)
        if distance[i] >= 0:
            out.append(polygon[i])
        if (distance[i] >= 0) != (distance[j] >= 0):
            t = distance[i] / (distance[i] - distance[j])
            out.append(polygon[i] + (polygon[j] - polygon[i]) * t)
    return np.array(out).reshape(-1, 4)


def clipped(corners, depth_clip=True):
    """Triangles (m x 3 x 4 clip positions) within the frustum, and which of the given ones each is part of."""
    w = corners[..., 3]
    outside = np.zeros(len(corners), bool)
    for axis, sign in ((0, 1), (0, -1), (1, 1), (1, -1)) + (((2, 1), (2, -1)) if depth_clip else ()):
        outside |= (sign * corners[..., axis] > w).all(1)
    outside |= (w <= 0).all(1)
    near = _planes(depth_clip)
    whole = ~outside
    for index, plane in enumerate(near):
        whole &= (corners @ plane > (1e-6 if index == 0 else -1e-12)).all(1)
    parts, origin = [corners[whole]], [np.flatnonzero(whole)]
    for t in np.flatnonzero(~outside & ~whole):
        polygon = corners[t]
        for index, plane in enumerate(near):
            polygon = _cut(polygon, plane, 1e-6 if index == 0 else 0)
            if len(polygon) < 3:
                break
        if len(polygon) >= 3:
            fan = np.stack([np.stack([polygon[0], polygon[k], polygon[k + 1]]) for k in range(1, len(polygon) - 1)])
            parts.append(fan)
            origin.append(np.full(len(fan), t))
    corners, origin = np.concatenate(parts), np.concatenate(origin)
    order = np.argsort(origin, kind="stable")
    return corners[order], origin[order]


def _bounds(state, width, height):
    """The pixels [x0, x1) x [y0, y1) that viewport and scissor leave."""
    x, y, w, h = window_of(state, width, height)
    x0, x1 = sorted((x, x + w))
    y0, y1 = sorted((y, y + h))
    x0, y0 = max(0, int(np.ceil(x0 - 0.5))), max(0, int(np.ceil(y0 - 0.5)))
    x1, y1 = min(width, int(np.ceil(x1 - 0.5))), min(height, int(np.ceil(y1 - 0.5)))
    if "scissor" in state:
        sx, sy, sw, sh = state["scissor"]
        x0, y0, x1, y1 = max(x0, sx), max(y0, sy), min(x1, sx + sw), min(y1, sy + sh)
    return x0, y0, x1, y1


def _spans(X, Y, sample, bounds):
    """For triangles in fixed point with positive area: (triangle, row, first column, last column) of each row."""
    x0, y0, x1, y1 = bounds
    cx, cy = (int(round(s * SUBPIXELS)) for s in sample)
    low = np.maximum(y0, -((cy - Y.min(1)) // SUBPIXELS))
    high = np.minimum(y1 - 1, (Y.max(1) - cy) // SUBPIXELS)
    rows = np.maximum(0, high - low + 1)
    triangle = np.repeat(np.arange(len(X)), rows)
    row = np.arange(len(triangle)) - np.repeat(np.cumsum(rows) - rows, rows) + np.repeat(low, rows)
    center = row * SUBPIXELS + cy
    first = np.full(len(row), x0, np.int64)
    last = np.full(len(row), x1 - 1, np.int64)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        xa, ya = X[triangle, a], Y[triangle, a]
        dx, dy = X[triangle, b] - xa, Y[triangle, b] - ya
        top_left = (dy < 0) | ((dy == 0) & (dx > 0))
        n = dx * (center - ya) - np.where(top_left, 0, 1)  # inside where dy * (column's center - xa) <= n
        divisor = np.where(dy == 0, 1, np.abs(dy))
        quotient = n // divisor
        right = np.where(dy > 0, (xa + quotient - cx) // SUBPIXELS, x1 - 1)
        left = np.where(dy < 0, -((cx - (xa - quotient)) // SUBPIXELS), x0)
        empty = (dy == 0) & (n < 0)
        last = np.where(empty, -1, np.minimum(last, right))
        first = np.maximum(first, left)
    keep = first <= last
    return triangle[keep], row[keep], first[keep], last[keep]


def fragments_of(clip, triangles, state, cull, target):
    """Yields Fragments of a draw, in order, in chunks."""
    corners, origin = clipped(clip.astype(np.float64)[triangles], state.get("depth_clip", True))
    if not len(corners):
        return
    width, height = target.width, target.height
    vx, vy, vw, vh = window_of(state, width, height)
    near, far = state.get("depth_range", [0, 1])
    w = corners[..., 3]
    X = np.rint((vx + vw * (1 + corners[..., 0] / w) / 2) * SUBPIXELS).astype(np.int64)
    Y = np.rint((vy + vh * (1 - corners[..., 1] / w) / 2) * SUBPIXELS).astype(np.int64)
    D = near + (far - near) * (corners[..., 2] / w + 1) / 2
    area = (X[:, 1] - X[:, 0]) * (Y[:, 2] - Y[:, 0]) - (X[:, 2] - X[:, 0]) * (Y[:, 1] - Y[:, 0])
    front = (area < 0) == (state.get("front_face", "counter_clockwise") == "counter_clockwise")
    keep = (area != 0) & ((cull == "none") | (front == (cull == "back")))
    X, Y, D, area, origin, front = X[keep], Y[keep], D[keep], area[keep], origin[keep], front[keep]
    turned = area < 0
    for values in (X, Y, D):
        values[turned] = values[turned][:, [0, 2, 1]]
    area = np.abs(area).astype(np.float64)
    x, y = X / SUBPIXELS, Y / SUBPIXELS
    area /= SUBPIXELS**2
    d1, d2 = D[:, 1] - D[:, 0], D[:, 2] - D[:, 0]
    gx = (d1 * (y[:, 2] - y[:, 0]) - d2 * (y[:, 1] - y[:, 0])) / area
    gy = (d2 * (x[:, 1] - x[:, 0]) - d1 * (x[:, 2] - x[:, 0])) / area
    bias = state.get("depth_bias")
    offset = np.zeros(len(X))
    if bias:
        offset = bias["constant"] + bias["slope"] * np.maximum(np.abs(gx), np.abs(gy))
        if bias["clamp"] > 0:
            offset = np.minimum(offset, bias["clamp"])
        elif bias["clamp"] < 0:
            offset = np.maximum(offset, bias["clamp"])
    triangle, row, first, last = _spans(X, Y, target.sample, _bounds(state, width, height))
    lengths = last - first + 1
    ends = np.cumsum(lengths)
    start = 0
    while start < len(triangle):
        done = ends[start - 1] if start else 0
        stop = max(start + 1, int(np.searchsorted(ends, done + CHUNK, "right")))
        count = lengths[start:stop]
        t = np.repeat(triangle[start:stop], count)
        r = np.repeat(row[start:stop], count)
        column = np.arange(len(t)) - np.repeat(ends[start:stop] - count - done, count)
        column += np.repeat(first[start:stop], count)
        z = (D[t, 0] + gx[t] * (column + target.sample[0] - x[t, 0]) + gy[t] * (r + target.sample[1] - y[t, 0])
             + offset[t])
        z = np.clip(z, min(near, far) if not state.get("depth_clip", True) else 0,
                    max(near, far) if not state.get("depth_clip", True) else 1)
        if target.levels:
            z = np.rint(z * target.levels) / target.levels
        yield Fragments(r * width + column, origin[t], z, front[t])
        start = stop


def _stencil_after(operation, value, reference):
    return {"keep": lambda: value, "zero": lambda: np.zeros_like(value),
            "replace": lambda: np.full_like(value, reference), "increment": lambda: np.minimum(value + 1, 255),
            "decrement": lambda: np.maximum(value - 1, 0), "invert": lambda: value ^ 255,
            "increment_wrap": lambda: value + 1 & 255, "decrement_wrap": lambda: value - 1 & 255}[operation]()


def draw(target, fragments, state, first_number):
    """Tests and writes the fragments in their order; `first_number` is the number of the draw's triangle 0."""
    test = _TESTS[state.get("depth_function", "less") if state.get("depth_test", True) else "always"]
    writes = state.get("depth_write", True) and state.get("depth_test", True)
    colors = state.get("color_mask", "rgba") not in ("", "a")
    stencil = state.get("stencil")
    order = np.argsort(fragments.pixel, kind="stable")
    pixel, depth = fragments.pixel[order], fragments.depth[order]
    number = fragments.triangle[order] + first_number
    starts = np.flatnonzero(np.diff(pixel, prepend=-1))
    lengths = np.diff(np.append(starts, len(pixel)))
    layer = 0
    while len(starts):  # the first fragment of each pixel, then the second...
        at = starts + layer
        p, z = pixel[at], depth[at]
        alive = np.ones(len(p), bool)
        if stencil:
            old = target.stencil[p]
            alive = _TESTS[stencil["function"]](stencil["reference"] & stencil["mask"], old & stencil["mask"])
        passed = alive & test(z, target.depth[p])
        if stencil:
            reference, mask = stencil["reference"], stencil["write_mask"]
            new = np.where(passed, _stencil_after(stencil["pass"], old, reference), np.where(
                alive, _stencil_after(stencil["depth_fail"], old, reference),
                _stencil_after(stencil["fail"], old, reference)))
            target.stencil[p] = (old & ~mask) | (new & mask)
        if writes:
            target.depth[p[passed]] = z[passed]
            target.front[p[passed]] = number[at][passed]
        if colors:
            target.owner[p[passed]] = number[at][passed]
            if "blend" not in state:
                target.solid[p[passed]] = number[at][passed]
        target.touched[p[passed]] = True
        layer += 1
        more = lengths > layer
        starts, lengths = starts[more], lengths[more]


def weights_at(clip, triangles, triangle, x, y, viewport):
    """Perspective-correct weights (n x 3) of the corners of triangles `triangle` at picture coordinates x, y."""
    corners = clip.astype(np.float64)[triangles[triangle]]
    vx, vy, vw, vh = viewport
    w = corners[..., 3]
    home = np.stack([vx * w + vw * (w + corners[..., 0]) / 2, vy * w + vh * (w - corners[..., 1]) / 2, w], -1)
    point = np.stack([x, y, np.ones(len(x))], -1)
    parts = [(np.cross(home[:, (k + 1) % 3], home[:, (k + 2) % 3]) * point).sum(1) for k in range(3)]
    total = parts[0] + parts[1] + parts[2]
    total = np.where(total == 0, 1, total)
    return np.stack([part / total for part in parts], 1)
