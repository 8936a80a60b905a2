# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import cv2
import numpy as np
import pytest

from services.evaluation.optical_flow.error import FlowError, endpoint_error
from services.evaluation.optical_flow.inputs import find_flow_pairs
from services.evaluation.optical_flow.plots import error_colours, plot_flow_errors, plot_flow_pair
from services.evaluation.optical_flow.score import FlowScore, flow_score
from services.formats.kitti_flow import FlowImage, read_kitti_flow, write_kitti_flow
from services.formats.middlebury_flow import write_middlebury_flow
from services.runtime.errors import InputError


def _image(u: list[list[float]], valid: list[list[int]] | None = None) -> FlowImage:
    flow = np.zeros((*np.shape(u), 2), dtype=np.float32)
    flow[..., 0] = u
    return FlowImage(flow, np.ones(np.shape(u), dtype=bool) if valid is None else np.array(valid, dtype=bool))


def _error(truth: FlowImage, found: FlowImage) -> FlowError:
    error = FlowError()
    error.add(endpoint_error(truth, found), truth, truth.valid)
    return error


def test_errors_by_hand() -> None:
    truth = _image([[0, 5, 20, 100, 100, 7]], [[1, 1, 1, 1, 1, 0]])
    found = _image([[1, 9, 22, 104, 110, 90]])
    error = _error(truth, found)
    assert error.epe_px == pytest.approx((1 + 4 + 2 + 4 + 10) / 5)
    assert error.median_px == pytest.approx(4.0, abs=1 / 1024)
    assert error.outliers == pytest.approx(2 / 5)  # 4 of 5 px and 10 of 100 px; 4 of 100 px is below 5 %
    assert error.band_epe_px("s0-10") == pytest.approx(2.5)
    assert error.band_epe_px("s10-40") == pytest.approx(2.0)
    assert error.band_epe_px("s40+") == pytest.approx(7.0)
    assert error.density == 1.0


def test_a_pixel_without_an_estimate_is_an_outlier_and_has_no_error() -> None:
    error = _error(_image([[5, 5, 5, 5]]), _image([[5, 6, 0, 0]], [[1, 1, 0, 0]]))
    assert (error.epe_px, error.outliers, error.density) == (0.5, 0.5, 0.5)


def test_nothing_to_count_is_none() -> None:
    error = _error(_image([[5]], [[0]]), _image([[5]]))
    assert (error.epe_px, error.median_px, error.outliers, error.density) == (None, None, None, None)


def test_the_median_is_that_of_all_images() -> None:
    random = np.random.default_rng(5)
    total, errors = FlowError(), []
    for _ in range(4):
        truth = FlowImage(random.normal(0, 20, (30, 40, 2)).astype(np.float32), np.ones((30, 40), dtype=bool))
        found = FlowImage(truth.flow + random.normal(0, 3, truth.flow.shape).astype(np.float32), truth.valid)
        error = endpoint_error(truth, found)
        total.add(error, truth, truth.valid)
        errors.append(error.ravel())
    assert total.median_px == pytest.approx(float(np.median(np.concatenate(errors))), abs=2e-3)
    assert total.epe_px == pytest.approx(float(np.mean(np.concatenate(errors))), rel=1e-6)


def _folder(path: Path, images: dict[str, FlowImage]) -> Path:
    path.mkdir(parents=True)
    for name, image in images.items():
        write_kitti_flow(path / f"{name}.png", image)
    return path


def test_folders_with_occlusion(tmp_path: Path) -> None:
    truth = _image([[5, 5, 5]])
    _folder(tmp_path / "truth" / "flow_occ", {"0": truth, "1": truth})
    _folder(tmp_path / "truth" / "flow_noc", {"0": _image([[5, 5, 5]], [[1, 1, 0]]), "1": truth})
    found = _folder(tmp_path / "found", {"0": _image([[5, 6, 15]])})
    pairs = find_flow_pairs(found, tmp_path / "truth")
    assert pairs.missing == ("1",)
    score = flow_score(pairs)
    assert score.all.epe_px == pytest.approx(11 / 3)
    assert score.visible.epe_px == pytest.approx(0.5)
    assert score.by_image == {"0": (pytest.approx(11 / 3), pytest.approx(1 / 3))}


