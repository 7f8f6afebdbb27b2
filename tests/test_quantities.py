"""Every influence quantity is one entry, and every place that needs it finds it there."""

import ast
import inspect
import re
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest
import quantities_page

import echocal
from echocal import firmware
from echocal.concise import decimal
from echocal.diagnose.findings.sentences import quantity_text, shown, spoken
from echocal.observations.units import FORMS
from echocal.plots.sweep import sweep_figure
from echocal.quantities import AIR, DEFAULTS, QUANTITIES, Form, QuantityFacts, _entry
from echocal.sweep import parse_named, write

PACKAGE = Path(echocal.__file__).parent
ENTRIES = tuple(QUANTITIES.values())
RECORDED = tuple(facts for facts in ENTRIES if facts.derived_from is None)
EVERY = pytest.mark.parametrize("facts", ENTRIES, ids=lambda facts: facts.id)
EVERY_RECORDED = pytest.mark.parametrize("facts", RECORDED, ids=lambda facts: facts.id)
EVERY_NAME = pytest.mark.parametrize(
    ("facts", "form", "symbol"),
    [
        pytest.param(facts, form, symbol, id=name)
        for facts in RECORDED
        for form in facts.forms
        for name, symbol in zip(form.names, form.units, strict=True)
    ],
)


def two(facts: QuantityFacts) -> np.ndarray:
    """Two values of a quantity [SI]; a time counts from its first row."""
    return np.array([0.0 if facts.runs_on else facts.example, 1.25 * facts.example])


def written(facts: QuantityFacts, form: Form, symbol: str) -> list[str]:
    """Two values as a file holds them."""
    if facts.id == "elapsed_time" and not symbol:
        return [str(np.datetime64("2024-05-31T13:45:00") + np.timedelta64(int(s), "s")) for s in two(facts)]
    return [repr(form.units[symbol].from_si(float(value))) for value in two(facts)]


def read(tmp_path: Path, column: str, values: list[str], request: str | None = None) -> np.ndarray:
    file = tmp_path / "table.csv"
    file.write_text("\n".join([f"echo_us,{column}", *(f"11660,{value}" for value in values)]) + "\n")
    data = echocal.read_observations(file, {column: request} if request else None)
    (found,) = (name for name in data.conditions if QUANTITIES[name].derived_from is None)
    return data.conditions[found]


@EVERY_NAME
def test_read_from_a_file_by_name(facts: QuantityFacts, form: Form, symbol: str, tmp_path: Path) -> None:
    name = f"{form.role}_{symbol}" if symbol else form.role
    found = read(tmp_path, name, written(facts, form, symbol))
    np.testing.assert_allclose(found, two(facts), rtol=1e-12)


@EVERY_NAME
def test_read_from_a_file_in_words(facts: QuantityFacts, form: Form, symbol: str, tmp_path: Path) -> None:
    values = written(facts, form, symbol)
    spellings = [symbol, *form.units[symbol].words] if symbol else list(form.units[symbol].words)
    for words in (*form.words, form.role.replace("_", " ")):
        for spelling in spellings:
            found = read(tmp_path, "from the logger", values, f"{words} in {spelling}")
            np.testing.assert_allclose(found, two(facts), rtol=1e-12, err_msg=f"{words} in {spelling}")


@EVERY_NAME
def test_a_sweep_takes_it_by_name(facts: QuantityFacts, form: Form, symbol: str) -> None:
    name = f"{form.role}_{symbol}" if symbol else form.role
    value = form.units[symbol].from_si(facts.example)
    quantity, values = parse_named(f"{name}={value!r}")
    assert quantity == facts.id
    np.testing.assert_allclose(values, facts.example, rtol=1e-12)


@EVERY
def test_a_sweep_has_it_with_words_and_unit(facts: QuantityFacts) -> None:
    grid = echocal.sweep("linear", **{"temperature": 20.0, facts.id: [facts.example, facts.example + 0.1]})
    assert grid[facts.id].attrs["units"]
    assert grid[facts.id].attrs["long_name"] == facts.words
    figure = sweep_figure(grid)
    texts = [text.get_text() for ax in figure.axes for text in ax.findobj(plt.Text)]
    assert any(facts.words in text for text in texts)
    plt.close(figure)


