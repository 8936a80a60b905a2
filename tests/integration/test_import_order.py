# SPDX-License-Identifier: Apache-2.0
"""The engine, OpenCV's wheel, Open3D and torch share a process, whichever is loaded first.

Open3D and Debian's OpenCV name the same libtbb; the first loaded serves both.
"""

import subprocess
import sys

import pytest

WORK = {
    "engine": """
import numpy as np
from services.slam import _engine
engine = _engine.Engine(_engine.CameraModel(160, 120, 100.0, 100.0, 80.0, 60.0), _engine.EngineOptions())
image = np.random.default_rng(1).integers(0, 255, (120, 160), dtype=np.uint8)
engine.begin_frame(0, image)
rows = [np.zeros(0, dtype) for dtype in (np.uint32, np.int32, np.uint8)]
assert engine.finish_frame(None, *rows, False).features > 100
""",
    "cv2": """
import cv2, numpy as np
image = np.random.default_rng(1).integers(0, 255, (120, 160), dtype=np.uint8)
assert cv2.goodFeaturesToTrack(image, 50, 0.01, 5) is not None
""",
    "open3d": """
import numpy as np, open3d as o3d
scene = o3d.t.geometry.RaycastingScene()
box = o3d.t.geometry.TriangleMesh.from_legacy(o3d.geometry.TriangleMesh.create_box())
scene.add_triangles(box)
hits = scene.cast_rays(o3d.core.Tensor(np.array([[0.3, 0.6, -1, 0, 0, 1]], dtype=np.float32)))
assert abs(hits["t_hit"][0].item() - 1.0) < 1e-5
""",
    "torch": """
import torch
assert torch.ones(64, 64).matmul(torch.ones(64, 64))[0, 0].item() == 64
""",
}


@pytest.mark.parametrize(
    "order",
    [
        ("engine", "cv2", "open3d", "torch"),
        ("cv2", "engine", "torch", "open3d"),
        ("open3d", "torch", "engine", "cv2"),
        ("torch", "open3d", "cv2", "engine"),
    ],
    ids="-".join,
)
def test_libraries_live_together(order: tuple[str, ...]) -> None:
    script = "".join(WORK[name] for name in (*order, *order))
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
