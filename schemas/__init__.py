# SPDX-License-Identifier: Apache-2.0
"""What goes over the bus and into recordings: messages, topics, and their codec to numpy."""
