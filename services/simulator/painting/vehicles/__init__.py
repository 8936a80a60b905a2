# SPDX-License-Identifier: Apache-2.0
"""Painted sides and ends of vehicles."""
