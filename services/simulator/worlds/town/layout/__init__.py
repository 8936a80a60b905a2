# SPDX-License-Identifier: Apache-2.0
"""What stands in a town: the surveyed plan turned into meshes."""
