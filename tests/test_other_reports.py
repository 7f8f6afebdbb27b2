"""The study and a firmware as pages: what they say, and that a browser shows them without a request."""

from collections.abc import Callable
from pathlib import Path

import pytest
from browsed import CLEAN, Text, browsed, drawn_in

from echocal import Model, study
from echocal.firmware import Firmware, generate
from echocal.pages.considered import considered
from echocal.pages.firmware import firmware_page
from echocal.pages.study import study_page

Run = Callable[..., tuple[int, str]]
CODES = {"temperature": (0.5, 0.0, 40.0), "echo": 12000}
WORDS = ("--temperature-lsb", "0.5", "--temperature-range", "0:40", "--echo-max-us", "12000", "--quiet")
MODEL = Model("linear", {"zero_error": {"offset": 12e-3}})


@pytest.fixture(scope="module")
def made() -> Firmware:
    return generate(MODEL, "c99", **CODES)


@pytest.fixture(scope="module")
def page(made: Firmware) -> str:
    return firmware_page(made, MODEL, considered(MODEL, "c99", **CODES))


@pytest.fixture(scope="module")
def recomputed() -> str:
    return study_page(study.run())


def test_a_firmware_says_what_is_proven_and_why_it_was_chosen(made: Firmware, page: str) -> None:
    text = Text(page).seen
    report = made.report
    assert f"at most {1e3 * report['error_proven_m']:.4f} mm" in text
    assert f"each of the {report['inputs_checked']:,} inputs" in text
    assert "least flash, by the cost model" in text
    assert report["provenance"]["command"] in text


def test_each_form_has_its_cost_or_the_reason_why_not(made: Firmware, page: str) -> None:
    text = Text(page).seen
    forms = considered(MODEL, "c99", **CODES)
    assert len(forms) > 3
    for one in forms:
        if one.made is None:
            assert one.form in text
            assert " ".join(one.reason.split()) in text
        else:
            flash, steps = one.made.ranked_by()
            assert f"{one.made.report['form']['description']} " in text
            assert f"{flash} bytes, {steps} instructions" in text
    assert page.count("<b>chosen</b>") == 1
    costs = [one.made.ranked_by()[0] for one in forms if one.made]
    assert made.ranked_by()[0] == min(costs)  # what the page says of it


def test_the_drawn_error_is_within_the_proven_one(made: Firmware, page: str) -> None:
    values = [value for line in drawn_in(page, 0) if line.name != "requested bound" for value in line.y]
    proven = 1e3 * made.report["error_proven_m"]
    assert len(values) > 500
    assert 0.0 < max(map(abs, values)) <= proven * 1.001


def test_the_study_says_each_claim_with_its_reason(recomputed: str) -> None:
    text, found = Text(recomputed).seen, study.run()
    for finding in found.findings:
        assert " ".join(finding.claim.claim.split()) in text
        assert " ".join(finding.because.split()) in text
    for name, count in found.verdicts.items():
        assert f"{count} are {name}" in text


def test_they_need_nothing_from_any_host(page: str, recomputed: str) -> None:
    assert Text(page).fetched == Text(recomputed).fetched == ["data:,"]


def test_the_commands_write_them_and_replace_only_their_own(run: Run) -> None:
    MODEL.save("model.json")
    firmware = ("firmware", "model.json", "-o", "out", *WORDS, "--report")
    for words in (firmware, ("study", "--quiet", "--report")):
        name = f"{words[0]}.html"
        assert run(*words, name)[0] == 0
        assert f'content="echocal {words[0]} ' in Path(name).read_text(encoding="utf-8")
        assert run(*words, name)[0] == 0  # again, over its own page
        Path("notes.html").write_text("<p>mine</p>")
        code, said = run(*words, "notes.html")
        assert (code, "notes.html" in said) == (2, True)
        assert Path("notes.html").read_text() == "<p>mine</p>"
    code, said = run("firmware", "model.json", "-o", "all", "--explore", "--report", "x.html")
    assert (code, "--report" in said) == (2, True)


@pytest.mark.slow
def test_a_browser_shows_them(page: str, recomputed: str, tmp_path: Path) -> None:
    for place, one in enumerate((page, recomputed)):
        folder = tmp_path / str(place)
        folder.mkdir()
        assert browsed(one, folder) == CLEAN
