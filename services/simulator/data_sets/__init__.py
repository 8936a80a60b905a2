# SPDX-License-Identifier: Apache-2.0
"""Drives as data sets on disk, in the layouts and formats that the rest of the field reads."""
