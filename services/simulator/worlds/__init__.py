# SPDX-License-Identifier: Apache-2.0
"""The worlds to drive through."""
