# SPDX-License-Identifier: Apache-2.0
"""RAFT (Teed and Deng, ECCV 2020) in plain torch, one file a part; parameters have the authors' names."""
