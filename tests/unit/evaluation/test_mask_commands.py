# SPDX-License-Identifier: Apache-2.0
"""`kinemap evaluate masks|moving|flow|tracking` as a user types them."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from services.formats.kitti_flow import FlowImage, write_kitti_flow
from services.formats.kitti_tracking import TrackedBox, write_kitti_tracking
from services.formats.label_images import LabelledInstance, write_label_image, write_label_index
from tests.command_line import Ended, run_kinemap

Evaluate = Callable[..., Ended]


@pytest.fixture
def evaluate(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Evaluate:
    """Runs `kinemap evaluate ARGUMENTS`."""
    monkeypatch.setenv("NO_COLOR", "1")

    def run(*arguments: str | Path) -> Ended:
        return run_kinemap(monkeypatch, capsys, "evaluate", *arguments)

    return run


def _label_folder(path: Path, shift: int, frames: int = 3) -> Path:
    """A car that drives and one that is parked, 48 px high."""
    path.mkdir()
    index = {}
    for frame in range(frames):
        labels = np.zeros((60, 160), dtype=np.uint8)
        labels[6:54, 4 + 8 * frame + shift : 44 + 8 * frame + shift] = 1
        labels[6:54, 100 + shift : 140 + shift] = 2
        write_label_image(path / f"{frame:06d}.png", labels)
        rows = [LabelledInstance(1, "car", 0.9, moving=True), LabelledInstance(2, "car", 0.8, moving=shift > 0)]
        index[f"{frame:06d}"] = rows
    write_label_index(path, index)
    return path


def _table(ended: Ended) -> dict[str, list[str]]:
    """The values of every row that has one, by what is measured."""
    assert ended.code == 0, ended
    rows = (line.strip().split("  ") for line in ended.out.splitlines())
    return {row[0]: [cell.strip() for cell in row[1:] if cell.strip()] for row in rows if len(row) > 1}


def _report(path: Path) -> dict[str, Any]:
    report: dict[str, Any] = json.loads(path.read_text())
    return report


def test_masks(evaluate: Evaluate, tmp_path: Path) -> None:
    truth, found = _label_folder(tmp_path / "truth", 0, 4), _label_folder(tmp_path / "found", 4)
    rows = _table(evaluate("masks", found, "--truth", truth, "--json", tmp_path / "m.json", "--plots", tmp_path / "p"))
    assert rows["recall (IoU 0.5, 40 px high, score 0.3)"] == ["-", "0.750"]
    report = _report(tmp_path / "m.json")
    assert report["frames"]["without_result"] == ["000003"]
    # IoU is 36 / 44 = 0.82: found up to 0.80, seven of COCO's ten thresholds, at a recall of 6 of 8
    assert report["mean"]["ap"] == pytest.approx(0.7 * 76 / 101)
    assert report["mean"]["by_iou"]["0.8"] == pytest.approx(76 / 101)
    assert report["mean"]["by_iou"]["0.9"] == 0.0
    assert {path.name for path in (tmp_path / "p").iterdir()} == {
        "class_confusion.png",
        "precision_by_iou.png",
        "precision_recall.png",
    }


def test_moving(evaluate: Evaluate, tmp_path: Path) -> None:
    truth, found = _label_folder(tmp_path / "truth", 0), _label_folder(tmp_path / "found", 4)
    rows = _table(evaluate("moving", found, "--truth", truth, "--json", tmp_path / "m.json", "--plots", tmp_path / "p"))
    assert rows["right / wrong / missed"] == ["3 / 3 / 0"]
    assert rows["precision of the flag, 40 px high and more"] == ["0.500"]
    assert rows["IoU, non-moving"] == ["0.000"]
    # what moves: 36 columns shared; found are 2 x 40, true 40
    assert _report(tmp_path / "m.json")["iou"]["moving"] == pytest.approx(36 / 84)
    assert {path.name for path in (tmp_path / "p").iterdir()} == {"moving_confusion.png", "moving_iou.png"}


def test_flow(evaluate: Evaluate, tmp_path: Path) -> None:
    for side, length in (("truth", 5.0), ("found", 9.0)):
        (tmp_path / side).mkdir()
        flow = np.full((20, 30, 2), (length, 0.0), dtype=np.float32)
        write_kitti_flow(tmp_path / side / "000000_10.png", FlowImage(flow, np.ones((20, 30), dtype=bool)))
    arguments = ("flow", tmp_path / "found", "--truth", tmp_path / "truth")
    rows = _table(evaluate(*arguments, "--json", tmp_path / "f.json", "--plots", tmp_path / "p"))
    assert rows["endpoint error, mean [px]"] == ["4.000", "-"]
    assert rows["Fl: above 3 px and 5 %"] == ["100.00%", "-"]
    assert _report(tmp_path / "f.json")["by_image"] == {"000000_10": {"epe_px": 4.0, "outliers": 1.0}}
    assert {path.name for path in (tmp_path / "p").iterdir()} == {"flow_errors.png", "flow_000000_10.png"}


def test_tracking(evaluate: Evaluate, tmp_path: Path) -> None:
    pytest.importorskip("trackeval", reason="extra tracking-evaluation is not installed")
    for side in ("truth", "found"):
        (tmp_path / side).mkdir()
        for sequence in ("0000", "0001"):
            ids = [1, 1, 1, 1] if side == "truth" or sequence == "0000" else [1, 1, 2, 2]
            boxes = [TrackedBox(n, i, "Car", (4.0 * n, 0.0, 4.0 * n + 40.0, 30.0), 0, 0) for n, i in enumerate(ids)]
            write_kitti_tracking(tmp_path / side / f"{sequence}.txt", boxes)
    arguments = ("tracking", tmp_path / "found", "--truth", tmp_path / "truth")
    rows = _table(evaluate(*arguments, "--json", tmp_path / "t.json", "--plots", tmp_path / "p"))
    assert rows["id switches"] == ["1"]
    assert rows["MOTA"] == ["0.875"]
    assert rows["HOTA in 0000"] == ["1.000"]
    assert rows["HOTA in 0001"] == [f"{0.5**0.5:.3f}"]
    assert _report(tmp_path / "t.json")["by_class"]["car"]["ass_a"] == pytest.approx((4 * 1.0 + 4 * 0.5) / 8)
    assert {path.name for path in (tmp_path / "p").iterdir()} == {"hota_by_iou.png", "hota_by_sequence.png"}


def test_nonsense_ends_in_one_line_and_code_2(evaluate: Evaluate, tmp_path: Path) -> None:
    folder = _label_folder(tmp_path / "folder", 0)
    (tmp_path / "file").write_text("1 2 3\n")
    (tmp_path / "empty").mkdir()
    for arguments, said in (
        (("masks", folder, "--truth", tmp_path / "none"), "none: no such file or folder"),
        (("masks", folder, "--truth", folder, "--category", "bus"), "category 'bus': not in the truth"),
        (("masks", tmp_path / "file", "--truth", tmp_path / "file"), "not JSON"),
        (("moving", tmp_path / "empty", "--truth", folder), "no masks, expected PNG files"),
        (("flow", tmp_path / "file", "--truth", tmp_path / "file"), "expected .png (KITTI flow) or .flo"),
        (("tracking", tmp_path / "file", "--truth", folder), "3 fields, expected MOTS text"),
        (("tracking", folder, "--truth", folder, "--plots", tmp_path / "file"), "is a file, expected a folder"),
    ):
        ended = evaluate(*arguments)
        assert ended.code == 2
        assert ended.out == ""
        assert ended.err.startswith("kinemap: error: ")
        assert ended.err.count("\n") == 1
        assert said in ended.err
