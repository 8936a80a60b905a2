# SPDX-License-Identifier: Apache-2.0
"""`kinemap bench`: many runs of the pipeline, side by side."""
