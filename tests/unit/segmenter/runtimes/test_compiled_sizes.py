# SPDX-License-Identifier: Apache-2.0
from services.segmenter.runtimes.compiled_sizes import CompiledSizes


def test_the_last_sizes_stay_compiled() -> None:
    made = []
    sizes = CompiledSizes(lambda height, width: made.append((height, width)) or (height, width))
    for height in (1, 2, 3, 4, 1, 5, 1, 2):
        assert sizes.of(height, 7) == (height, 7)
    assert [height for height, _ in made] == [1, 2, 3, 4, 5, 2]
