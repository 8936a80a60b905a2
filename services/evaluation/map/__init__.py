# SPDX-License-Identifier: Apache-2.0
"""Maps beside the true surface."""
