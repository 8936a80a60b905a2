# SPDX-License-Identifier: Apache-2.0
"""Every message of a session to disk, and back onto the bus."""
