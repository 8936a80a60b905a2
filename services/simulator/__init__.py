# SPDX-License-Identifier: Apache-2.0
"""A street with ground truth: image, depth, instances, motion and pose as pure functions of (options, index)."""
