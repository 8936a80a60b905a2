# SPDX-License-Identifier: Apache-2.0
"""The live page, the documentation page, and what the live page polls. Nothing in them comes from the network."""

from pathlib import Path
from typing import Any

from fastapi import APIRouter, Response
from fastapi.responses import HTMLResponse

from services.mapstore.gateway.live_map import BuiltOnce, LiveMap
from services.mapstore.gateway.top_view import top_view

_PAGES = Path(__file__).parent.parent / "page"
_BINARY: dict[int | str, dict[str, Any]] = {
    200: {"content": {"application/octet-stream": {}}, "description": "little-endian, see the description"}
}


def router(live: LiveMap) -> APIRouter:
    """The routes over `live`."""
    routes = APIRouter()
    seen_from_above = BuiltOnce(top_view)

    @routes.get("/", include_in_schema=False)
    async def page() -> HTMLResponse:
        return HTMLResponse((_PAGES / "live.html").read_text(encoding="utf-8"))

    @routes.get("/live.js", include_in_schema=False)
    async def script() -> Response:
        return Response((_PAGES / "live.js").read_text(encoding="utf-8"), media_type="text/javascript")

    @routes.get("/docs", include_in_schema=False)
    async def docs() -> HTMLResponse:
        return HTMLResponse((_PAGES / "docs.html").read_text(encoding="utf-8"))

    @routes.get("/map/top_view", summary="The map from above", response_class=Response, responses=_BINARY, tags=["map"])
    def map_top_view() -> Response:
        """For drawing: uint32 points, uint32 poses, then float32 x y state for each point (an even sample of at most
        some 20000) and float32 x y for each pose."""
        return Response(seen_from_above.of(live.view), media_type="application/octet-stream")

    return routes
