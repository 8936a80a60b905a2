# SPDX-License-Identifier: Apache-2.0
"""The tracker service: which instances are the same object over time, and whether it moves."""
