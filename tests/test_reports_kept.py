"""A report is made again where it is as the command made it, of the same table; else it needs --force."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"
Run = Callable[..., tuple[int, str]]


@pytest.mark.parametrize(
    "command",
    [
        ("diagnose",),
        ("calibrate", "--fit", "zero_error"),
        ("verify", "--maximum-permissible-error-mm", "200"),
    ],
    ids=lambda own: own[0],
)
def test_a_report_of_another_table_or_an_edited_one_needs_force(command: tuple[str, ...], run: Run) -> None:
    name, *more = command
    more += ["--report", "page.html", "-q"]
    for own in ("w.csv", "new.csv"):
        shutil.copy(EXAMPLES / "study_table2.csv", own)
    for _ in range(2):
        assert run(name, "w.csv", *more) == (0, "")
    old = Path("page.html").read_text()
    code, told = run(name, "new.csv", *more)
    assert (code, Path("page.html").read_text()) == (2, old)
    assert "--report page.html exists" in told
    Path("page.html").write_text(old.replace("</body>", "<p>Signed: A. B.</p></body>"))
    assert run(name, "w.csv", *more)[0] == 2
    assert "Signed" in Path("page.html").read_text()
    assert run(name, "new.csv", *more, "--force") == (0, "")
