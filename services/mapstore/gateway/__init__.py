# SPDX-License-Identifier: Apache-2.0
"""The map over HTTP: what a person or a planner sees."""
