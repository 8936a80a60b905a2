# SPDX-License-Identifier: Apache-2.0
"""Meshes of everything that stands or moves."""
