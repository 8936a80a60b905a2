# SPDX-License-Identifier: Apache-2.0
"""SOLOv2 (Wang et al., "SOLOv2: Dynamic and Fast Instance Segmentation", NeurIPS 2020) in plain torch.

Modules and parameters have the names that mmdetection gives them, so that its checkpoints load as they are.
"""
