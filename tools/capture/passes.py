"""Groups a frame's draws by the pictures that they draw to, and chooses the group that a trace keeps."""
import re

_DEPTH_CLEARED = re.compile(r"\b(D|DS)=Clear|\(Clear\)")
_STENCIL_CLEARED = re.compile(r"\b(S|DS)=Clear|\(Clear\)")
_COLOR_CLEARED = re.compile(r"\bC=Clear|\(Clear\)")


class Action:
    """What passes.py needs to know of a command: plain values, so that tests can make them."""

    def __init__(self, event, name, is_draw, color, depth, vertices, clears=None, presented=0):
        self.event, self.name, self.is_draw, self.color, self.depth = event, name, is_draw, color, depth
        self.vertices, self.clears, self.presented = vertices, clears or Clears(), presented


class Clears:
    """What a command clears: the whole colour target; the whole depth buffer, to a number; the whole stencil buffer, to
    a number; or parts of any."""

    def __init__(self, color=False, depth=None, stencil=None, parts=False):
        self.color, self.depth, self.stencil, self.parts = color, depth, stencil, parts

    @property
    def is_some(self):
        return self.depth is not None or self.stencil is not None or self.parts

    def then(self, later):
        """Both after each other."""
        latest = lambda first, second: first if second is None else second
        return Clears(self.color or later.color, latest(self.depth, later.depth), latest(self.stencil, later.stencil),
                      self.parts or later.parts)


class Pass:
    """Draws with the same colour and depth target. `cleared_first`: what was cleared before the first draw.
    `cleared_before`: by the events of the others, what was cleared right before them."""

    def __init__(self, color, depth, cleared_first):
        self.color, self.depth, self.cleared_first = color, depth, cleared_first
        self.draws, self.cleared_before = [], {}

    @property
    def vertices(self):
        return sum(draw.vertices for draw in self.draws)

    @property
    def name(self):
        return f"colour {self.color or 'none'}, depth {self.depth or 'none'}"


def clears_of(name):
    """Whether a render pass with this name clears (colour, depth, stencil) as it begins."""
    return tuple(bool(each.search(name)) for each in (_COLOR_CLEARED, _DEPTH_CLEARED, _STENCIL_CLEARED))


def group(actions):
    """The passes in the order of their first draws. A target that is cleared again starts anew: what was drawn to it
    earlier cannot be seen any more."""
    passes, open_passes, pending = [], {}, {}
    for action in actions:
        key = (action.color, action.depth)
        if action.clears.color:
            for other in [other for other in open_passes if other[0] == action.color]:
                del open_passes[other]
        pending[action.depth] = pending.get(action.depth, Clears()).then(action.clears)
        if not action.is_draw:
            continue
        if key not in open_passes:
            open_passes[key] = Pass(*key, pending[action.depth])
            passes.append(open_passes[key])
        elif pending[action.depth].is_some:
            open_passes[key].cleared_before[action.event] = pending[action.depth]
        pending[action.depth] = Clears()
        open_passes[key].draws.append(action)
    return passes


def choose(passes, presented):
    """The pass to keep: the one with most vertices among those with colour and depth. Passes to what is presented come
    first if they have half as many; passes without depth come last (they copy or filter pictures, or draw in 2D)."""
    candidates = [p for p in passes if p.color and p.depth] or [p for p in passes if p.color] or passes
    most = max(candidates, key=lambda p: p.vertices)
    shown = [p for p in candidates if p.color == presented and 2 * p.vertices >= most.vertices]
    return max(shown, key=lambda p: p.vertices) if shown else most


def reason_left_out(one, kept):
    """Why a pass is not in the trace, for the list of passes."""
    if not one.color:
        return "depth only, such as a shadow map"
    if not one.depth:
        return "no depth, such as a copy or a filter"
    return "fewer vertices than the pass that is kept" if one.vertices <= kept.vertices else "not chosen"
