# SPDX-License-Identifier: Apache-2.0
"""How good a run was: errors of trajectories and moving flags, reports, plots. Knows no bus."""
