# SPDX-License-Identifier: Apache-2.0
"""The HTTP gateway over a map in memory: what it answers, and how it refuses."""

import json
import math
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fastapi.testclient import TestClient

from schemas.records import MappedObject, MappedObjects, MotionState
from services.mapstore.base_pose import BasePose
from services.mapstore.density import DynamicDensity
from services.mapstore.export.pcd import map_pcd
from services.mapstore.export.tum import trajectory_tum
from services.mapstore.gateway.app import create_app
from services.mapstore.gateway.live_map import LiveMap
from services.mapstore.map_state import MapState
from services.runtime.config.mapstore import OPTICAL_TO_REP103, MapstoreConfig
from tests.unit.mapstore.street_map import state_of, tracked, view_of, waiting

FRAMES = 21
PAGES = Path(__file__).resolve().parents[2] / "services" / "mapstore" / "gateway" / "page"


def live_map(state: MapState, base_from_camera: tuple[float, ...] = OPTICAL_TO_REP103) -> LiveMap:
    return LiveMap(state.view(), DynamicDensity(), BasePose(np.array(base_from_camera)))


def client_of(live: LiveMap) -> TestClient:
    return TestClient(create_app(live, MapstoreConfig()), raise_server_exceptions=False)


@pytest.fixture
def client() -> Iterator[TestClient]:
    with client_of(live_map(state_of(FRAMES))) as client:
        yield client


def test_density_at_the_robot(client: TestClient) -> None:
    answer = client.get("/density?pose=current&radius=30").json()
    assert answer == {
        "sequence": 20,
        "timestamp_ns": 2_000_000_000,
        "map_id": 1,
        "scale": "metric",
        "tracking": "tracking",
        "level": "high",
        "moving_points": 12,
        "moving_objects": 1,
        "observed_points": answer["observed_points"],
        "high_from_points": 10,
        "position": [20.0, 0.0, 0.0],
        "radius": 30.0,
        "radius_unit": "m",
        "window": 30.0,
        "reason": "",
    }


def test_density_of_all_time_at_a_place(client: TestClient) -> None:
    answer = client.get("/density", params={"pose": "20,0,0", "radius": "100", "window": "all"}).json()
    assert (answer["moving_points"], answer["window"]) == (60, "all")


def test_density_where_nobody_looked_is_unknown(client: TestClient) -> None:
    assert client.get("/density?pose=500,500,0").json()["level"] == "unknown"


def test_density_is_low_where_nothing_moves_now(client: TestClient) -> None:
    assert client.get("/density?pose=5,0,0&radius=2&window=0").json()["level"] == "low"


def test_before_the_first_pose_everything_answers() -> None:
    state = MapState()
    for ready in (False, True):
        with client_of(live_map(state)) as client:
            density, pose = client.get("/density").json(), client.get("/pose").json()
            assert (density["level"], density["position"], pose["tracked"]) == ("unknown", None, False)
            assert density["reason"] == pose["reason"] == ("too little parallax" if ready else "no pose yet")
            assert client.get("/readyz").status_code == (200 if ready else 503)
            assert client.get("/objects").json()["objects"] == []
            assert client.get("/trajectory").text == ""
            assert client.get("/map/top_view").content == bytes(8)
            assert b"POINTS 0" in client.get("/map/snapshot").content
        state.add_frame(0, waiting(0))


