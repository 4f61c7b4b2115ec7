"""Where the colours of a captured frame's triangles come from. The program's shaders are not run.

For each draw, simple explanations are tried: a bound texture, the vertices' colours, their product. An explanation is
kept if it predicts the captured picture where the draw can be seen. All other triangles take their colour from the
captured picture."""
import dataclasses
import itertools

import numpy as np

import raster
import srgb

MOST_ERROR = 4 / 255  # what an explanation may typically differ by, in sRGB-encoded units
PIXELS_PER_DRAW = 256  # that an explanation is tried on
PIXELS_FOR_LIGHT = 50000  # of a draw, from which light at its vertices is found
FEW = 8  # pixels that are too few to judge by


class Look:
    """A texture (binding), its coordinates and the vertices' colours, each by name or None. `constant`: a linear RGB
    factor. `light`: colours of vertices that come from the picture, n x 3, sRGB-encoded, in place of `color`.
    `mixes`: whether a draw that blends still does; not where its colours are what blending has made."""

    def __init__(self, slot, uv, color, constant=None, verified=True, light=None, mixes=True):
        self.slot, self.uv, self.color, self.constant, self.verified = slot, uv, color, constant, verified
        self.light, self.mixes = light, mixes


class AlphaTest:
    """Fragments whose opacity in texture `slot` at `uv` is below the cutoff are not there."""

    def __init__(self, slot, uv, cutoff):
        self.slot, self.uv, self.cutoff = slot, uv, cutoff


