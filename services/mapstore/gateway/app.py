# SPDX-License-Identifier: Apache-2.0
"""The gateway's FastAPI application: its routes, and one way to say what was wrong."""

from fastapi import Depends, FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from fastapi.routing import APIRoute
from starlette.exceptions import HTTPException

from services.mapstore.gateway.http_metrics import MeasureRequests, RequestMetrics
from services.mapstore.gateway.live_map import LiveMap
from services.mapstore.gateway.models import ErrorAnswer
from services.mapstore.gateway.parameters import check_names
from services.mapstore.gateway.request_limits import BodyLimit
from services.mapstore.gateway.routes import density, health, map_files, objects, page, pose
from services.runtime.config.mapstore import MapstoreConfig
from services.runtime.errors import InputError

_DESCRIPTION = (
    "How much moves around a pose, where the robot is, and what the map looks like. Lengths are in metres where "
    "`scale` is metric, in map units where it is arbitrary. The map frame has x forward and z up (REP-103)."
)


def create_app(live: LiveMap, options: MapstoreConfig) -> FastAPI:
    """The application over `live`. Bad parameters get 422, all errors `{"detail": "<one line>"}`."""
    metrics = RequestMetrics(live)
    app = FastAPI(
        title="kinemap",
        version="1",
        description=_DESCRIPTION,
        docs_url=None,  # FastAPI's pages load scripts from the network; routes/page.py serves one that does not
        redoc_url=None,
        dependencies=[Depends(_known_parameters)],
        responses={422: {"model": ErrorAnswer, "description": "a bad parameter"}},
    )
    app.include_router(density.router(live, options))
    app.include_router(pose.router(live))
    app.include_router(objects.router(live))
    app.include_router(map_files.router(live))
    app.include_router(health.router(live, metrics.registry))
    app.include_router(page.router(live))
    app.add_exception_handler(InputError, _bad_input)
    app.add_exception_handler(HTTPException, _refused)
    app.add_exception_handler(RequestValidationError, _not_valid)
    app.add_middleware(BodyLimit, max_bytes=options.max_body_bytes)
    app.add_middleware(MeasureRequests, metrics=metrics)
    return app


async def _known_parameters(request: Request) -> None:
    route = request.scope.get("route")
    known = [field.alias for field in route.dependant.query_params] if isinstance(route, APIRoute) else []
    check_names([name for name, _ in request.query_params.multi_items()], known)


async def _bad_input(_request: Request, error: Exception) -> JSONResponse:
    return JSONResponse({"detail": str(error)}, status_code=422)


async def _refused(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, HTTPException)
    detail = error.detail
    if error.status_code == 404:
        detail = f"{request.url.path[:60]}: no such page; see /docs"
    elif error.status_code == 405:
        detail = f"{request.method} {request.url.path[:60]}: expected GET"
    return JSONResponse({"detail": detail}, status_code=error.status_code, headers=error.headers)


async def _not_valid(_request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, RequestValidationError)
    problem = error.errors()[0]
    detail = f"{problem['loc'][-1]}: {problem['msg'][:1].lower()}{problem['msg'][1:]}"
    return JSONResponse({"detail": detail}, status_code=422)
