# SPDX-License-Identifier: Apache-2.0
"""Painted textures of an office floor."""