@dataclasses.dataclass
class Points:
    """Points of a picture of this size (width, height), each on a triangle of a draw."""
    triangle: np.ndarray
    x: np.ndarray
    y: np.ndarray
    size: tuple

    @classmethod
    def of_pixels(cls, triangle, pixel, size):
        """The pixels' centres. `pixel`: row * width + column."""
        return cls(triangle, pixel % size[0] + 0.5, pixel // size[0] + 0.5, size)

    def where(self, keep):
        return Points(self.triangle[keep], self.x[keep], self.y[keep], self.size)

    def moved(self, dx, dy):
        return Points(self.triangle, self.x + dx, self.y + dy, self.size)

    def __len__(self):
        return len(self.x)

    def weights(self, draw):
        """Those of the triangles' corners (n x 3)."""
        return raster.weights_at(draw.clip, draw.triangles, self.triangle, self.x, self.y,
                                 raster.window_of(draw.state, *self.size))


def _varying(draw, name, points):
    corners = draw.attributes[name][draw.triangles[points.triangle]].astype(np.float64)
    return (points.weights(draw)[..., None] * corners).sum(1)


def _look_up(draw, texture, uv_name, points):
    """RGBA of a texture at the points."""
    at = lambda dx, dy: _varying(draw, uv_name, points.moved(dx, dy))[:, :2]
    uv = at(0, 0)
    scale = np.array([texture.texels.shape[1], texture.texels.shape[0]])
    steps = [np.linalg.norm((at(*step) - uv) * scale, axis=1) for step in ((1, 0), (0, 1))]
    return texture.look_up(uv, np.maximum(*steps))


def _uv_names(draw):
    return [name for name, values in draw.attributes.items() if values.shape[1] >= 2][:6]


def _color_names(draw):
    return [name for name, values in draw.attributes.items() if values.shape[1] >= 3 and
            (values[:, :3] > -1e-3).all() and (values[:, :3] < 1.001).all()][:4]


def opacity(draw, fragments, textures, size):
    """The opacity that the draw's alpha test looks at, for each fragment."""
    texture = textures.get(draw.textures[draw.alpha_test.slot])
    points = Points.of_pixels(fragments.triangle, fragments.pixel, size)
    return _look_up(draw, texture, draw.alpha_test.uv, points)[:, 3]


def best_cutoff(alpha, kept):
    """(cutoff, share of wrong fragments): the threshold that best separates fragments that were kept from those that
    were not. 0.5 where it is as good as any."""
    order = np.argsort(alpha, kind="stable")
    alpha, kept = alpha[order], kept[order]
    # With the cutoff between element i - 1 and i: kept ones below it and discarded ones above it are wrong.
    wrong = np.concatenate([[0], np.cumsum(kept)]) + np.concatenate([np.cumsum(~kept[::-1])[::-1], [0]])
    possible = np.concatenate([[True], np.diff(alpha) > 0, [True]])
    wrong = np.where(possible, wrong, len(alpha) + 1)
    low = np.concatenate([[0.0], alpha])
    high = np.concatenate([alpha, [1.0]])
    best = np.flatnonzero(wrong == wrong.min())
    middle = best[(low[best] <= 0.5) & (0.5 <= high[best])]
    if len(middle):
        return 0.5, wrong.min() / len(alpha)
    at = best[np.argmin(np.abs((low[best] + high[best]) / 2 - 0.5))]
    return float((low[at] + high[at]) / 2), wrong.min() / len(alpha)


def find_alpha_tests(frame, textures):
    """Sets the alpha test of draws whose fragment shader can discard, where the captured depth shows one."""
    if frame.depth is None:
        return
    size = (frame.width, frame.height)
    depth = frame.depth.astype(np.float64).ravel()
    target = raster.Target(frame.width, frame.height, None, frame.levels, frame.samples)
    evidence, users = {}, {}
    for draw in frame.draws:
        if not draw.discards or not draw.state.get("depth_write", True):
            continue
        users.setdefault(draw.shader, []).append(draw)
        towards = -1 if draw.state.get("depth_function", "less").startswith("greater") else 1
        candidates = [(slot, uv) for slot, binding in enumerate(draw.textures[:4]) for uv in _uv_names(draw)
                      if textures.get(binding) is not None and textures.get(binding).has_alpha]
        for fragments in itertools.islice(
                raster.fragments_of(draw.clip, draw.triangles, draw.state, draw.cull, target), 1):
            ahead = (depth[fragments.pixel] - fragments.depth) * towards
            kept, gone = np.abs(ahead) < 1e-6, ahead > 1e-5  # nearer than what is stored: it was never written
            told = np.flatnonzero(kept | gone)
            told = told[:: max(1, len(told) // 5000)]
            fragments, kept = fragments.where(told), kept[told]
            points = Points.of_pixels(fragments.triangle, fragments.pixel, size)
            for slot, uv in candidates:
                alpha = _look_up(draw, textures.get(draw.textures[slot]), uv, points)[:, 3]
                evidence.setdefault((draw.shader, slot, uv), []).append((alpha, kept))
    best = {}
    for (shader, slot, uv), found in evidence.items():
        alpha, kept = (np.concatenate([one[k] for one in found]) for k in (0, 1))
        if not len(alpha):
            continue
        cutoff, wrong = best_cutoff(alpha, kept)
        if wrong < best.get(shader, (0.1,))[0]:
            best[shader] = (wrong, AlphaTest(slot, uv, cutoff))
    for shader, (_, test) in best.items():
        for draw in users[shader]:
            if test.slot < len(draw.textures) and test.uv in draw.attributes:
                texture = textures.get(draw.textures[test.slot])
                if texture is not None and texture.has_alpha:
                    draw.alpha_test = test


def _constant(texel, captured):
    """The RGB factor that best makes the texels what was captured, both linear; None if nothing tells."""
    bright = texel > 0.02
    if not bright.any():
        return None
    return np.array([np.median(captured[:, c][bright[:, c]] / texel[:, c][bright[:, c]]) if bright[:, c].any() else 1.0
                     for c in range(3)])


def _typical(errors):
    """The median, or a third of what four fifths of the pixels stay below if that is more: silhouettes may be off, but
    not whole faces."""
    return max(np.median(errors), np.quantile(errors, 0.8) / 3)


def _explanations(draw, textures, points, captured):
    """Yields (slot, uv, color or "constant", predicted linear RGB, opacity, constant) for all that could explain the
    captured colours (linear) of the draw at n points."""
    colors = {}
    for name in _color_names(draw):
        values = np.clip(draw.attributes[name][draw.triangles[points.triangle]].astype(np.float64), 0, 1)
        values[..., :3] = srgb.to_linear(values[..., :3])
        mixed = (points.weights(draw)[..., None] * values).sum(1)
        colors[name] = mixed[:, :3], mixed[:, 3] if mixed.shape[1] == 4 else np.ones(len(points))
        yield None, None, name, *colors[name], None
    for slot, binding in enumerate(draw.textures[:4]):
        texture = textures.get(binding)
        if texture is None:
            continue
        for uv in _uv_names(draw):
            texel = _look_up(draw, texture, uv, points)
            linear, alpha = srgb.to_linear(texel[:, :3].astype(np.float64)), texel[:, 3]
            yield slot, uv, None, linear, alpha, None
            for name, (color, opaque) in colors.items():
                if name != uv:
                    yield slot, uv, name, linear * color, alpha * opaque, None
            if len(points) >= 4 * FEW:
                factor = _constant(linear, captured)
                if factor is not None:
                    yield slot, uv, "constant", linear * factor, alpha, factor


def _same_vertices(draw):
    """For each vertex, the number of the first one that equals it in all attributes."""
    rows = np.concatenate([np.ascontiguousarray(column).view(np.uint8).reshape(len(draw.clip), -1)
                           for column in [draw.clip, *draw.attributes.values()]], 1)
    keys = np.ascontiguousarray(rows).view(np.dtype((np.void, rows.shape[1]))).ravel()
    _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
    return first[inverse]


def _least_squares(texel, weights, corners, captured, vertices, steps=16):
    """(RGB factors of the vertices, whether any of the n points sees them) so that texels (n x 3) times the factors,
    interpolated with weights (n x 3) of corners (n x 3, vertex numbers), come close to what was captured. Vertices that
    no point sees get the mean."""
    at_points = lambda values: texel * (weights[..., None] * values[corners]).sum(1)
    at_vertices = lambda values: np.stack([np.bincount(corners.ravel(), (weights * values[:, c, None]).ravel(), vertices)
                                           for c in range(3)], 1)
    below = at_vertices(texel * texel) + 1e-9
    seen = below.max(1) > 1e-6
    mean = lambda values: at_vertices(texel * values) / below
    start = np.where(seen[:, None], mean(captured), (captured * texel).sum(0) / ((texel * texel).sum(0) + 1e-9))
    # Conjugate gradients, scaled by `below`. A thousandth of that holds vertices with few points near their start.
    change = np.zeros_like(start)
    rest = np.where(seen[:, None], at_vertices(texel * (captured - at_points(start))), 0)
    towards = rest / below
    size = (rest * rest / below).sum(0)
    for _ in range(steps):
        moved = at_vertices(texel * at_points(towards)) + 0.001 * below * towards
        length = size / ((towards * moved).sum(0) + 1e-30)
        change, rest = change + length * towards, rest - length * moved
        before, size = size, (rest * rest / below).sum(0)
        towards = rest / below + size / (before + 1e-30) * towards
    return start + change, seen


def _fit_light(draw, shared, slot, uv, textures, points, captured):
    """(Look, error) of texture `slot`, or white if None, times light at the vertices, fitted to the captured colours
    (linear) at n points by least squares. Where the draw blends by the texture's opacity, only opaque points count.
    `shared`: _same_vertices(draw)."""
    texture = None if slot is None else textures.get(draw.textures[slot])
    texel = np.ones((len(points), 4)) if texture is None else _look_up(draw, texture, uv, points)
    mixes = draw.blends and texture is not None and texture.has_alpha
    if mixes:
        there = texel[:, 3] > 0.9
        if there.sum() < 4 * FEW:
            return None, np.inf
        texel, points, captured = texel[there], points.where(there), captured[there]
    texel = srgb.to_linear(texel[:, :3].astype(np.float64))
    weights = np.clip(points.weights(draw), 0, 1)
    corners = shared[draw.triangles[points.triangle]]
    light, seen = _least_squares(texel, weights, corners, captured, len(draw.clip))
    if not seen.any():
        return None, np.inf
    light, seen = light[shared], seen[shared]
    scale = 2.0 ** np.ceil(np.log2(max(1, np.quantile(light[seen], 0.95))))  # vertices' colours are at most 1
    light = np.clip(light / scale, 0, 1)
    predicted = texel * scale * (weights[..., None] * light[draw.triangles[points.triangle]]).sum(1)
    error = np.abs(srgb.from_linear(np.clip(predicted, 0, 1)) - srgb.from_linear(captured)).max(1)
    constant = np.full(3, scale) if scale > 1 else None
    return Look(slot, uv, None, constant, light=srgb.from_linear(light), mixes=mixes), _typical(error)


def has_shape(draw, textures):
    """Whether the opacity of a texture may give the draw its shape."""
    return any(textures.get(one) is not None and textures.get(one).has_alpha for one in draw.textures)


def find_light(draw, textures, points, captured):
    """A Look of light at the vertices, alone or times a texture, that is what was captured (linear) at n points; None
    if a colour per triangle is as good."""
    shared = _same_vertices(draw)
    few = slice(None, None, max(1, len(points) // 2000))
    candidates = [(slot, uv) for slot, binding in enumerate(draw.textures[:4]) if textures.get(binding) is not None
                  for uv in _uv_names(draw)]
    fit = lambda slot, uv, some: _fit_light(draw, shared, slot, uv, textures, points.where(some), captured[some])
    if not (draw.blends and has_shape(draw, textures)):
        candidates.append((None, None))
    if not candidates:
        return None
    look, error = fit(*min(candidates, key=lambda one: fit(*one, few)[1]), slice(None))
    if look is None or look.mixes:  # a colour per triangle would lose the shape that the opacity gives
        return look
    count = np.bincount(points.triangle, minlength=len(draw.triangles))
    flat = np.stack([np.bincount(points.triangle, captured[:, c], len(draw.triangles)) for c in range(3)], 1)
    flat /= np.maximum(1, count)[:, None]
    flat_error = _typical(np.abs(srgb.from_linear(flat[points.triangle]) - srgb.from_linear(captured)).max(1))
    return look if error < 0.9 * flat_error else None


def _guess(draw, textures):
    """The likeliest texture, coordinates and colours of a blended draw, by their names and kinds."""
    known = [slot for slot, binding in enumerate(draw.textures) if textures.get(binding) is not None]
    # Mesa's zink names outputs by their place: 1 is the colour, 4 to 11 are texture coordinates.
    coordinates = {f"out_{k}" for k in range(4, 12)}
    named = [name for name in _uv_names(draw) if name in coordinates or
             any(part in name.lower() for part in ("uv", "tex", "coord"))]
    named += [name for name in _uv_names(draw) if draw.attributes[name].shape[1] == 2]
    colors = [name for name in _color_names(draw) if name == "out_1" or "col" in name.lower()]
    color = colors[0] if colors else None
    if known and named:
        return Look(known[0], named[0], color, verified=False)
    return Look(None, None, color, verified=False) if color and not draw.textures else None


def find_looks(frame, owner, textures):
    """Sets the look of each draw whose colours a texture or its vertices explain."""
    size = (frame.width, frame.height)
    if frame.color is None:
        return
    picture = frame.color.reshape(-1, 3).astype(np.float64)
    pixels = np.flatnonzero(owner >= 0)
    pixels = pixels[np.argsort(owner[pixels], kind="stable")]
    sorted_owner = owner[pixels]
    pooled, own = {}, {}
    for number, draw in enumerate(frame.draws):
        low, high = np.searchsorted(sorted_owner, [draw.first, draw.first + len(draw.triangles)])
        seen = pixels[low:high]
        seen = seen[:: max(1, len(seen) // PIXELS_PER_DRAW)]
        if len(seen) < FEW:
            continue
        points = Points.of_pixels(owner[seen] - draw.first, seen, size)
        captured = srgb.to_linear(picture[seen])
        for slot, uv, color, predicted, alpha, factor in _explanations(draw, textures, points, captured):
            there = alpha > 0.98 if draw.blends else np.ones(len(seen), bool)
            if there.sum() < FEW:
                continue
            error = np.abs(srgb.from_linear(np.clip(predicted, 0, 1)) - picture[seen]).max(1)[there]
            key = (slot, uv, color)
            pooled.setdefault(draw.shader, {}).setdefault(key, []).append(error)
            own[number, key] = (_typical(error), factor)
    chosen = {}
    for shader, keys in pooled.items():
        errors = {key: _typical(np.concatenate(found)) for key, found in keys.items()}
        # A factor that is fitted to each draw explains more than it should, so that it must be much better.
        chosen[shader] = sorted(errors, key=lambda key: errors[key] * (1.5 if key[2] == "constant" else 1))[:2]
        chosen[shader] = [(key, errors[key]) for key in chosen[shader]]
    for number, draw in enumerate(frame.draws):
        for key, pool_error in chosen.get(draw.shader, []):
            slot, uv, color = key
            error, factor = own.get((number, key), (pool_error, None))
            if error > MOST_ERROR or (color == "constant" and factor is None):
                continue
            if (uv and uv not in draw.attributes) or (slot is not None and slot >= len(draw.textures)):
                continue
            if color and color != "constant" and color not in draw.attributes:
                continue
            if color == "constant":
                draw.look = Look(slot, uv, None, factor)
            else:
                draw.look = Look(slot, uv, color)
            break
        test, look = draw.alpha_test, draw.look
        if test and look and (test.slot, test.uv) != (look.slot, look.uv):
            draw.look = None  # a material has one texture: that of the alpha test decides what is covered
        judged = any((number, key) in own for key, _ in chosen.get(draw.shader, []))
        if draw.look is None and draw.blends and not test and not (judged and draw.mixes):
            draw.look = _guess(draw, textures)
        if draw.look is None and not test:
            low, high = np.searchsorted(sorted_owner, [draw.first, draw.first + len(draw.triangles)])
            seen = pixels[low:high]
            seen = seen[:: max(1, len(seen) // PIXELS_FOR_LIGHT)]
            if len(seen) >= 4 * FEW:
                points = Points.of_pixels(owner[seen] - draw.first, seen, size)
                draw.look = find_light(draw, textures, points, srgb.to_linear(picture[seen]))
            if draw.look is None and draw.blends and has_shape(draw, textures):
                draw.look = _guess(draw, textures)


def _layered(frame, target):
    """Which pixels were last coloured by a draw that adds to the picture, or blends in another way than to mix."""
    layers = np.zeros(frame.triangles + 1, bool)  # by triangle; the last one: none
    for draw in frame.draws:
        layers[draw.first: draw.first + len(draw.triangles)] = draw.blends and not draw.mixes
    return layers[target.owner]


def find_grounds(frame, target):
    """Finds the draws that write depth alone and whose colours are the sum of what is added to the picture on top of
    them, as terrain of several layers is. beampipe draws no such layers."""
    front = target.front
    owned = np.bincount(front[front >= 0], minlength=frame.triangles)
    layered = np.bincount(front[(front >= 0) & _layered(frame, target)], minlength=frame.triangles)
    for draw in frame.draws:
        part = slice(draw.first, draw.first + len(draw.triangles))
        draw.is_ground = bool(draw.writes_only_depth and 2 * layered[part].sum() > owned[part].sum())


def summary(frame, counts):
    """How many of the frame's triangles are coloured how, as one line for the trace's source. `counts`: the pixels
    that each triangle owns."""
    kinds = {}
    for draw in frame.draws:
        if draw.look is None:
            owned = int((counts[draw.first: draw.first + len(draw.triangles)] > 0).sum())
            for name, count in (("captured picture, pixels owned", owned),
                                ("captured picture, pixel under the middle", len(draw.triangles) - owned)):
                kinds[name] = kinds.get(name, 0) + count
            continue
        parts = ["base texture"] if draw.look.slot is not None else []
        parts += ["vertex colours"] if draw.look.color else []
        parts += ["light at vertices from the captured picture"] if draw.look.light is not None else []
        name = " and ".join(parts) + ("" if draw.look.verified else ", not compared")
        kinds[name] = kinds.get(name, 0) + len(draw.triangles)
    return "; ".join(f"{name}: {count} triangles" for name, count in sorted(kinds.items()) if count)


def picture_colors(frame, target):
    """For each triangle of the frame: the sum of the linear colours of the pixels that it owns, their number, and the
    colour of the pixel under its middle. A triangle whose pixels all belong to what blends on top of it gets those."""
    total = frame.triangles
    if frame.color is None:
        return np.zeros((total, 3)), np.zeros(total, np.int64), np.full((total, 3), 0.5)
    linear = srgb.to_linear(frame.color.reshape(-1, 3).astype(np.float64))

    def gathered(owner):
        seen = owner >= 0
        return (np.stack([np.bincount(owner[seen], linear[seen, c], total) for c in range(3)], 1),
                np.bincount(owner[seen], minlength=total))

    (sums, count), (solid_sums, solid_count) = gathered(target.owner), gathered(target.solid)
    ground = np.zeros(total + 1, bool)  # by triangle; the last one: none
    for draw in frame.draws:
        ground[draw.first: draw.first + len(draw.triangles)] = draw.is_ground
    for pixels in (_layered(frame, target), True):  # what mixes on top of the layers counts if there is nothing else
        ground_sums, ground_count = gathered(np.where(ground[target.front] & pixels, target.front, -1))
        solid_sums, solid_count = solid_sums + ground_sums, solid_count + ground_count
        hidden = count == 0
        sums[hidden], count[hidden] = solid_sums[hidden], solid_count[hidden]
    middle = np.zeros((total, 3))
    for draw in frame.draws:
        corners = draw.clip.astype(np.float64)[draw.triangles].mean(1)
        vx, vy, vw, vh = raster.window_of(draw.state, frame.width, frame.height)
        w = np.where(corners[:, 3] > 1e-9, corners[:, 3], 1)
        x = np.clip(vx + vw * (1 + corners[:, 0] / w) / 2, 0, frame.width - 1).astype(np.int64)
        y = np.clip(vy + vh * (1 - corners[:, 1] / w) / 2, 0, frame.height - 1).astype(np.int64)
        middle[draw.first: draw.first + len(draw.triangles)] = linear[y * frame.width + x]
    return sums, count, middle


def shade(frame, textures):
    """Finds the looks of all draws. Returns the rasterized target and picture_colors()."""
    size = (frame.width, frame.height)
    find_alpha_tests(frame, textures)
    target = frame.rasterize(lambda draw, fragments: opacity(draw, fragments, textures, size)
                             >= draw.alpha_test.cutoff)
    find_looks(frame, target.owner, textures)
    find_grounds(frame, target)
    return target, picture_colors(frame, target)
