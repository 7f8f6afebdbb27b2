"""Outputs of the commands that cannot be written: told before anything is computed or written."""

from collections.abc import Callable
from pathlib import Path

import pytest

from echocal.cli import _several
from echocal.errors import UsageError

EXAMPLES = Path(__file__).parents[1] / "examples"
TABLE, MODEL = str(EXAMPLES / "study_table2.csv"), str(EXAMPLES / "tank_model.json")
Run = Callable[..., tuple[int, str]]

COMMANDS = {
    "calibrate": ("calibrate", TABLE, "--fit", "zero_error", "-o", "model.json"),
    "correct": ("correct", TABLE, "-o", "corrected.csv"),
    "diagnose": ("diagnose", TABLE, "--save-model", "model.json", "--plots", "plots"),
    "firmware": ("firmware", MODEL, "-o", "made"),
    "study": ("study", "--out", "pages"),
    "sweep": ("sweep", "--temperature", "0:50:2", "-o", "sweep.csv", "--plot", "sweep.png"),
    "verify": ("verify", TABLE, "--maximum-permissible-error-mm", "3"),
}


@pytest.mark.parametrize("name", COMMANDS)
def test_no_output_is_written_where_one_cannot_be(name: str, run: Run) -> None:
    code, told = run(*COMMANDS[name], "--json", "absent/report.json")
    assert code == 2
    assert told == (
        "echocal: absent/report.json cannot be written: there is no folder absent; make it first\n"
    )
    assert list(Path().iterdir()) == []


@pytest.mark.parametrize("name", ["diagnose", "firmware", "study"])
def test_a_file_is_no_folder(name: str, run: Run) -> None:
    Path(COMMANDS[name][-1]).write_text("mine")
    code, told = run(*COMMANDS[name])
    assert (code, told.count("\n")) == (2, 1)
    assert "is a file; name a folder" in told
    assert Path(COMMANDS[name][-1]).read_text() == "mine"


def test_a_folder_is_no_file(run: Run) -> None:
    Path("there").mkdir()
    assert run(*COMMANDS["verify"], "--json", "there") == (
        2,
        "echocal: there cannot be written: it is a folder; name a file in it\n",
    )


def test_the_report_may_go_into_the_folder_that_is_made(run: Run) -> None:
    assert run(*COMMANDS["firmware"], "--temperature-lsb", "0.5", "--json", "made/summary.json", "-q") == (
        0,
        "",
    )
    assert Path("made/summary.json").read_text() == Path("made/report.json").read_text()
    words = (
        "diagnose",
        TABLE,
        "--save-model",
        "plots/model.json",
        "--plots",
        "plots",
        "--json",
        "plots/it.json",
    )
    assert run(*words, "-q") == (0, "")
    assert {"model.json", "it.json"} <= {path.name for path in Path("plots").iterdir()}


@pytest.mark.parametrize(
    ("out", "plot"), [("sweep.csv", "sweep.foo"), ("sweep.foo", "sweep.png"), ("sweep.nc", "plot")]
)
def test_endings_are_known_before_a_sweep_is_written(out: str, plot: str, run: Run) -> None:
    code, told = run("sweep", "--temperature", "0:50:2", "-o", out, "--plot", plot)
    assert (code, told.count("\n")) == (2, 1)
    assert list(Path().iterdir()) == []


@pytest.mark.parametrize("page", ["page.pdf", "page", "-"])
def test_a_page_is_html(page: str, run: Run) -> None:
    for name in ("calibrate", "diagnose", "firmware", "study", "verify"):
        code, told = run(*COMMANDS[name], "--report", page)
        assert (code, told.count("\n")) == (2, 1)
        assert "ends in .html" in told
    assert list(Path().iterdir()) == []


def test_each_option_of_one_table_has_a_way_out(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every option that the command refuses for several tables, and for a fleet."""
    for is_fleet, words in ((False, (TABLE,)), (True, ("-o", "verdicts.csv"))):
        given: dict[str, object] = {}
        with monkeypatch.context() as patched:
            patched.setattr(_several, "refuse_options", lambda one, to=given, **_: to.update(one))
            run("diagnose", TABLE, *words)
        assert {"--placements", "--matters-mm", "--rows"} <= {*given}
        for option in given:
            with pytest.raises(UsageError, match=f"{option} is for one table, .*; [a-z-]+ "):
                _several.refuse_options({option: True}, is_fleet=is_fleet)
        for option in ("--placements", "--matters-mm"):
            code, told = run("diagnose", TABLE, *words, option, "0")
            assert (code, told.count("\n")) == (2, 1)
            assert f"{option} is for one table" in told
