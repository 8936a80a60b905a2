# SPDX-License-Identifier: Apache-2.0
"""A Kalman filter of one object's place and velocity on the ground."""

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

_GATE = 16.0  # of the squared Mahalanobis distance; what lies further off counts less


class MotionFilter:
    """Constant velocity in x and y of the map; its acceleration is white noise (Bar-Shalom et al. 2001, ch. 6.2).

    Args:
        position: (2,), metres.
        covariance: (2, 2) of it.
        speed_sigma: how fast such objects may be at first, m/s.
    """

    def __init__(self, position: Array, covariance: Array, speed_sigma: float) -> None:
        self._state = np.append(position, [0.0, 0.0])
        self._covariance = np.zeros((4, 4))
        self._covariance[:2, :2] = covariance
        self._covariance[2:, 2:] = np.eye(2) * speed_sigma**2

    @property
    def position(self) -> Array:
        """(2,)"""
        return self._state[:2].copy()

    @property
    def velocity(self) -> Array:
        """(2,), m/s"""
        return self._state[2:].copy()

    @property
    def position_sigma(self) -> float:
        """Metres, the larger axis's."""
        return float(np.sqrt(np.linalg.eigvalsh(self._covariance[:2, :2])[-1]))

    @property
    def velocity_sigma(self) -> float:
        """m/s, the larger axis's."""
        return float(np.sqrt(np.linalg.eigvalsh(self._covariance[2:, 2:])[-1]))

    def predict(self, seconds: float, acceleration_sigma: float) -> None:
        """Move on by `seconds`."""
        step = np.eye(4)
        step[0, 2] = step[1, 3] = seconds
        gain = np.vstack((np.eye(2) * seconds**2 / 2, np.eye(2) * seconds))
        self._state = step @ self._state
        self._covariance = step @ self._covariance @ step.T + gain @ gain.T * acceleration_sigma**2

    def see(self, position: Array, covariance: Array) -> None:
        """Take in a measured place; an unlikely one counts less."""
        surprise = position - self._state[:2]
        expected = self._covariance[:2, :2] + covariance
        distance = float(surprise @ np.linalg.solve(expected, surprise))
        if distance > _GATE:
            expected = self._covariance[:2, :2] + covariance * distance / _GATE
        gain = np.linalg.solve(expected, self._covariance[:2]).T
        self._state = self._state + gain @ surprise
        self._covariance = self._covariance - gain @ self._covariance[:2]
        self._covariance = (self._covariance + self._covariance.T) / 2

    def stand(self, sigma: float) -> None:
        """Take in that the object stands, within `sigma` m/s."""
        expected = self._covariance[2:, 2:] + np.eye(2) * sigma**2
        gain = np.linalg.solve(expected, self._covariance[2:]).T
        self._state = self._state - gain @ self._state[2:]
        self._covariance = self._covariance - gain @ self._covariance[2:]
        self._covariance = (self._covariance + self._covariance.T) / 2
