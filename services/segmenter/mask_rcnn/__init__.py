# SPDX-License-Identifier: Apache-2.0
"""Mask R-CNN (He et al., ICCV 2017) on a feature pyramid, as mmdetection 3.x has it: the thesis' baseline.

Parameters have the names of its checkpoints. Inference only.
"""
