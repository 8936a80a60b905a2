# SPDX-License-Identifier: Apache-2.0
"""Ways to compute what is dense in a network, from image to the head's output: libraries, and numbers of fewer bits.

What follows, from the head's output to instances, is computed in torch whatever the way.
"""
