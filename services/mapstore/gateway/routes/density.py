# SPDX-License-Identifier: Apache-2.0
"""GET /density: how much moves around a pose."""

from typing import Annotated

from fastapi import APIRouter, Query, Response

from services.mapstore.gateway import parameters
from services.mapstore.gateway.live_map import LiveMap
from services.mapstore.gateway.models import DensityAnswer, density_answer
from services.runtime.config.mapstore import MapstoreConfig

_Pose = Annotated[
    str, Query(description="x,y,z in the map frame, or `current`: where the robot is", examples=["current", "12.5,0,1"])
]
_Radius = Annotated[str | None, Query(description="of the sphere, in m or map units; above 0", examples=["10"])]
_Window = Annotated[str | None, Query(description="in seconds, or `all` for every movement ever", examples=["30"])]


def router(live: LiveMap, options: MapstoreConfig) -> APIRouter:
    """The route over `live`."""
    routes = APIRouter(tags=["density"])

    @routes.get("/density", summary="How much moves around a pose", response_model=DensityAnswer)
    async def density(pose: _Pose = parameters.CURRENT, radius: _Radius = None, window: _Window = None) -> Response:
        """Counts moving landmarks in a sphere: each object's last observation inside the window once, or, with
        `window=all`, every moving landmark ever. Never observed is `unknown`, not `low`."""
        position = parameters.parse_pose(pose)
        radius_given = parameters.parse_radius(radius, options.density_radius)
        window_s = parameters.parse_window(window, options.density_window_s)
        view, map_from_base = live.now
        if position is None and map_from_base is not None:
            position = map_from_base[:3]
        answer = density_answer(view, live.density(view, position, radius_given, window_s), options.high_density_points)
        return Response(answer.model_dump_json(), media_type="application/json")

    return routes
