# SPDX-License-Identifier: Apache-2.0
"""The loop: the outline of the blocks with rounded corners and gently bent streets, as a closed centre line."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.worlds.line import SampledLine
from services.simulator.worlds.town.blocks import town_outline
from services.simulator.worlds.town.profile import LANE_CENTRES_M

Floats = NDArray[np.float64]

MIN_RADIUS_M = 17.0
_RADIUS_M = (18.0, 22.0)
_EASE_M = 12.0
"""Length over which a corner's curvature grows and shrinks, so that a car's yaw rate has no jumps."""
_STREET_RADIUS_M = 70.0
_STEP_M = 0.25
_START_SHARE = 0.2
"""Where on the longest street the loop begins."""


@dataclass(frozen=True, slots=True)
class LoopStreet:
    """One street of the loop, from the end of a corner to the beginning of the next; s may pass the loop's length.

    corner_m: middle of the corner that follows; turn_rad: by how much it turns, left positive.
    """

    start_m: float
    end_m: float
    corner_m: float
    turn_rad: float
    bent: bool


@dataclass(frozen=True, slots=True)
class Loop:
    """line: closed centre line, s = 0 on the longest straight street, with heading 0. streets: in order of s."""

    line: SampledLine
    streets: tuple[LoopStreet, ...]


def town_loop(seed: int, loop_m: float) -> Loop:
    """A loop of exactly `loop_m` round some blocks; every radius of its centre line is at least `MIN_RADIUS_M`."""
    rng = np.random.default_rng([seed, 20])
    while True:
        outline = town_outline(rng, loop_m)
        if rng.random() < 0.5:
            outline = outline[::-1] * [1.0, -1.0] if rng.random() < 0.5 else outline[::-1]
        radii = rng.uniform(*_RADIUS_M, len(outline))
        bends = rng.uniform(0.4, 1.0, len(outline)) * rng.choice([-1.0, 1.0], len(outline))
        bends[rng.random(len(outline)) < 0.3] = 0.0
        loop = _rounded(outline, radii, bends, loop_m)
        if loop is not None:
            return loop


def _rounded(outline: Floats, radii: Floats, bends: Floats, loop_m: float) -> Loop | None:
    """The loop along an outline, scaled to its length; None where a street is too short for its corners."""
    sides = np.roll(outline, -1, axis=0) - outline
    angle = np.arctan2(sides[:, 1], sides[:, 0])
    turns = np.mod(np.roll(angle, -1) - angle + np.pi, 2.0 * np.pi) - np.pi
    corners = [_corner(float(turn), float(radius)) for turn, radius in zip(turns, radii, strict=True)]
    tangent = np.array([_tangent_m(corner, float(turn)) for corner, turn in zip(corners, turns, strict=True)])
    used = tangent + np.roll(tangent, 1)
    bends = bends.copy()
    bends[np.argmax(np.linalg.norm(sides, axis=1))] = 0.0
    corner_m = sum((len(corner) - 1) * _STEP_M for corner in corners)
    scale = 1.0
    for _ in range(30):
        chord = scale * np.linalg.norm(sides, axis=1) - used
        if chord.min() < 12.0:
            return None
        swing = bends * np.minimum(chord / (2.0 * np.pi * _STREET_RADIUS_M), 0.42)
        length = chord / np.array([_shortening(float(value)) for value in swing])
        scale *= 1.0 + (loop_m - corner_m - length.sum()) / loop_m
    return _assembled(turns, corners, length, swing, loop_m)


def _assembled(turns: Floats, corners: list[Floats], length: Floats, swing: Floats, loop_m: float) -> Loop:
    """Headings of streets and corners one after the other, sampled, with s = 0 on the longest straight street."""
    count = len(length)
    first = int(np.argmax(np.where(swing == 0.0, length, 0.0)))
    order = [(first + k) % count for k in range(count)]
    begin = -_START_SHARE * float(length[first])
    knots: list[Floats] = []
    headings: list[Floats] = []
    streets: list[LoopStreet] = []
    heading, s = 0.0, begin
    for k in order:
        along: Floats = np.linspace(0.0, 1.0, max(2, round(float(length[k]) / _STEP_M)) + 1, dtype=np.float64)
        corner_m = (len(corners[k]) - 1) * _STEP_M
        knots.append(s + along[:-1] * float(length[k]))
        headings.append(heading + swing[k] * _bow(along[:-1]))
        end = s + float(length[k])
        knots.append(end + _STEP_M * np.arange(len(corners[k]) - 1, dtype=np.float64))
        headings.append(heading + corners[k][:-1])
        streets.append(LoopStreet(s, end, end + 0.5 * corner_m, float(turns[k]), bool(abs(swing[k]) > 0.05)))
        heading += float(turns[k])
        s = end + corner_m
    all_s = np.concatenate([*knots, [s]])
    all_heading = np.concatenate([*headings, [heading]])
    samples = np.linspace(0.0, loop_m, round(loop_m / _STEP_M) + 1)
    # The loop begins on the first street: what lies before s = 0 comes again at the end, one turn later.
    around = np.interp(samples, np.append(all_s, all_s[1:] + loop_m), np.append(all_heading, all_heading[1:] + heading))
    line = SampledLine(around, loop_m, np.array([0.0, LANE_CENTRES_M[0]]), closed=True)
    return Loop(line, tuple(streets))


def _bow(u: Floats) -> Floats:
    """Change of heading along a bent street, u from 0 to 1: out and back, so that it arrives on the straight line."""
    return np.asarray(np.sin(2.0 * np.pi * u) * np.square(np.sin(np.pi * u)))


def _shortening(swing: float) -> float:
    """Chord of a bent street of length 1."""
    u: Floats = (np.arange(400, dtype=np.float64) + 0.5) / 400.0
    return float(np.cos(swing * _bow(u)).mean())


def _corner(turn: float, radius_m: float) -> Floats:
    """Headings every `_STEP_M` through a corner: curvature rises, holds at 1 / radius and falls."""
    hold_m = max(0.0, abs(turn) * radius_m - _EASE_M)
    count = round((hold_m + 2.0 * _EASE_M) / _STEP_M)
    s = np.linspace(0.0, hold_m + 2.0 * _EASE_M, 8 * count + 1)
    rise = np.clip(np.minimum(s, s[-1] - s) / _EASE_M, 0.0, 1.0)
    bend = rise * rise * (3.0 - 2.0 * rise)
    heading = np.concatenate([[0.0], np.cumsum(0.5 * (bend[1:] + bend[:-1]))])
    return np.asarray(turn * heading[::8] / heading[-1])


def _tangent_m(corner: Floats, turn: float) -> float:
    """How far before the outline's corner the rounding begins; it is the same behind it."""
    middle = 0.5 * (corner[1:] + corner[:-1])
    x, y = np.cos(middle).sum() * _STEP_M, np.sin(middle).sum() * _STEP_M
    return float(x - y / np.tan(turn))
