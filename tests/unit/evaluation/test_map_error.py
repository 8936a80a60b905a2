# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import numpy as np
import pytest

from schemas.records import MotionState
from services.evaluation.map.error import MapError, MapErrorRules, map_error
from services.evaluation.map.plots import plot_label_confusion, plot_map_error
from services.evaluation.map.table import describe_map_error, map_rows
from services.evaluation.trajectory.ground_plane import FLAT
from services.formats.point_cloud import LabelledPoints
from services.runtime.errors import InputError

STATIC, NON_MOVING, MOVING, UNDECIDED = 0, 1, 2, 3


def _points(*rows: tuple[float, float, float, int], name: str = "points") -> LabelledPoints:
    table = np.array(rows, dtype=np.float64).reshape(-1, 4)
    return LabelledPoints(table[:, :3], table[:, 3].astype(np.uint8), name)


SURFACE = _points(
    *((float(x), 0.0, 0.0, STATIC) for x in range(10)), (20.0, 0.0, 0.0, NON_MOVING), (30.0, 0.0, 0.0, MOVING)
)
LANDMARKS = _points(
    (0.0, 0.0, 0.1, STATIC),
    (3.0, 0.3, 0.0, NON_MOVING),
    (20.0, 0.0, 0.2, UNDECIDED),
    (20.0, 0.4, 0.0, NON_MOVING),
    (30.0, 0.4, 0.0, MOVING),
    (50.0, 0.0, 0.0, MOVING),
    (9.0, 2.0, 0.0, STATIC),
)


def _compared(**changes: object) -> MapError:
    given = {"landmarks": LANDMARKS, "surface": SURFACE, **changes}
    return map_error(**given)  # type: ignore[arg-type]


def test_distances_are_of_what_stands_in_both_directions() -> None:
    error = _compared()
    assert (error.landmarks, error.compared, error.accuracy.points) == (7, 7, 5)
    distances = [0.1, 0.3, 0.2, 0.4, 2.0]
    assert error.accuracy.mean_m == pytest.approx(np.mean(distances))
    assert error.accuracy.median_m == pytest.approx(0.3)
    assert error.accuracy.share_near == pytest.approx(2 / 5)
    np.testing.assert_allclose(error.landmark_distance_m, [0.1, 0.3, 0.2, 0.4, np.nan, np.nan, 2.0])
    back = [0.1, np.hypot(1, 0.1), np.hypot(1, 0.3), 0.3, np.hypot(1, 0.3), np.hypot(2, 0.3)]
    back += [np.hypot(3, 0.3), np.hypot(2, 2), np.hypot(1, 2), 2.0, 0.2]
    assert error.completeness.points == 11
    assert error.completeness.mean_m == pytest.approx(np.mean(back))
    assert error.chamfer_m == pytest.approx((np.mean(distances) + np.mean(back)) / 2)


def test_labels_are_of_the_nearest_surface_point_if_one_is_near() -> None:
    error = _compared()
    assert error.confusion.tolist() == [[1, 1, 0, 0], [0, 1, 0, 1], [0, 0, 1, 0]]
    assert error.off_surface.tolist() == [1, 0, 1, 0]
    assert error.label_accuracy == pytest.approx(3 / 5)
    assert error.precision(MotionState.NON_MOVING) == pytest.approx(0.5)
    assert error.recall(MotionState.STATIC) == pytest.approx(0.5)
    assert _compared(rules=MapErrorRules(label_within_m=0.15)).confusion.sum() == 1


def test_a_surface_without_what_moves_says_nothing_of_it() -> None:
    standing = SURFACE.chosen(SURFACE.state != MOVING)
    error = _compared(surface=standing)
    assert not error.moving_known
    assert error.confusion[:, 2].sum() == error.off_surface[2] == 0
    assert error.recall(MotionState.MOVING) is None
    assert error.precision(MotionState.MOVING) is None
    assert any("not in this surface" in value for _, value in map_rows(error, MapErrorRules()))


def test_only_what_is_near_the_path_is_compared() -> None:
    error = _compared(path_m=np.zeros((1, 3)), rules=MapErrorRules(within_m=8.5))
    assert (error.compared, error.accuracy.points, error.completeness.points) == (2, 2, 9)
    assert error.surface_points == 9


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"landmarks": _points(name="map.pcd")}, r"map\.pcd: no point of what stands, expected one at least"),
        ({"landmarks": _points((0, 0, 0, MOVING), name="map.pcd")}, "no point of what stands, expected"),
        ({"surface": _points((0, 0, 0, MOVING), name="s.ply")}, r"s\.ply: no point of what stands"),
        ({"surface": _points((0, 0, 0, UNDECIDED), name="s.ply")}, "surface point of state 3, expected 0, 1 or 2"),
        ({"path_m": np.full((1, 3), 1e4)}, r"no point of what stands within 40 m of the path"),
    ],
)
def test_nothing_to_compare_is_one_clear_line(changes: dict[str, object], expected: str) -> None:
    with pytest.raises(InputError, match=expected) as raised:
        _compared(**changes)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("field", ["within_m", "near_m", "label_within_m"])
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan")])
def test_rules_out_of_range_are_refused(field: str, value: float) -> None:
    with pytest.raises(InputError, match="expected a number above 0"):
        MapErrorRules(**{field: value})


def test_text_json_and_pictures(tmp_path: Path) -> None:
    error, rules = _compared(), MapErrorRules()
    rows = dict(map_rows(error, rules))
    assert rows["compared"] == "7 of 7 landmarks (100.0%), 12 points of surface"
    assert rows["truly non_moving, called"] == "0 static, 1 non_moving, 0 moving, 1 other"
    assert rows["label accuracy"] == "0.600 (5 of 7 within 0.5 m of a surface)"
    assert describe_map_error(error, rules)["recall"] == {"static": 0.5, "non_moving": 0.5, "moving": 1.0}
    plot_map_error(LANDMARKS, SURFACE, error, FLAT, tmp_path / "map_error.png")
    plot_label_confusion(error, tmp_path / "map_labels.png")
    for name in ("map_error", "map_labels"):
        assert (tmp_path / f"{name}.png").read_bytes().startswith(b"\x89PNG")
