# SPDX-License-Identifier: Apache-2.0
"""What can move, and how."""
