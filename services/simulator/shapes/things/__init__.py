# SPDX-License-Identifier: Apache-2.0
"""Shapes of what stands beside streets and in rooms."""
