# SPDX-License-Identifier: Apache-2.0
"""Where images come from, all behind `Source`; `detect.open_source` says which source an input is."""
