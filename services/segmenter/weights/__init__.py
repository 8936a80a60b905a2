# SPDX-License-Identifier: Apache-2.0
"""Where the segmenter's weights come from: public checkpoints, files of the user, what is shipped."""
