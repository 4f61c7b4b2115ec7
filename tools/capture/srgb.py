"""The sRGB transfer function (IEC 61966-2-1), both ways, for values 0..1."""
import numpy as np


def to_linear(encoded):
    return np.where(encoded <= 0.04045, encoded / 12.92, ((np.maximum(encoded, 0) + 0.055) / 1.055) ** 2.4)


def from_linear(linear):
    return np.where(linear <= 0.0031308, linear * 12.92, 1.055 * np.maximum(linear, 0) ** (1 / 2.4) - 0.055)
