# SPDX-License-Identifier: Apache-2.0
"""From triangles and a pose to an image and the truth about each pixel."""
