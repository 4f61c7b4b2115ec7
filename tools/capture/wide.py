"""Lines and points as triangles that cover the pixels that a rasterizer gives them.

Sources: OpenGL 4.6, sections 14.4 and 14.5; Vulkan 1.3, sections 28.9 and 28.10; Mesa 22.3 where these leave a choice:
lines that are not rectangular take whole pixels, those whose centres they pass, `width` of them on the minor axis, also
where pixels have more samples. (Where they do, Mesa takes what lines and points carry half a pixel beside the place. That
is an error, which is not made again here.) Windows have y down, and pixels have their centres at halves."""
import numpy as np

_TINY = 1e-20  # w below this is behind the eye


class Window:
    """Where clip positions lie in the picture. `viewport`: x, y, width, height as Vulkan has them."""

    def __init__(self, viewport):
        x, y, width, height = viewport
        self.half = np.array([width / 2, height / 2])
        self.middle = np.array([x, y]) + self.half

    def places(self, clip):
        return np.float64(clip[:, :2] / clip[:, 3:]) * self.half + self.middle

    def moved(self, clip, places):
        """Clip positions with the same depth at other places."""
        clip = clip.copy()
        clip[:, :2] = (places - self.middle) / self.half * clip[:, 3:]
        return clip


class Ends:
    """Both ends of lines: `clip` is 2 x n x 4 float64, `varyings` 2 x n x components uint32, bits of floats where
    `mixes` is set; others are those of the first end everywhere."""

    def __init__(self, clip, varyings, pairs, mixes):
        self.clip = np.float64(clip[pairs.T])
        self.varyings, self.mixes = varyings[pairs.T], np.asarray(mixes, bool)
        self.varyings[1][:, ~self.mixes] = self.varyings[0][:, ~self.mixes]

    def only(self, kept):
        self.clip, self.varyings = self.clip[:, kept], self.varyings[:, kept]

    def at(self, lines, shares):
        """(clip, varyings) at shares of clip space between the ends of lines with these numbers."""
        share = shares[:, None]
        clip = self.clip[0, lines] + (self.clip[1, lines] - self.clip[0, lines]) * share
        first, last = (np.ascontiguousarray(end[lines]) for end in self.varyings)
        with np.errstate(invalid="ignore", over="ignore"):  # bits of integers are no numbers
            a, b = first.view("<f4").astype(np.float64), last.view("<f4").astype(np.float64)
            mixed = (a + (b - a) * share).astype("<f4").view("<u4")
        return clip, np.where(self.mixes & (first != last), mixed, first)

    def cut(self, distances):
        """Keeps what has no negative distance to a plane; `distances`: 2 x n x planes."""
        begin, end = np.zeros(self.clip.shape[1]), np.ones(self.clip.shape[1])
        for a, b in zip(distances[0].T, distances[1].T):
            with np.errstate(divide="ignore", invalid="ignore"):
                share = a / (a - b)
            begin = np.where((a < 0) & (b >= 0), np.maximum(begin, share), begin)
            end = np.where((a >= 0) & (b < 0), np.minimum(end, share), end)
            end = np.where((a < 0) & (b < 0), -1, end)
        kept = np.flatnonzero(begin < end)
        parts = [self.at(kept, shares[kept]) for shares in (begin, end)]
        self.clip, self.varyings = (np.stack([part[k] for part in parts]) for k in (0, 1))


def _quads(window, corners, front_ccw):
    """(clip, varyings, triangles) of quads whose four corners are (clip, varyings, places), turned to the front."""
    count = len(corners[0][0])
    clip = np.stack([window.moved(clip, places) for clip, _, places in corners], 1).reshape(-1, 4)
    varyings = np.stack([varyings for _, varyings, _ in corners], 1).reshape(4 * count, corners[0][1].shape[1])
    first, second, third = (places for _, _, places in corners[:3])
    (ax, ay), (bx, by) = (second - first).T, (third - first).T
    is_ccw = ax * by - ay * bx < 0  # as one sees it: y is down
    orders = np.where((is_ccw == front_ccw)[:, None], [[0, 1, 2, 0, 2, 3]], [[0, 2, 1, 0, 3, 2]])
    return clip, varyings, (orders + 4 * np.arange(count)[:, None]).reshape(-1, 3)


def _clip_share(ends, lines, shares):
    """Shares of clip space for shares of the picture."""
    near, far = ends.clip[0, lines, 3] * shares, ends.clip[1, lines, 3] * (1 - shares)
    return near / np.maximum(near + far, _TINY)


