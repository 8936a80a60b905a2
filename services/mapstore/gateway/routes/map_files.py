# SPDX-License-Identifier: Apache-2.0
"""GET /map/snapshot and /trajectory: the current map as the files that `kinemap export` writes."""

from typing import Annotated, Any

from fastapi import APIRouter, Query, Response

from services.mapstore.export.kitti import trajectory_kitti
from services.mapstore.export.pcd import map_pcd
from services.mapstore.export.tum import trajectory_tum
from services.mapstore.gateway.live_map import BuiltOnce, LiveMap
from services.mapstore.gateway.parameters import parse_format

_PCD: dict[int | str, dict[str, Any]] = {
    200: {"content": {"application/octet-stream": {}}, "description": "binary PCD 0.7"}
}
_TEXT: dict[int | str, dict[str, Any]] = {200: {"content": {"text/plain": {}}, "description": "one pose a line"}}


def router(live: LiveMap) -> APIRouter:
    """The routes over `live`."""
    routes = APIRouter(tags=["map"])
    snapshot = BuiltOnce(lambda view: map_pcd(view, view.map_id))
    trajectories = {
        "tum": BuiltOnce(lambda view: trajectory_tum(view, view.map_id)),
        "kitti": BuiltOnce(lambda view: trajectory_kitti(view, view.map_id)),
    }

    @routes.get("/map/snapshot", summary="The map's points", response_class=Response, responses=_PCD)
    def map_snapshot(format: Annotated[str, Query(description="pcd")] = "pcd") -> Response:  # noqa: A002
        """x y z rgb state category object_id; green is background, yellow may move, red moves."""
        parse_format(format, ["pcd"])
        return _file(snapshot.of(live.view), "application/octet-stream", "map.pcd")

    @routes.get("/trajectory", summary="The camera's way", response_class=Response, responses=_TEXT)
    def trajectory(format: Annotated[str, Query(description="tum or kitti")] = "tum") -> Response:  # noqa: A002
        """map_from_camera of every tracked frame as it is known now."""
        name = parse_format(format, trajectories)
        return _file(trajectories[name].of(live.view), "text/plain", f"trajectory.{name}")

    return routes


def _file(content: bytes | str, media_type: str, name: str) -> Response:
    headers = {"Content-Disposition": f'inline; filename="{name}"'}
    return Response(content, media_type=media_type, headers=headers)
