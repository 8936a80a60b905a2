# SPDX-License-Identifier: Apache-2.0
"""One file a source of images, all behind `Source`; `open_source` says which one an input is."""
