# SPDX-License-Identifier: Apache-2.0
"""Textures, all painted by the program."""
