"""docs/real-records.md has what tests/frozen says today."""

import real_records_page


def test_the_page_is_fresh() -> None:
    assert real_records_page.PAGE.read_text(encoding="utf-8") == real_records_page.page(), (
        "run: python tests/reference/real_records_page.py --write"
    )
