# SPDX-License-Identifier: Apache-2.0
"""The newest view of the map, handed from the service's thread to the gateway's without a lock."""

import threading
from collections.abc import Callable
from typing import Generic, NamedTuple, TypeVar

from schemas.records import Density
from services.mapstore import sim3
from services.mapstore.base_pose import BasePose
from services.mapstore.density import DynamicDensity
from services.mapstore.map_view import MapView

Built = TypeVar("Built")


class Moment(NamedTuple):
    """The map after one frame, and where the robot is in it: (7,) map_from_base, None where it was not tracked."""

    view: MapView
    map_from_base: sim3.Floats | None


class LiveMap:
    """What the gateway answers from. One thread shows views, any thread reads them."""

    def __init__(self, view: MapView, density: DynamicDensity, base: BasePose) -> None:
        self._density = density
        self._base = base
        self._now = Moment(view, base.in_map(view))

    @property
    def now(self) -> Moment:
        """The newest moment; a request reads it once, so that its answer is of one piece."""
        return self._now

    @property
    def view(self) -> MapView:
        """The newest view."""
        return self._now.view

    def show(self, view: MapView) -> None:
        """Replaces the moment: one reference, set at once."""
        self._now = Moment(view, self._base.in_map(view))

    def density(self, view: MapView, position: sim3.Floats | None, radius: float, window_s: float) -> Density:
        """The density at `position` (3,) in the map frame, or nowhere."""
        if position is None:
            return self._density.nowhere(view, radius, window_s)
        return self._density.at(view, position, radius, window_s)


class BuiltOnce(Generic[Built]):
    """Something costly made of a view: many who ask at the same time wait for one to make it."""

    def __init__(self, build: Callable[[MapView], Built]) -> None:
        self._build = build
        self._lock = threading.Lock()
        self._latest: tuple[MapView, Built] | None = None

    def of(self, view: MapView) -> Built:
        """What was built of `view`."""
        with self._lock:
            if self._latest is None or self._latest[0] is not view:
                self._latest = (view, self._build(view))
            return self._latest[1]
