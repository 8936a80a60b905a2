# SPDX-License-Identifier: Apache-2.0
"""GET /pose: where the robot is."""

from fastapi import APIRouter, Response

from services.mapstore.gateway.live_map import LiveMap
from services.mapstore.gateway.models import PoseAnswer, moment


def router(live: LiveMap) -> APIRouter:
    """The route over `live`."""
    routes = APIRouter(tags=["pose"])

    @routes.get("/pose", summary="Where the robot is", response_model=PoseAnswer)
    async def pose() -> Response:
        """map_from_base of the newest frame; null where it was not tracked."""
        view, base = live.now
        camera = view.current_pose()
        answer = PoseAnswer(
            **moment(view),
            tracked=base is not None,
            reason="" if base is not None else view.reason or "no pose yet",
            position=None if base is None else tuple(base[:3].tolist()),
            orientation=None if base is None else tuple(base[3:].tolist()),
            map_from_camera=None if camera is None else tuple(camera.tolist()),
        )
        return Response(answer.model_dump_json(), media_type="application/json")

    return routes
