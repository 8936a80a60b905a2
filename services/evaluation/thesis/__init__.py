# SPDX-License-Identifier: Apache-2.0
"""The tables and figures of the thesis (Robust map building for robot navigation in dynamic environments, 2021)."""
