# SPDX-License-Identifier: Apache-2.0
"""The `kinemap` command: one file a command, nothing of the pipeline's work in here."""
