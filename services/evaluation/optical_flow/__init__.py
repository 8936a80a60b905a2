# SPDX-License-Identifier: Apache-2.0
"""Flow beside the true one."""
