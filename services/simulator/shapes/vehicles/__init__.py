# SPDX-License-Identifier: Apache-2.0
"""Shapes of cars, buses, lorries and bicycles."""
