"""Distances between responses: of pressures in L2 over the lining, of vectors, of numbers."""

import math

import numpy as np

from drumlin.arrays import Floats
from drumlin.response.response import EDGE_ZONE, ShoeResponse
from drumlin.response.resultants import GAUSS, WEIGHTS, edge_left_out


def pressure_distance(a: ShoeResponse, b: ShoeResponse, edge: float = EDGE_ZONE) -> float:
    """L2 norm over theta of p_a - p_b, relative to that of p_b, outside zones of `edge` [rad] at the lining's ends.

    Where half of p_b's force is within those zones, over the whole lining; where it presses nowhere: 0 if neither does
    p_a, else infinite.
    """
    edge = edge_left_out(b.theta, b.pressure, b.order, edge)
    start, end = b.theta[0] + edge, b.theta[-1] - edge
    # sorted alone: between two knots at one place lies nothing
    knots = np.sort(np.concatenate([[start, end], a.theta[:: a.order], b.theta[:: b.order]]))
    knots = knots[(knots >= start) & (knots <= end)]
    half = 0.5 * np.diff(knots)[:, None]
    theta = (knots[:-1, None] + half * (1 + GAUSS)).ravel()
    weight = (half * WEIGHTS).ravel()
    pa, pb = a.pressure_at(theta), b.pressure_at(theta)
    size = float(weight @ pb**2)
    if size > 0:
        return math.sqrt(float(weight @ (pa - pb) ** 2) / size)
    return math.inf if pa.any() else 0.0


def vector_distance(a: Floats, b: Floats) -> float:
    """Length of a - b relative to that of b."""
    size = float(np.linalg.norm(b))
    return float(np.linalg.norm(np.asarray(a) - b)) / size if size else math.nan


def relative(value: float, true: float) -> float:
    """(value - true) / true; nan where true is 0."""
    return (value - true) / true if true else math.nan
