# SPDX-License-Identifier: Apache-2.0
"""Folders of image files: TUM RGB-D, EuRoC, images of one's own, and what all readers of image files need."""
