# SPDX-License-Identifier: Apache-2.0
"""Instance masks beside true ones."""
