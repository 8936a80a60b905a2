# SPDX-License-Identifier: Apache-2.0
"""GET /objects: what and where the things in the map are, and how they move."""

from fastapi import APIRouter, Response

from services.mapstore.gateway.live_map import BuiltOnce, LiveMap
from services.mapstore.gateway.models import ObjectsAnswer, moment, object_answer
from services.mapstore.map_view import MapView
from services.mapstore.object_summary import summarize_objects


def router(live: LiveMap) -> APIRouter:
    """The route over `live`."""
    routes = APIRouter(tags=["objects"])
    built = BuiltOnce(_answer)

    @routes.get("/objects", summary="The objects in the map", response_model=ObjectsAnswer)
    def objects() -> Response:
        """Every object of the current map: category, motion state, where and when it was seen last.

        Those in the newest frame with velocity and size, where the map is metric.
        """
        return Response(built.of(live.view), media_type="application/json")

    return routes


def _answer(view: MapView) -> str:
    summaries = [object_answer(summary) for summary in summarize_objects(view)]
    return ObjectsAnswer(**moment(view), objects=summaries).model_dump_json()
