# SPDX-License-Identifier: Apache-2.0
"""What is remembered: the durable map, how much moves in it, and the HTTP gateway to both."""
