# SPDX-License-Identifier: Apache-2.0
"""A street, driven through once."""
