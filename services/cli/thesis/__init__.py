# SPDX-License-Identifier: Apache-2.0
"""`kinemap thesis`: tables of the thesis, Robust map building for robot navigation in dynamic environments, 2021."""
