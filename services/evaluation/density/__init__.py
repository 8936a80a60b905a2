# SPDX-License-Identifier: Apache-2.0
"""The density that a map gave beside the true one."""
