# SPDX-License-Identifier: Apache-2.0
"""File formats of the data sets of this field, one file a format: read and written. Knows numpy and dataclasses."""
