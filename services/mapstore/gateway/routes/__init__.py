# SPDX-License-Identifier: Apache-2.0
"""The gateway's routes, one file a group. Quick ones are coroutines; where work grows with the map, threads do it."""
