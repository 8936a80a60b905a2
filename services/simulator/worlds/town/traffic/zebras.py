# SPDX-License-Identifier: Apache-2.0
"""Zebra crossings: people wait for a gap, and where none comes for a light that stops the traffic."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from services.simulator.worlds.town.plan import TownPlan
from services.simulator.worlds.town.profile import ZEBRA_HALF_LENGTH_M
from services.simulator.worlds.town.traffic.crossers import Crosser
from services.simulator.worlds.town.traffic.sites import Site, SiteState
from services.simulator.worlds.town.traffic.state import VehicleState

Ints = NDArray[np.intp]

_PATIENCE_S = 4.0
_CAMERA_REST_S = 44.0
"""The camera's car is not stopped again sooner than this after it could go on."""
_CAMERA_NEAR_M = 70.0
_FLOW_S = 40.0
"""Least time between two reds."""
_LIGHT_TRAFFIC = 0.15
"""Below this there are no lights: people wait for gaps."""
_COMING_M = (24.0, 42.0)
_QUEUE_S = 1.5
"""Who comes to the kerb within this of the first one crosses with him."""


class Zebra:
    """One zebra crossing with the people who use it."""

    def __init__(
        self, plan: TownPlan, number: int, crossers: list[Crosser], *, vehicles: int, traffic: float, seed: int
    ) -> None:
        s = plan.zebras_m[number]
        self.site = Site(s - ZEBRA_HALF_LENGTH_M, s + ZEBRA_HALF_LENGTH_M, vehicles)
        self._people = [crosser for crosser in crossers if crosser.zebra == number]
        self._has_light = traffic >= _LIGHT_TRAFFIC
        self._tempting, self._tempted = 0.5 + 0.2 * traffic, False
        self._rng = np.random.default_rng([seed, 49, number])

    def step(self, state: VehicleState, rows: Ints, now_s: float, camera_free_s: float) -> None:
        """Open, close, let people cross. camera_free_s: since when the camera's car has not stood."""
        site = self.site
        if site.state is SiteState.OPEN:
            self._see_camera_coming(state, now_s, camera_free_s)
            waiting = [person for person in self._people if person.ready_s <= now_s]
            if not waiting or not site.is_alone():
                return
            if site.gap_for_all(state, rows) or self._light_turns(waiting, state, now_s, camera_free_s):
                site.close(state, rows, now_s)
        if site.state is SiteState.CLOSING and site.is_empty(state, rows):
            site.change(SiteState.CROSSED, now_s)
            ready = [person for person in self._people if person.ready_s <= now_s + _QUEUE_S]
            site.busy_until_s = max(person.set_off(max(now_s, person.ready_s)) for person in ready)
        over = site.state is SiteState.CROSSED and now_s > site.busy_until_s
        if over or site.gave_up(now_s):
            site.change(SiteState.OPEN, now_s)
        site.hold(state, rows)

    def _see_camera_coming(self, state: VehicleState, now_s: float, camera_free_s: float) -> None:
        """Now and then somebody presses the button just when the camera comes."""
        ahead = float(self.site.ahead_m(state, np.zeros(1, np.intp))[0])
        if ahead > _COMING_M[1]:
            self._tempted = False
        elif not self._tempted and ahead > _COMING_M[0]:
            self._tempted = True
            if self._has_light and now_s - camera_free_s > _CAMERA_REST_S and self._rng.random() < self._tempting:
                for person in self._people:
                    person.ready_s = min(person.ready_s, now_s - _PATIENCE_S)
                self.site.since_s = -np.inf

    def _light_turns(self, waiting: list[Crosser], state: VehicleState, now_s: float, camera_free_s: float) -> bool:
        longest = max(now_s - person.ready_s for person in waiting)
        if not self._has_light or longest < _PATIENCE_S or now_s - self.site.since_s < _FLOW_S:
            return False
        near = float(self.site.ahead_m(state, np.zeros(1, np.intp))[0]) < _CAMERA_NEAR_M
        return not (near and now_s - camera_free_s < _CAMERA_REST_S)
