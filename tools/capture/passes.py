"""Groups a frame's draws by the pictures that they draw to, and chooses the group that a trace keeps."""
import re

_DEPTH_CLEARED = re.compile(r"\b(D|DS)=Clear|\(Clear\)")
_COLOR_CLEARED = re.compile(r"\bC=Clear|\(Clear\)")


class Action:
    """What passes.py needs to know of a command: plain values, so that tests can make them."""

    def __init__(self, event, name, is_draw, color, depth, vertices, clears_depth=False, clears_color=False,
                 presented=0):
        self.event, self.name, self.is_draw, self.color, self.depth = event, name, is_draw, color, depth
        self.vertices, self.clears_depth, self.clears_color = vertices, clears_depth, clears_color
        self.presented = presented


class Pass:
    """Draws with the same colour and depth target. `cleared_before` has the events of draws right before which the
    depth was cleared, except for the first draw."""

    def __init__(self, color, depth):
        self.color, self.depth = color, depth
        self.draws, self.cleared_before = [], set()

    @property
    def vertices(self):
        return sum(draw.vertices for draw in self.draws)

    @property
    def name(self):
        return f"colour {self.color or 'none'}, depth {self.depth or 'none'}"


def clears_of(name):
    """(depth, colour) that a render pass with this name clears as it begins."""
    return bool(_DEPTH_CLEARED.search(name)), bool(_COLOR_CLEARED.search(name))


def group(actions):
    """The passes in the order of their first draws. A target that is cleared again starts anew: what was drawn to it
    earlier cannot be seen any more."""
    passes, open_passes, pending = [], {}, set()
    for action in actions:
        key = (action.color, action.depth)
        if action.clears_color and key in open_passes:
            del open_passes[key]
        if action.clears_depth:
            pending.add(action.depth)
        if not action.is_draw:
            continue
        if key not in open_passes:
            open_passes[key] = Pass(*key)
            passes.append(open_passes[key])
        elif action.depth in pending:
            open_passes[key].cleared_before.add(action.event)
        pending.discard(action.depth)
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
