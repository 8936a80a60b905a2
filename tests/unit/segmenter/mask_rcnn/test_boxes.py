# SPDX-License-Identifier: Apache-2.0
import pytest
import torch

from services.segmenter.mask_rcnn.boxes import decode, pairwise_iou, suppressed

UNIT = (1.0, 1.0, 1.0, 1.0)


def test_nothing_said_is_the_anchor_itself() -> None:
    anchors = torch.tensor([[10.0, 20.0, 30.0, 60.0]])
    assert decode(anchors, torch.zeros(1, 4), UNIT, (100, 100)).tolist() == [[10, 20, 30, 60]]


def test_shifts_are_in_sizes_and_scalings_in_logarithms() -> None:
    anchors = torch.tensor([[10.0, 20.0, 30.0, 60.0]])
    deltas = torch.tensor([[0.5, -0.25, 2 * torch.log(torch.tensor(2.0)), 0.0]])
    found = decode(anchors, deltas, (1.0, 1.0, 0.5, 1.0), (100, 100))
    # centre (20, 40) to (30, 30), width 20 to 40, height 40
    assert found[0].tolist() == pytest.approx([10, 10, 50, 50])


def test_boxes_end_at_the_image() -> None:
    anchors = torch.tensor([[-10.0, -5.0, 300.0, 60.0]])
    assert decode(anchors, torch.zeros(1, 4), UNIT, (50, 200)).tolist() == [[0, 0, 200, 50]]


def test_overlap_of_every_pair() -> None:
    boxes = torch.tensor([[0.0, 0.0, 10.0, 10.0], [5.0, 0.0, 15.0, 10.0], [20.0, 0.0, 30.0, 10.0]])
    iou = pairwise_iou(boxes)
    assert iou[0].tolist() == pytest.approx([1, 50 / 150, 0])
    assert torch.equal(iou, iou.T)


def test_the_surest_of_a_group_is_left() -> None:
    boxes = torch.tensor(
        [[0.0, 0.0, 10.0, 10.0], [1.0, 0.0, 11.0, 10.0], [1.0, 0.0, 11.0, 10.0], [40.0, 0.0, 50.0, 9.0]]
    )
    scores = torch.tensor([0.5, 0.9, 0.7, 0.1])
    one_group = suppressed(boxes, scores, torch.tensor([0, 0, 0, 0]), 0.5)
    assert one_group.tolist() == [1, 3]
    assert suppressed(boxes, scores, torch.tensor([0, 1, 2, 0]), 0.5).tolist() == [1, 2, 0, 3]


def test_what_is_suppressed_suppresses_nothing() -> None:
    boxes = torch.tensor([[0.0, 0.0, 10.0, 10.0], [3.0, 0.0, 13.0, 10.0], [6.0, 0.0, 16.0, 10.0]])
    kept = suppressed(boxes, torch.tensor([0.9, 0.8, 0.7]), torch.zeros(3), 0.4)
    assert kept.tolist() == [0, 2]


def test_no_boxes() -> None:
    assert suppressed(torch.zeros(0, 4), torch.zeros(0), torch.zeros(0), 0.5).tolist() == []
