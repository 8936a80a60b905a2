# SPDX-License-Identifier: Apache-2.0
"""`kinemap evaluate`: one file a subcommand; the numbers themselves are made in services.evaluation."""
