"""Whether a mesh only moved between two frames: one 4x4 matrix takes its old clip positions to the new ones."""
import numpy as np

ULP = 2.0**-23
MOST_ULPS = 8  # of the largest coordinate: each frame rounds a few sums and products of 32-bit floats
ENOUGH = 4096  # vertices that the matrix is fitted to; all are checked


def find_matrix(old, new):
    """The 4x4 float64 M with new = M old for clip positions n x 4 (rows), or None if there is none within rounding.

    Where the old positions span less than all of clip space, as those of a flat mesh do, M keeps the rest as it is."""
    if old.shape != new.shape or not len(old):
        return None
    if np.array_equal(old, new):
        return np.eye(4)
    old, new = old.astype(np.float64), new.astype(np.float64)
    step = max(1, len(old) // ENOUGH)
    _, size, axes = np.linalg.svd(old[::step], full_matrices=len(old[::step]) < 4)
    spanned = np.zeros(4, bool)
    spanned[: len(size)] = size > size[0] * 1e-6
    axes, rest = axes[spanned], axes[~spanned]
    places = old[::step] @ axes.T
    moved, *_ = np.linalg.lstsq(places, new[::step], rcond=None)
    matrix = moved.T @ axes + rest.T @ rest
    error = np.abs(old @ matrix.T - new)
    allowed = MOST_ULPS * ULP * np.maximum(np.abs(new).max(1), np.abs(old).max(1))
    return matrix if (error <= allowed[:, None]).all() else None
