# SPDX-License-Identifier: Apache-2.0
"""Many runs side by side."""
