# SPDX-License-Identifier: Apache-2.0
"""`kinemap train`: makes what the services ship or load."""
