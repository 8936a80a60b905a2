# SPDX-License-Identifier: Apache-2.0
"""How SOLOv2 learns: samples, what is done to them, what each grid cell shall answer, losses, and the loop."""
