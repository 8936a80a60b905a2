# SPDX-License-Identifier: Apache-2.0
"""A centre line given by its heading: short arcs one after the other, so that position and heading always agree."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class SampledLine:
    """Centre line whose heading is linear between samples; world plane, metres, radians.

    heading: (K + 1,) at K + 1 equal steps over `length_m`. start: world (x, y) of s = 0. end: where it must arrive;
    the error of integration, far below a millimetre a metre, is spread along it. closed: periodic in s; open lines go
    straight on beyond both ends.
    """

    def __init__(
        self, heading: Floats, length_m: float, start: Floats, *, end: Floats | None = None, closed: bool = False
    ) -> None:
        self._length_m, self._closed = float(length_m), closed
        self._heading = np.asarray(heading, np.float64)
        self._count = len(heading) - 1
        self._step_m = self._length_m / self._count
        middle = 0.5 * (self._heading[1:] + self._heading[:-1])
        steps = self._step_m * np.stack([np.cos(middle), np.sin(middle)], axis=1)
        self._xy = np.asarray(start, np.float64) + np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
        target = self._xy[0] if closed else end
        self._drift = np.zeros(2) if target is None else (np.asarray(target) - self._xy[-1]) / self._length_m
        self._xy += (np.arange(self._count + 1) * self._step_m)[:, None] * self._drift

    @property
    def length_m(self) -> float:
        """How far s goes."""
        return self._length_m

    def heading(self, s: Floats | float) -> Floats:
        """Angle against world x, counter-clockwise, without jumps; a closed line gains a turn each time round."""
        index, fraction, laps, _ = self._located(np.asarray(s, np.float64))
        between = self._heading[index] + fraction * (self._heading[index + 1] - self._heading[index])
        return np.asarray(between + laps * (self._heading[-1] - self._heading[0]))

    def point(self, s: Floats | float, n: Floats | float) -> Floats:
        """World (x, y) at s along the line and n to its left, shape (..., 2)."""
        s, n = np.broadcast_arrays(np.asarray(s, np.float64), np.asarray(n, np.float64))
        index, fraction, _, beyond = self._located(s)
        first = self._heading[index]
        turn = fraction * (self._heading[index + 1] - first)
        gone = fraction * self._step_m
        at, middle = first + turn, first + 0.5 * turn
        cos, sin = np.cos(at), np.sin(at)
        x = self._xy[index, 0] + gone * (np.cos(middle) + self._drift[0]) + beyond * cos - n * sin
        y = self._xy[index, 1] + gone * (np.sin(middle) + self._drift[1]) + beyond * sin + n * cos
        return np.stack([x, y], axis=-1)

    def curvature(self, s: Floats | float) -> Floats:
        """Change of heading along the line, 1/m, left positive; zero beyond the ends of an open one."""
        index, _, _, beyond = self._located(np.asarray(s, np.float64))
        bend = (self._heading[index + 1] - self._heading[index]) / self._step_m
        return np.asarray(np.where(beyond == 0.0, bend, 0.0))

    def part(self, length_m: float, *, from_end: bool = False) -> SampledLine:
        """The first `length_m` of an open line; `from_end`: of the same line walked the other way."""
        s = np.linspace(0.0, length_m, max(2, round(length_m / self._step_m) + 1))
        if from_end:
            s = self._length_m - s
        ends = self.point(s[[0, -1]], 0.0)
        return SampledLine(self.heading(s) + (np.pi if from_end else 0.0), length_m, ends[0], end=ends[1])

    def _located(self, s: Floats) -> tuple[NDArray[np.intp], Floats, Floats, Floats]:
        """Sample before s, fraction of the step, whole laps, and how far s lies beyond the ends."""
        laps = np.floor(s / self._length_m) if self._closed else np.zeros_like(s)
        around = s - laps * self._length_m
        inside = np.minimum(np.maximum(around, 0.0), self._length_m)
        index = np.minimum((inside / self._step_m).astype(np.intp), self._count - 1)
        beyond = np.zeros_like(s) if self._closed else around - inside
        return index, inside / self._step_m - index, laps, beyond


def line_through(points: Floats, step_m: float = 0.5) -> SampledLine:
    """The open line through densely given world points (P, 2)."""
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    along = np.gradient(points, way, axis=0, edge_order=2)
    heading = np.unwrap(np.arctan2(along[:, 1], along[:, 0]))
    s = np.linspace(0.0, way[-1], max(2, round(way[-1] / step_m) + 1))
    return SampledLine(np.interp(s, way, heading), float(way[-1]), points[0], end=points[-1])