def _strips(window, ends, lines, shares, places, sides, front_ccw):
    """Quads along lines, from shares[0] to shares[1] of the picture with centres at places[0] and places[1], and `sides`
    to both sides."""
    found = [ends.at(lines, _clip_share(ends, lines, share)) for share in shares]
    return _quads(window, [(*found[0], places[0] - sides), (*found[1], places[1] - sides),
                           (*found[1], places[1] + sides), (*found[0], places[0] + sides)], front_ccw)


def _turned(values, is_x_major):
    """Between x, y and the major axis, the minor one."""
    return np.where(is_x_major[:, None], values, values[:, ::-1])


def _cells(window, ends, start, delta, shares, is_x_major, width, front_ccw):
    """A quad of whole pixels for each step along the major axis."""
    start, delta = _turned(start, is_x_major), _turned(delta, is_x_major)  # the major axis first
    reach = np.sort(start[:, 0] + delta[:, 0] * np.stack(shares), 0)
    first, last = (np.ceil(bound - 0.5).astype(np.int64) for bound in reach)  # centres in [reach[0], reach[1])
    steps = np.maximum(last - first, 0)
    lines = np.repeat(np.arange(len(steps)), steps)
    major = first[lines] + np.arange(steps.sum()) - np.repeat(np.cumsum(steps) - steps, steps)
    start, delta, is_x_major = start[lines], delta[lines], is_x_major[lines]
    share_at = lambda place: (place - start[:, 0]) / delta[:, 0]
    minor = start[:, 1] + delta[:, 1] * share_at(major + 0.5)
    middle = np.ceil(minor - width / 2 - 0.5) + width / 2
    places = [_turned(np.stack([major + k, middle], 1), is_x_major) for k in (0.0, 1.0)]
    sides = _turned(np.tile([0.0, width / 2], (len(lines), 1)), is_x_major)
    return _strips(window, ends, lines, [share_at(major + k) for k in (0.0, 1.0)], places, sides, front_ccw)


def lines_as_triangles(ends, window, width, is_rectangular, has_samples, front_ccw):
    """(clip, varyings, triangles) of lines whose ends are in front of the eye."""
    start, stop = (np.rint(window.places(clip) * 256) / 256 for clip in ends.clip)
    ends.only(np.flatnonzero((start != stop).any(1)))
    start, stop = (np.rint(window.places(clip) * 256) / 256 for clip in ends.clip)
    delta, lines = stop - start, np.arange(len(start))
    if is_rectangular:
        sides = delta[:, ::-1] * [-1, 1] * (width / 2 / np.linalg.norm(delta, axis=1, keepdims=True))
        return _strips(window, ends, lines, [np.zeros(len(lines)), np.ones(len(lines))], [start, stop], sides, front_ccw)
    width = max(1.0, np.floor(width + 0.5))
    is_x_major = np.abs(delta[:, 0]) >= np.abs(delta[:, 1])
    axis = np.where(is_x_major, 0, 1)
    along = delta[lines, axis]
    shares = []
    # A line has the pixel that it starts in if it starts in the diamond between the middles of its sides, and does not
    # have the one that it ends in if it ends there: the end goes to the pixel's side that it came from.
    for share, end in ((0.0, start), (1.0, stop)):
        is_inside = np.abs(end - np.floor(end) - 0.5).sum(1) < 0.5
        side = np.floor(end[lines, axis]) + 0.5 - np.sign(along) / 2
        shares.append(np.where(is_inside, (side - start[lines, axis]) / along, share))
    if has_samples:
        return _cells(window, ends, start, delta, shares, is_x_major, width, front_ccw)
    sides = _turned(np.tile([0.0, width / 2], (len(lines), 1)), is_x_major)
    places = [start + delta * share[:, None] for share in shares]
    return _strips(window, ends, lines, shares, places, sides, front_ccw)


def points_as_triangles(clip, varyings, sizes, window, front_ccw):
    """(clip, varyings, triangles, coordinates) of squares around points that are in front of the eye. `coordinates`: of
    each vertex, what a fragment shader reads as gl_PointCoord."""
    steps = np.maximum(256, np.rint(np.float64(sizes) * 256))
    low = np.rint(window.places(clip) * 256) - np.floor(steps / 2)[:, None]
    offsets = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    corners = [(np.float64(clip), varyings, (low + steps[:, None] * offset) / 256) for offset in offsets]
    return *_quads(window, corners, front_ccw), np.tile(offsets.astype(np.float32), (len(clip), 1))


def planes_of(clip, z_from_0, clips_depth):
    """Distances (... x planes) to the planes that cut lines and points off: the eye's and those of depth."""
    z, w = clip[..., 2], clip[..., 3]
    planes = [w - _TINY]
    if clips_depth:
        planes += [z if z_from_0 else z + w, w - z]
    return np.stack(planes, -1)
