# SPDX-License-Identifier: Apache-2.0
"""Recorded messages: sessions of kinemap's own, bags of ROS 1 and 2, MCAP with messages of ROS 2 or Foxglove."""
