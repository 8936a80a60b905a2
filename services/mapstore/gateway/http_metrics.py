# SPDX-License-Identifier: Apache-2.0
"""What Prometheus scrapes: the map's size and state, and the gateway's own requests."""

import time
from collections.abc import Iterator

from prometheus_client import CollectorRegistry, Counter, Histogram, ProcessCollector
from prometheus_client.core import GaugeMetricFamily
from prometheus_client.registry import Collector
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from schemas.records import MotionState
from services.mapstore.gateway.live_map import LiveMap

_BUCKETS_S = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.25, 1.0)


class MapCollector(Collector):
    """Reads the newest view when it is scraped."""

    def __init__(self, live: LiveMap) -> None:
        self._live = live

    def collect(self) -> Iterator[GaugeMetricFamily]:
        """Gauges of the map."""
        view = self._live.view
        landmarks = GaugeMetricFamily("kinemap_landmarks", "Landmarks in the map by label", labels=["state"])
        for state, count in zip(MotionState, view.counts_by_state().tolist(), strict=True):
            landmarks.add_metric([state.name.lower()], count)
        yield landmarks
        yield GaugeMetricFamily("kinemap_dense_points", "Points of the semi-dense map", value=view.dense_points)
        in_use = int((view.keyframes.culled == 0).sum())
        yield GaugeMetricFamily("kinemap_keyframes", "Keyframes that are not culled", value=in_use)
        yield GaugeMetricFamily("kinemap_frame_sequence", "Newest frame in the map, -1: none", value=view.sequence)
        yield GaugeMetricFamily(
            "kinemap_frame_time_seconds", "Its capture time, on the camera's clock", value=view.timestamp_ns / 1e9
        )
        yield GaugeMetricFamily("kinemap_tracking_state", "0 initializing, 1 tracking, 2 lost", value=int(view.state))
        yield GaugeMetricFamily(
            "kinemap_metric_scale", "1: lengths are in metres, 0: in map units", value=int(view.metric_scale)
        )


class RequestMetrics:
    """Counters of requests by route, in a registry of their own."""

    def __init__(self, live: LiveMap) -> None:
        self.registry = CollectorRegistry()
        self.registry.register(MapCollector(live))
        ProcessCollector(registry=self.registry)
        self._requests = Counter(
            "kinemap_http_requests", "Requests answered", ["path", "status"], registry=self.registry
        )
        self._seconds = Histogram(
            "kinemap_http_request_seconds",
            "Time to answer a request",
            ["path"],
            buckets=_BUCKETS_S,
            registry=self.registry,
        )

    def observe(self, path: str, status: int, seconds: float) -> None:
        """One answered request."""
        self._requests.labels(path, str(status)).inc()
        self._seconds.labels(path).observe(seconds)


class MeasureRequests:
    """ASGI middleware that counts; a path that is no route counts as `other`, so that strangers cannot make series."""

    def __init__(self, app: ASGIApp, metrics: RequestMetrics) -> None:
        self._app = app
        self._metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        started, status = time.perf_counter(), 500

        async def noting_status(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
            await send(message)

        try:
            await self._app(scope, receive, noting_status)
        finally:
            path = getattr(scope.get("route"), "path", "other")
            self._metrics.observe(path, status, time.perf_counter() - started)