def test_pose_is_the_robots_and_says_its_scale(client: TestClient) -> None:
    answer = client.get("/pose").json()
    assert (answer["tracked"], answer["scale"], answer["position"]) == (True, "metric", [20.0, 0.0, 0.0])
    np.testing.assert_allclose(answer["orientation"], [0, 0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(answer["map_from_camera"], [20, 0, 0, -0.5, 0.5, -0.5, 0.5], atol=1e-12)


@pytest.mark.parametrize(("metric", "x"), [(True, -1.5), (False, 0.0)])
def test_the_cameras_place_on_the_robot_counts_where_there_are_metres(metric: bool, x: float) -> None:
    state = MapState()
    state.add_frame(0, tracked(0, 0, metric_scale=metric))
    with client_of(live_map(state, (1.5, 0.0, 0.0, *OPTICAL_TO_REP103[3:]))) as client:
        pose, density = client.get("/pose").json(), client.get("/density").json()
    np.testing.assert_allclose(pose["position"], [x, 0, 0], atol=1e-12)
    assert pose["scale"] == ("metric" if metric else "arbitrary")
    assert density["radius_unit"] == ("m" if metric else "map units")


def test_objects_say_what_they_are_and_where_they_were_seen_last(client: TestClient) -> None:
    car, parked = client.get("/objects").json()["objects"]
    assert (car["object_id"], car["category"], car["state"], car["landmarks"]) == (7, "car", "moving", 60)
    assert (parked["object_id"], parked["state"]) == (8, "non_moving")
    assert car["last_seen_ns"] == 2_000_000_000
    assert 28 <= car["position"][0] <= 32


def test_objects_of_the_newest_frame_have_a_velocity_and_a_size() -> None:
    state = state_of(FRAMES)
    last_ns = 2_000_000_000
    cuboid = MappedObject(7, "car", MotionState.MOVING, (31.0, 2.0, 0.75), (3.0, 4.0, 0.0), 0.9, (4, 2, 1.5), 0.3, 0.5)
    person = replace(cuboid, object_id=3, category="person", velocity=(0.0, 1.0, 0.0))
    state.see_objects(MappedObjects(last_ns, 1, True, (cuboid, person)))
    with client_of(live_map(state)) as client:
        walker, car, parked = client.get("/objects").json()["objects"]
    assert (car["velocity"], car["speed"], car["size"], car["heading"]) == ([3.0, 4.0, 0.0], 5.0, [4.0, 2.0, 1.5], 0.9)
    assert (car["position"], car["landmarks"]) == ([31.0, 2.0, 0.75], 60)
    assert car["first_seen_ns"] < car["last_seen_ns"] == last_ns
    assert (walker["object_id"], walker["landmarks"], walker["first_seen_ns"]) == (3, 0, last_ns)
    assert [parked[name] for name in ("velocity", "speed", "size", "heading")] == [None] * 4
    state.add_frame(FRAMES, tracked(FRAMES, 20, 1.0))
    with client_of(live_map(state)) as client:
        assert [o["velocity"] for o in client.get("/objects").json()["objects"]] == [None] * 2


def test_files_are_what_export_writes(client: TestClient) -> None:
    view = view_of(FRAMES)
    assert client.get("/map/snapshot?format=pcd").content == map_pcd(view, 1)
    assert client.get("/trajectory?format=tum").text == trajectory_tum(view, 1)
    assert len(client.get("/trajectory?format=kitti").text.splitlines()) == FRAMES


def test_the_view_from_above_is_the_map_and_the_way(client: TestClient) -> None:
    content = client.get("/map/top_view").content
    points, poses = np.frombuffer(content[:8], "<u4").tolist()
    assert (points, poses) == (200, FRAMES)
    rows = np.frombuffer(content[8 : 8 + 12 * points], "<f4").reshape(-1, 3)
    way = np.frombuffer(content[8 + 12 * points :], "<f4").reshape(-1, 2)
    assert sorted(set(rows[:, 2].tolist())) == [0.0, 1.0, 2.0]
    np.testing.assert_allclose(way[-1], [20, 0], atol=1e-6)


def test_the_same_question_has_the_same_answer_until_the_next_frame() -> None:
    state = state_of(3)
    live = live_map(state)
    with client_of(live) as client:
        here, wider = "/density?radius=5", "/density?radius=6"
        first = [client.get(url).json() for url in (here, wider)]
        assert [client.get(url).json() for url in (here, wider)] == first
        assert [answer["radius"] for answer in first] == [5.0, 6.0]
        state.add_frame(3, tracked(3, 0, 3.0))
        live.show(state.view())
        assert client.get(here).json()["position"] == [3.0, 0.0, 0.0]
        many = [client.get(f"/density?pose={x},0,0").json()["position"][0] for x in (*range(80), *range(80))]
        assert many == [*range(80), *range(80)]


def test_a_new_frame_shows_at_once() -> None:
    state = state_of(3)
    live = live_map(state)
    with client_of(live) as client:
        assert client.get("/pose").json()["sequence"] == 2
        before = client.get("/trajectory").text
        state.add_frame(3, tracked(3, 0, 3.0))
        live.show(state.view())
        assert client.get("/pose").json()["sequence"] == 3
        assert len(client.get("/trajectory").text) > len(before)


@pytest.mark.parametrize(
    ("url", "named"),
    [
        ("/density?pose=a,b,c", "pose=a,b,c: expected 'current' or x,y,z"),
        ("/density?pose=1,2", "pose=1,2: expected"),
        ("/density?pose=1,2,3,4", "pose=1,2,3,4: expected"),
        ("/density?pose=", "pose=: expected"),
        ("/density?pose=nan,0,0", "pose=nan,0,0: expected"),
        ("/density?pose=0,inf,0", "pose=0,inf,0: expected"),
        ("/density?pose=1e300,0,0", "pose=1e300,0,0: expected"),
        ("/density?pose=1_0,0,0", "pose=1_0,0,0: expected"),
        ("/density?radius=-1", "radius=-1: expected a number above 0 and up to 1000"),
        ("/density?radius=0", "radius=0: expected"),
        ("/density?radius=nan", "radius=nan: expected"),
        ("/density?radius=inf", "radius=inf: expected"),
        ("/density?radius=", "radius=: expected"),
        ("/density?radius=ten", "radius=ten: expected"),
        ("/density?window=-3", "window=-3: expected seconds from 0 to 1000000000, or 'all'"),
        ("/density?window=nan", "window=nan: expected"),
        ("/density?window=inf", "window=inf: expected"),
        ("/density?window=ever", "window=ever: expected"),
        ("/density?radus=5", "parameter radus: expected pose, radius, window"),
        ("/density?radius=5&radius=6", "parameter radius: given 2 times, expected once"),
        ("/map/snapshot?format=xyz", "format=xyz: expected pcd"),
        ("/trajectory?format=csv", "format=csv: expected tum or kitti"),
        ("/pose?frame=1", "parameter frame: expected no parameters"),
        ("/density?pose=" + "9" * 500, "pose=" + "9" * 60 + "...: expected"),
        ("/density?pose=%0Aevil", "pose=\N{REPLACEMENT CHARACTER}evil: expected"),
    ],
)
def test_a_bad_parameter_is_named_in_one_line(client: TestClient, url: str, named: str) -> None:
    answer = client.get(url)
    assert answer.status_code == 422
    assert answer.json()["detail"].startswith(named)
    assert "\n" not in answer.json()["detail"]
    assert answer.json().keys() == {"detail"}


def test_unknown_pages_and_methods_say_what_was_expected(client: TestClient) -> None:
    missing, posted = client.get("/densities"), client.post("/density")
    assert (missing.status_code, missing.json()) == (404, {"detail": "/densities: no such page; see /docs"})
    assert (posted.status_code, posted.json()) == (405, {"detail": "POST /density: expected GET"})


def test_a_body_is_refused_by_its_announced_size(client: TestClient) -> None:
    answer = client.request("GET", "/density", content=b"0" * 2000)
    assert answer.status_code == 413
    assert answer.json() == {"detail": "request body of 2000 bytes: expected at most 1024"}
    chunked = client.request("POST", "/density", content=(b"0" for _ in range(3)))
    assert chunked.status_code == 413
    assert chunked.json() == {"detail": "request body of unknown length: expected at most 1024 bytes"}


def test_metrics_count_the_map_and_the_requests(client: TestClient) -> None:
    client.get("/density")
    client.get("/density?radius=0")
    client.get("/no/such/page")
    text = client.get("/metrics").text
    assert 'kinemap_landmarks{state="moving"} 60.0' in text
    assert "kinemap_frame_sequence 20.0" in text
    assert 'kinemap_http_requests_total{path="/density",status="200"} 1.0' in text
    assert 'kinemap_http_requests_total{path="/density",status="422"} 1.0' in text
    assert 'kinemap_http_requests_total{path="other",status="404"} 1.0' in text


def test_health_names_the_session_and_the_size_of_its_map(client: TestClient) -> None:
    answer = client.get("/healthz").json()
    assert (answer["status"], answer["session"], answer["sequence"]) == ("ok", "drive", 20)
    assert answer["landmarks"] > 0
    assert answer["dense_points"] == 0
    assert client.get("/readyz").status_code == 200


def test_the_documentation_lists_every_route(client: TestClient) -> None:
    api = client.get("/openapi.json").json()
    routes = {"/density", "/pose", "/objects", "/map/snapshot", "/map/top_view", "/trajectory"}
    assert set(api["paths"]) == routes | {"/healthz", "/readyz", "/metrics"}
    assert {p["name"] for p in api["paths"]["/density"]["get"]["parameters"]} == {"pose", "radius", "window"}
    assert "ErrorAnswer" in json.dumps(api["paths"]["/density"]["get"]["responses"]["422"])


@pytest.mark.parametrize("path", ["/", "/docs", "/live.js"])
def test_pages_need_nothing_from_the_network(client: TestClient, path: str) -> None:
    answer = client.get(path)
    assert answer.status_code == 200
    assert not re.search(r"https?://|//cdn|@import", answer.text)
    for local in re.findall(r"(?:src|href)=\"(/[^\"]*)\"", answer.text):
        assert client.get(local).status_code == 200


def test_an_arbitrary_scale_is_said_with_every_answer() -> None:
    state = state_of(5)
    state.add_frame(5, replace(tracked(5, 5), metric_scale=False))
    with client_of(live_map(state)) as client:
        density = client.get("/density").json()
        assert (density["scale"], density["radius_unit"]) == ("arbitrary", "map units")
        assert client.get("/objects").json()["scale"] == "arbitrary"
        assert b"scale arbitrary" in client.get("/map/snapshot").content
    assert math.isfinite(density["radius"])
