# SPDX-License-Identifier: Apache-2.0
"""The camera's optics and what its sensor does to an image."""
