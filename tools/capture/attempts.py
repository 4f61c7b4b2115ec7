"""Some programs crash now and then as RenderDoc is loaded into them, and are started again."""
from failure import Failure

STARTS = 3


class EarlyCrash(Failure):
    """A signal has ended the program before it showed a picture."""


def first_success(attempt):
    """What attempt() returns. It is tried again after an early crash, STARTS times in all."""
    for _ in range(STARTS - 1):
        try:
            return attempt()
        except EarlyCrash:
            pass
    return attempt()
