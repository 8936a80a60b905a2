# SPDX-License-Identifier: Apache-2.0
"""A town: a closed loop of streets over several blocks."""
