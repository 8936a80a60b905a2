# SPDX-License-Identifier: Apache-2.0
"""`kinemap weights`: the networks that find objects."""
