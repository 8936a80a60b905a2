# SPDX-License-Identifier: Apache-2.0
"""Dense optical flow behind one interface."""
