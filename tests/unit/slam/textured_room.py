# SPDX-License-Identifier: Apache-2.0
"""A street of textured walls with exact images and depth, rendered in a few lines of numpy."""

import cv2
import numpy as np
import numpy.typing as npt


class TexturedRoom:
    """A corridor 6 m wide and 4 m high that ends 40 m ahead; the camera drives along its middle.

    Args:
        seed: of the texture.
        width: of the images, px.
        height: of the images, px.
        focal_px: of the camera.
        fisheye: Kannala and Brandt's four coefficients; None: a pinhole.
    """

    def __init__(
        self,
        seed: int,
        width: int = 480,
        height: int = 240,
        focal_px: float = 300.0,
        fisheye: tuple[float, float, float, float] | None = None,
    ) -> None:
        self.width, self.height = width, height
        self.step_m = 0.4
        self.intrinsics = np.array([[focal_px, 0, width / 2], [0, focal_px, height / 2], [0, 0, 1]])
        random = np.random.default_rng(seed)
        noise = random.integers(0, 256, (256, 256)).astype(np.float32)
        self._texture = cv2.GaussianBlur(noise, (0, 0), 1.0)
        low, high = self._texture.min(), self._texture.max()
        self._texture = (self._texture - low) / (high - low) * 255
        columns, rows = np.meshgrid(np.arange(width), np.arange(height))
        pixels = np.stack([columns, rows], axis=-1).reshape(-1, 1, 2).astype(np.float64)
        if fisheye is None:
            flat = cv2.undistortPoints(pixels, self.intrinsics, None)
        else:
            flat = cv2.fisheye.undistortPoints(pixels, self.intrinsics, np.array(fisheye))
        self._rays = np.dstack([flat.reshape(height, width, 2), np.ones((height, width))])

    def render(self, index: int, right_m: float = 0.0) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.float32]]:
        """Image and depth along the optical axis in metres, seen from `index` steps down the corridor.

        Args:
            index: of the frame.
            right_m: how far to the right of the middle.
        """
        camera_z = index * self.step_m
        x, y = self._rays[..., 0], self._rays[..., 1]
        with np.errstate(divide="ignore"):
            depths = np.stack(
                [(3.0 - np.sign(x) * right_m) / np.abs(x), 2.0 / np.abs(y), np.full(x.shape, 40.0 - camera_z)]
            )
        wall = depths.argmin(axis=0)
        depth = depths.min(axis=0)
        point = self._rays * depth[..., None] + np.array([right_m, 0.0, 0.0])
        along = point[..., 2] + camera_z
        # Metres on the wall; each of the five walls starts elsewhere in the texture.
        u = np.where(wall == 2, point[..., 0], along)
        v = np.where(wall == 0, point[..., 1], np.where(wall == 1, point[..., 0], point[..., 1]))
        side = np.where(wall == 0, np.sign(x), np.where(wall == 1, 2 * np.sign(y), 5))
        texels_per_m = 12.0
        map_u = np.mod(u * texels_per_m + side * 37.0, 255).astype(np.float32)
        map_v = np.mod(v * texels_per_m + side * 61.0 + 100, 255).astype(np.float32)
        image = cv2.remap(self._texture, map_u, map_v, cv2.INTER_LINEAR)
        return image.astype(np.uint8), depth.astype(np.float32)
