# SPDX-License-Identifier: Apache-2.0
"""One run: its report, its pictures, its summary."""
