# SPDX-License-Identifier: Apache-2.0
"""Objects followed over time beside true ones."""
