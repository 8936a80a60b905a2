# SPDX-License-Identifier: Apache-2.0
"""The segmenter: which pixels of an image are one potentially dynamic object."""
