# SPDX-License-Identifier: Apache-2.0
"""Masks of what moves beside true ones."""
