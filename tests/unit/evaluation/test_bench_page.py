# SPDX-License-Identifier: Apache-2.0
"""A page of measurements: each table between its own markers, and nothing else touched."""

from pathlib import Path

import pytest

from services.evaluation.measurements_page import check_page, machine, markdown_table, put_table
from services.runtime.errors import InputError

PAGE = """# Page

by hand, before

<!-- speed: begin -->
old
<!-- speed: end -->

by hand, after
<!-- other: begin --><!-- other: end -->
"""


@pytest.fixture
def page(tmp_path: Path) -> Path:
    """A page with two tables."""
    path = tmp_path / "page.md"
    path.write_text(PAGE)
    return path


def test_only_what_is_between_the_markers_changes(page: Path) -> None:
    block = put_table(page, "speed", "kinemap bench", "| new |")
    assert page.read_text() == PAGE.replace("<!-- speed: begin -->\nold\n<!-- speed: end -->", block)
    assert block.split("\n")[1:4] == ["`kinemap bench`", f"({machine()})", ""]
    assert "old" not in page.read_text()
    put_table(page, "speed", "kinemap bench", "| newer |")
    assert page.read_text().count("speed: begin") == 1
    assert [path.name for path in page.parent.iterdir()] == ["page.md"]


def test_a_page_without_the_markers_gets_a_section_and_then_has_them(page: Path) -> None:
    put_table(page, "stages", "kinemap bench", "| first |", title="The stages")
    text = page.read_text()
    assert text.startswith(PAGE)
    assert "\n\n## The stages\n\n<!-- stages: begin -->\n" in text
    put_table(page, "stages", "kinemap bench", "| second |", title="The stages")
    assert page.read_text() == text.replace("first", "second")


@pytest.mark.parametrize(
    ("text", "name", "part"),
    [
        ("<!-- a: begin -->", "a", "expected <!-- a: begin --> and <!-- a: end --> after it"),
        ("<!-- a: end --><!-- a: begin -->", "a", "after it, once each"),
        (2 * "<!-- a: begin --><!-- a: end -->", "a", "once each"),
        ("", "a b", "'a b': expected a name of letters"),
        ("", "", "'': expected a name"),
    ],
)
def test_a_page_that_cannot_be_written_is_left_alone(tmp_path: Path, text: str, name: str, part: str) -> None:
    page = tmp_path / "page.md"
    page.write_text(text)
    for use in (check_page, lambda *given: put_table(*given, "command", "table")):
        with pytest.raises(InputError, match=part):
            use(page, name)
    assert page.read_text() == text


def test_a_page_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.md: no such page"):
        check_page(tmp_path / "none.md", "a")


def test_a_cell_cannot_break_the_table() -> None:
    assert markdown_table(["a", "b"], [["1 | 2", "x\ny"]]) == "| a | b |\n| --- | --- |\n| 1 / 2 | x y |"