@EVERY_RECORDED
def test_a_sweep_as_a_file_is_read_back(facts: QuantityFacts, tmp_path: Path) -> None:
    values = [facts.example, 1.1 * facts.example]
    grid = echocal.sweep("linear", **{"temperature": 20.0, facts.id: values})
    write(grid, tmp_path / "sweep.csv")
    back = echocal.read_observations(tmp_path / "sweep.csv", {"reading_m": "ignore"}).conditions[facts.id]
    np.testing.assert_allclose(back - back[0], np.array(values) - values[0], rtol=1e-12, atol=1e-12)


@EVERY
def test_values_are_possible(facts: QuantityFacts) -> None:
    low, high = facts.possible
    for value in (facts.example, *facts.field_range, *([facts.default] if facts.default is not None else [])):
        assert facts.field_from or low <= value <= high
    for form in facts.forms:
        assert form.physical[0] <= facts.example <= form.physical[1]
        assert form.quantity == facts.id


@EVERY
def test_recorded_or_derived(facts: QuantityFacts) -> None:
    assert bool(facts.forms) == (facts.derived_from is None), "recorded: name its columns; derived: none"
    assert all(form.meaning for form in facts.forms)


@EVERY
def test_sentences_and_axes_say_its_words_and_unit(facts: QuantityFacts) -> None:
    assert re.fullmatch(r"[A-Za-z0-9 ]+", facts.words), "words without underscores"
    values, label = shown(facts.id, np.array([facts.example]))
    assert spoken(facts.id) == facts.words
    assert label == f"{facts.words} [{facts.shown.unit}]".removesuffix(" []")
    assert values[0] == facts.example * facts.shown.factor
    assert quantity_text(facts.id, facts.example) == f"{decimal(values[0])} {facts.shown.unit}".rstrip()


@EVERY
def test_a_firmware_decision_is_made(facts: QuantityFacts) -> None:
    assert (facts.codes is None) == bool(facts.why_no_codes), "codes, or the reason that there are none"
    annotations = [str(p.annotation) for p in inspect.signature(firmware.generate).parameters.values()]
    taken = any(facts.codes is not None and facts.codes.__name__ in text for text in annotations)
    assert taken == (facts.codes is not None)


def test_the_page_is_fresh() -> None:
    page = quantities_page.PAGE.read_text(encoding="utf-8")
    assert quantities_page.replaced(page) == page, "run: python tests/reference/quantities_page.py --write"
    assert all(f"`{facts.id}`" in page for facts in ENTRIES)
    assert all(f"`{form.names[0]}`" in page for form in FORMS)


def test_effects_read_only_these() -> None:
    read_ = {name for effect in echocal.effects() for name in (*effect.reads, *effect.requires)}
    assert read_ <= set(QUANTITIES)
    assert set(DEFAULTS) < set(AIR) < set(QUANTITIES)


def test_no_other_file_lists_quantities() -> None:
    """A list of four or more names elsewhere is a second table, which a new quantity would have to join.

    The virtual bench is a second world on purpose: it imports nothing of the first one.
    """
    found, apart = [], ("quantities", "study", "virtual_bench")
    for path in sorted(PACKAGE.rglob("*.py")):
        if path.relative_to(PACKAGE).parts[0] in apart:
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            parts = node.keys if isinstance(node, ast.Dict) else getattr(node, "elts", [])
            texts = {part.value for part in parts if isinstance(part, ast.Constant)}
            if len(texts & set(QUANTITIES)) >= 4:
                found.append(f"{path.relative_to(PACKAGE)}:{node.lineno}")
    assert not found


def test_what_is_missing_is_said() -> None:
    with pytest.raises(ImportError, match=r"soil_moisture.*no entry in .*table\.py"):
        _entry("soil_moisture")
    with pytest.raises(ImportError, match=r"add it to rust/core/src/conditions\.rs"):
        QuantityFacts(id="soil_moisture", words="soil moisture", example=0.3)


def test_a_station_is_a_stand() -> None:
    table = {"echo_us": [11660.0] * 3, "station": ["a", "b", "a"]}
    assert echocal.read_observations(table).labels["stand"].tolist() == [0, 1, 0]
    with pytest.raises(echocal.DataError, match="'station' and 'stand' both hold stand"):
        echocal.read_observations({**table, "stand": [1, 2, 1]})
