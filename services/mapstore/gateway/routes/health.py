# SPDX-License-Identifier: Apache-2.0
"""GET /healthz, /readyz, /metrics: for who runs the service."""

from fastapi import APIRouter, Response
from prometheus_client import CollectorRegistry
from prometheus_client.exposition import CONTENT_TYPE_LATEST, generate_latest

from services.mapstore.gateway.live_map import LiveMap
from services.mapstore.gateway.models import HealthAnswer, health_answer
from services.mapstore.map_view import NOT_YET


def router(live: LiveMap, registry: CollectorRegistry) -> APIRouter:
    """The routes over `live`."""
    routes = APIRouter(tags=["operation"])

    @routes.get("/healthz", summary="Is the process alive", response_model=HealthAnswer)
    async def healthz() -> Response:
        """200 as long as the gateway answers."""
        return Response(health_answer(live.view).model_dump_json(), media_type="application/json")

    @routes.get(
        "/readyz",
        summary="Is there a map to ask about",
        response_model=HealthAnswer,
        responses={503: {"model": HealthAnswer, "description": "no frame has come yet"}},
    )
    async def readyz() -> Response:
        """200 from the first frame on, 503 before."""
        view = live.view
        ready = view.sequence != NOT_YET
        answer = health_answer(view, "" if ready else "no frame yet")
        return Response(answer.model_dump_json(), 200 if ready else 503, media_type="application/json")

    @routes.get("/metrics", summary="For Prometheus", response_class=Response)
    async def metrics() -> Response:
        """The map's size and state, requests and their durations, the process."""
        return Response(generate_latest(registry), media_type=CONTENT_TYPE_LATEST)

    return routes
