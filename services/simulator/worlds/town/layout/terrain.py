# SPDX-License-Identifier: Apache-2.0
"""Lawns and fields round the streets, out to the woods on the horizon."""

from __future__ import annotations

from collections.abc import Mapping

import cv2
import numpy as np
from numpy.typing import NDArray

from services.simulator.shapes.meshes import Mesh, merged, quads, surface
from services.simulator.worlds.town.ground import FLAT_BEYOND_M
from services.simulator.worlds.town.layout.drape import Drape
from services.simulator.worlds.town.profile import KERB_HEIGHT_M
from services.simulator.worlds.town.survey import TownSurvey

Floats = NDArray[np.float64]

_CELL_M = 4.0
_BLOCK = 4
_NEAR_M = 56.0
"""Fine cells reach this far from the streets."""
_LIFT_M = KERB_HEIGHT_M - 0.01
_DIP_M = 0.6
"""Below pavements the ground is this much lower; verges cover the way down."""
_COARSE_DROP_M = 0.25
_RING_M = 170.0
"""From where the hills have ended to the wood on the horizon."""


def terrain_mesh(survey: TownSurvey, drape: Drape, texture: Mapping[str, int]) -> Mesh:
    """Everything that is grass and does not belong to a street, and the wood round it."""
    reach = survey.radius_m + FLAT_BEYOND_M
    count = int(np.ceil(2.0 * reach / (_CELL_M * _BLOCK))) * _BLOCK
    origin = survey.centre - 0.5 * count * _CELL_M
    x = origin[0] + _CELL_M * np.arange(count + 1)
    y = origin[1] + _CELL_M * np.arange(count + 1)
    places = np.stack(np.meshgrid(x, y), axis=-1)
    behind = survey.ground.distances.behind_pavement_m(places)
    away = cv2.distanceTransform((behind > 1.0).astype(np.uint8), cv2.DIST_L2, 5) * _CELL_M
    blocks = away[:-1, :-1].reshape(count // _BLOCK, _BLOCK, count // _BLOCK, _BLOCK).min(axis=(1, 3))
    near = np.kron(blocks < _NEAR_M, np.ones((_BLOCK, _BLOCK), bool))
    under = behind < 1.0
    hidden = under[:-1, :-1] & under[:-1, 1:] & under[1:, :-1] & under[1:, 1:]
    lift = np.where(under, _LIFT_M - _DIP_M, _LIFT_M)
    fine = _grid_cells(drape.lifted(places, lift), near & ~hidden)
    coarse = _grid_cells(drape.lifted(places[::_BLOCK, ::_BLOCK], _LIFT_M - _COARSE_DROP_M), blocks >= _NEAR_M)
    # Coarse cells reach below the fine ones, so that no gap opens between them.
    middle = coarse.mean(axis=1, keepdims=True)
    coarse[..., :2] += 0.1 * (coarse - middle)[..., :2]
    corners = np.concatenate([fine, coarse])
    lawn = quads(corners, corners[..., :2] / 5.0, texture["grass"], one_part=True)
    return merged(
        [lawn, _horizon(survey, 0.5 * count * _CELL_M, reach + _RING_M, texture), _town_wood(survey, texture)]
    )


def _grid_cells(points: Floats, wanted: NDArray[np.bool_]) -> Floats:
    """Corners (Q, 4, 3) of the wanted cells of a grid of points."""
    row, column = np.nonzero(wanted)
    return np.stack(
        [points[row, column], points[row, column + 1], points[row + 1, column + 1], points[row + 1, column]], axis=1
    )


def _horizon(survey: TownSurvey, inner_m: float, radius_m: float, texture: Mapping[str, int]) -> Mesh:
    """Fields from a square of half side inner_m to the horizon, and a ring of woods round them."""
    angle = np.linspace(0.0, 2.0 * np.pi, 97)
    ring = survey.centre + radius_m * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    rise = 26.0 + 7.0 * np.sin(3.0 * angle + 1.0) + 5.0 * np.sin(7.0 * angle)
    low, high = np.column_stack([ring, np.full(97, -4.0)]), np.column_stack([ring, rise])
    uv = np.zeros((2, 97, 2))
    uv[:, :, 0] = angle * 5.0 / (2.0 * np.pi)
    uv[0, :, 1], uv[1, :, 1] = 0.99, 0.01
    wood = surface(np.stack([low, high]), uv, texture["tree_line"])
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]], np.float64)
    height = np.full(5, _LIFT_M - _COARSE_DROP_M - 0.1)
    edges = [np.column_stack([survey.centre + half_m * square, height]) for half_m in (inner_m - 1.0, radius_m)]
    frame = np.stack(edges)
    fields = surface(frame, frame[..., :2] / 5.0, texture["grass"])
    return merged([wood, fields])


def _town_wood(survey: TownSurvey, texture: Mapping[str, int]) -> Mesh:
    """The edge of a wood round the town, uneven above."""
    count = 240
    rng = np.random.default_rng(count)
    angle = np.linspace(0.0, 2.0 * np.pi, count + 1)
    wave = 12.0 * np.sin(3.0 * angle) + 7.0 * np.sin(8.0 * angle + 1.0)
    ring = survey.centre + (survey.radius_m + 60.0 + wave)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    ground = survey.ground.hills.height_m(ring)
    rise = rng.uniform(9.0, 15.0, count + 1)
    rise[-1] = rise[0]
    low, high = np.column_stack([ring, ground - 1.0]), np.column_stack([ring, ground + rise])
    uv = np.zeros((2, count + 1, 2))
    uv[:, :, 0] = angle * round(survey.radius_m / 20.0) / (2.0 * np.pi)
    uv[0, :, 1], uv[1, :, 1] = 0.99, 0.01
    return surface(np.stack([low, high]), uv, texture["tree_line"], (0.72, 0.76, 0.74))
