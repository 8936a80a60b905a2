# SPDX-License-Identifier: Apache-2.0
"""Whether an object moves, from what each frame says about it."""

from dataclasses import dataclass

import numpy as np

from schemas.records import MotionState


@dataclass(frozen=True)
class MotionFilterOptions:
    """How long a frame's evidence counts, and how much of it decides."""

    memory: float = 0.85
    """share of the log-odds that the next frame still counts: errors of neighbouring frames are alike"""
    decided_log_odds: float = 1.5
    largest_log_odds: float = 4.0
    largest_frame_log_odds: float = 3.0
    carried_weight: float = 0.5
    """of evidence on a mask that was carried here by the flow"""


@dataclass(frozen=True)
class MotionBelief:
    """The log-odds that an object moves, and what was last decided: the state stays until the opposite is decided."""

    log_odds: float = 0.0
    state: MotionState = MotionState.UNDECIDED

    @property
    def moving_probability(self) -> float:
        """0..1"""
        return float(1.0 / (1.0 + np.exp(-self.log_odds)))


def update_belief(
    belief: MotionBelief, moving_probability: float, samples: int, age_frames: int, options: MotionFilterOptions
) -> MotionBelief:
    """The belief after one more frame; one without evidence (p = 0.5) leaves it as it is.

    Sums log-odds with a decay, so that a parked car that drives off is found moving two or three frames later however
    long it stood, and decides with a hysteresis of twice `decided_log_odds`.
    """
    if samples == 0 or moving_probability == 0.5:
        return belief
    probability = float(np.clip(moving_probability, 1e-6, 1.0 - 1e-6))
    news = float(np.log(probability / (1.0 - probability)))
    news = float(np.clip(news, -options.largest_frame_log_odds, options.largest_frame_log_odds))
    if age_frames > 0:
        news *= options.carried_weight
    limit = options.largest_log_odds
    log_odds = float(np.clip(options.memory * belief.log_odds + news, -limit, limit))
    if log_odds > options.decided_log_odds:
        return MotionBelief(log_odds, MotionState.MOVING)
    if log_odds < -options.decided_log_odds:
        return MotionBelief(log_odds, MotionState.NON_MOVING)
    return MotionBelief(log_odds, belief.state)
