# SPDX-License-Identifier: Apache-2.0
"""Files of learned weights: fetched, checked, kept in the user's cache, read without running what is in them."""
