# SPDX-License-Identifier: Apache-2.0
"""Shapes of houses and of what a town has once."""
