# SPDX-License-Identifier: Apache-2.0
"""`kinemap dataset`: tools to build a data set of moving objects, and to look at one."""
