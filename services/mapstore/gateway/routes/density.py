# SPDX-License-Identifier: Apache-2.0
"""GET /density: how much moves around a pose."""

from typing import Annotated

from fastapi import APIRouter, Query, Response

from services.mapstore.gateway import parameters
from services.mapstore.gateway.live_map import LiveMap, Moment
from services.mapstore.gateway.models import DensityAnswer, density_answer
from services.runtime.config.mapstore import MapstoreConfig

_Pose = Annotated[
    str, Query(description="x,y,z in the map frame, or `current`: where the robot is", examples=["current", "12.5,0,1"])
]
_Radius = Annotated[str | None, Query(description="of the sphere, in m or map units; above 0", examples=["10"])]
_Window = Annotated[str | None, Query(description="in seconds, or `all` for every movement ever", examples=["30"])]

_Question = tuple[str, float, float]
_MOST_KEPT = 64


class _Answered:
    """The answers of one moment: who asks five times a frame costs one count. For one event loop."""

    def __init__(self) -> None:
        self._moment: Moment | None = None
        self._answers: dict[_Question, str] = {}

    def get(self, moment: Moment, question: _Question) -> str | None:
        """What was answered to the same question at the same moment."""
        return self._answers.get(question) if moment is self._moment else None

    def keep(self, moment: Moment, question: _Question, answer: str) -> None:
        """Remember it, unless there are many of this moment already."""
        if moment is not self._moment:
            self._moment, self._answers = moment, {}
        if len(self._answers) < _MOST_KEPT:
            self._answers[question] = answer


def router(live: LiveMap, options: MapstoreConfig) -> APIRouter:
    """The route over `live`."""
    routes = APIRouter(tags=["density"])
    answered = _Answered()

    @routes.get("/density", summary="How much moves around a pose", response_model=DensityAnswer)
    async def density(pose: _Pose = parameters.CURRENT, radius: _Radius = None, window: _Window = None) -> Response:
        """Counts moving landmarks in a sphere: each object's last observation inside the window once, or, with
        `window=all`, every moving landmark ever. Never observed is `unknown`, not `low`."""
        position = parameters.parse_pose(pose)
        radius_given = parameters.parse_radius(radius, options.density_radius)
        window_s = parameters.parse_window(window, options.density_window_s)
        moment = live.now
        question = (pose, radius_given, window_s)
        if (known := answered.get(moment, question)) is not None:
            return Response(known, media_type="application/json")
        view, map_from_base = moment
        if position is None and map_from_base is not None:
            position = map_from_base[:3]
        answer = density_answer(view, live.density(view, position, radius_given, window_s), options.high_density_points)
        content = answer.model_dump_json()
        answered.keep(moment, question, content)
        return Response(content, media_type="application/json")

    return routes