def test_formats_meet(tmp_path: Path) -> None:
    write_middlebury_flow(tmp_path / "found.flo", _image([[5, 7]]))
    write_kitti_flow(tmp_path / "truth.png", _image([[5, 5]]))
    score = flow_score(find_flow_pairs(tmp_path / "found.flo", tmp_path / "truth.png"))
    assert (score.all.epe_px, score.visible.true_pixels) == (1.0, 0)


def test_nonsense_is_one_clear_line(tmp_path: Path) -> None:
    truth = _folder(tmp_path / "truth", {"0": _image([[5, 5]])})
    unknown = _folder(tmp_path / "unknown", {"0": _image([[5, 5]], [[0, 0]])})
    (tmp_path / "empty").mkdir()
    (tmp_path / "a.txt").write_text("flow")

    def score(found: Path, against: Path) -> FlowScore:
        return flow_score(find_flow_pairs(found, against))

    for found, against, said in (
        (tmp_path / "none", truth, "none: no such file or folder"),
        (truth / "0.png", truth, "a file and a folder, expected two of a kind"),
        (tmp_path / "empty", truth, "no flow, expected .png"),
        (_folder(tmp_path / "other", {"7": _image([[5, 5]])}), truth, "expected names such as '0'; found '7'"),
        (_folder(tmp_path / "size", {"0": _image([[5]])}), truth, "0.png: flow of 1x1 px, expected 2x1"),
        (truth, unknown, "no pixel with a known flow"),
        (tmp_path / "a.txt", truth / "0.png", "a.txt: ends with '.txt', expected .png"),
    ):
        with pytest.raises(InputError) as error:
            score(found, against)
        assert said in str(error.value)


def test_error_colours_turn_red_at_the_outlier() -> None:
    truth = _image([[10, 10, 10, 200]])
    right, below, above, long = error_colours(np.array([[0.0, 2.9, 3.1, 9.0]], dtype=np.float32), truth)[0].astype(int)
    for blue in (right, below, long):
        assert blue[2] > blue[0]
    assert above[0] > above[2]


def test_pictures_are_the_same_every_time(tmp_path: Path) -> None:
    truth = _folder(tmp_path / "truth", {"0": _image([[5, 5, 50], [0, 0, 0]])})
    found = _folder(tmp_path / "found", {"0": _image([[5, 9, 20], [0, 0, 0]])})
    pairs = find_flow_pairs(found, truth)
    for name in ("a", "b"):
        plot_flow_errors(flow_score(pairs), tmp_path / f"errors_{name}.png")
        plot_flow_pair(pairs.pairs[0], tmp_path / f"pair_{name}.png")
    for picture in ("errors", "pair"):
        assert (tmp_path / f"{picture}_a.png").read_bytes() == (tmp_path / f"{picture}_b.png").read_bytes()
        assert cv2.imread(str(tmp_path / f"{picture}_a.png")) is not None


def test_dis_on_a_real_pair(shared_data: Path) -> None:
    folder = shared_data / "kitti_flow"
    images = [cv2.imread(str(folder / f"frame{n}.png"), cv2.IMREAD_GRAYSCALE) for n in (1, 2)]
    flow = cv2.DISOpticalFlow.create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM).calc(images[0], images[1], None)
    truth = read_kitti_flow(folder / "flow_gt.png")
    error = _error(truth, FlowImage(flow, np.ones(truth.valid.shape, dtype=bool)))
    still = _error(truth, FlowImage(np.zeros_like(flow), np.ones(truth.valid.shape, dtype=bool)))
    assert error.epe_px is not None
    assert still.epe_px is not None
    assert error.epe_px < 0.6 * still.epe_px  # a pair of up to 184 px: DIS loses the near car and road
    assert error.outliers is not None
    assert 0.2 < error.outliers < 0.7
    assert _error(truth, truth).epe_px == 0.0
