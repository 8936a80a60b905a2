# SPDX-License-Identifier: Apache-2.0
"""Painted fronts of houses."""
