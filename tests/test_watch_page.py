"""The tables of docs/watch.md are those of the settings and of the last measurement."""

import watch_page


def test_the_page_is_fresh() -> None:
    text = watch_page.PAGE.read_text()
    assert watch_page.page(text) == text, "run: python tests/reference/watch_page.py --write"
