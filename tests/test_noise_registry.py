"""Every entry of the registry of noises does what its facts say; a new one is tested without a word more."""

from pathlib import Path

import effects_page
import numpy as np
import pytest
from planted import clean, search
from typer.testing import CliRunner

import echocal
from echocal.cli import app
from echocal.diagnose.catalogue import find_cause, irregularities
from echocal.diagnose.findings.facts import Columns
from echocal.diagnose.findings.parts import Cause
from echocal.diagnose.noises import NoiseSettings, common, registry
from echocal.diagnose.noises.common.kinds import (
    FittedNoise,
    NoiseEntry,
    NuisanceNoise,
    OffsetNoise,
    Quantization,
)
from echocal.diagnose.settings.causes import every_threshold

EVERY = pytest.mark.parametrize("noise", registry.NOISES, ids=lambda noise: noise.facts.id)


def drawn(random: np.random.Generator, noise: NoiseEntry | None = None) -> Columns:
    """A fresh table, with a noise in it."""
    table = clean(random)
    if noise is not None:
        noise.draw(table, random)
    return table


def diagnosed(table: Columns) -> echocal.Diagnosis:
    return echocal.diagnose(table, constant_distance="distance_m" not in table)


def irregular(table: Columns) -> dict[str, Cause]:
    return {cause.id: cause for cause in diagnosed(table).causes if cause.kind != "effect"}


def test_each_file_is_an_entry_and_has_the_name_of_its_id() -> None:
    folder = Path(common.__file__).parents[1]
    files = {path.stem for path in folder.glob("*.py")} - {"__init__", "registry"}
    assert files == {noise.facts.id for noise in registry.NOISES}
    assert len(files) == len(registry.NOISES)


@EVERY
def test_facts_are_complete(noise: NoiseEntry) -> None:
    facts = noise.facts
    assert facts.kind == "noise"
    assert facts.sentence.endswith(".")
    assert all((facts.signature, facts.formula, facts.check, facts.source, facts.prior_source))
    assert 0.0 < facts.prior < 0.2
    assert facts.parameters
    for parameter in facts.parameters:
        assert parameter.prior, parameter.name
        assert parameter.bounds != (None, None), parameter.name
    assert find_cause(facts.id) is facts
    assert facts in echocal.noises()
    assert isinstance(noise, Quantization | FittedNoise | NuisanceNoise | OffsetNoise)


@EVERY
def test_the_catalogue_of_causes_has_it(noise: NoiseEntry, shared: Path) -> None:
    """By its id, or by an id that its source cites; or it comes from elsewhere."""
    catalogue, source = (shared / "CATALOGUE.md").read_text(), noise.facts.source
    cited = source.rpartition("CATALOGUE, ")[2]
    known = any(f"**{id_}**" in catalogue for id_ in (noise.facts.id, cited))
    assert known or "CATALOGUE" not in source


def test_what_a_quantization_imitates_is_a_fitted_noise() -> None:
    fitted = {noise.facts.id for noise in registry.fitted()}
    assert all(set(noise.imitates) <= fitted for noise in registry.quantizations())


def test_the_priors_of_fitted_noises_leave_room_for_none() -> None:
    assert sum(noise.facts.prior for noise in registry.fitted()) < 0.5


@pytest.mark.statistical
@EVERY
def test_planted_it_is_found_with_its_parameters(noise: NoiseEntry, random: np.random.Generator) -> None:
    """Found in 25 of 25 tables drawn, each; a second draw makes up for a rare miss."""
    facts = noise.facts
    for _ in range(2):
        table = drawn(random, noise)
        found = irregular(table)
        if facts.id in found:
            break
    assert facts.id in found
    quantities = {quantity.name: quantity for quantity in facts.parameters}
    for parameter in found[facts.id].parameters:
        low, high = quantities[parameter.name].bounds
        assert parameter.unit == quantities[parameter.name].unit
        assert (-np.inf if low is None else low) <= parameter.value <= (np.inf if high is None else high)
    assert found[facts.id].because


@pytest.mark.statistical
def test_clean_tables_have_no_noise(random: np.random.Generator) -> None:
    """None of 50 tables drawn has one: three of 8 are no chance."""
    wrong = []
    for _ in range(8):
        table = drawn(random)
        if found := irregular(table):
            wrong.append(list(found))
    assert len(wrong) < 3, wrong


@pytest.mark.parametrize("noise", registry.quantizations(), ids=lambda noise: noise.facts.id)
def test_a_quantization_leaves_the_rows_in_place(noise: Quantization, random: np.random.Generator) -> None:
    table = drawn(random, noise)
    data, faults = search(table)
    assert noise.facts.id in {finding.cause for finding in faults.accepted}
    assert len(faults.observations) == len(data)
    time = faults.observations.conditions["elapsed_time"]
    np.testing.assert_array_equal(time, data.conditions["elapsed_time"])


@pytest.mark.slow
@EVERY
def test_without_its_line_it_is_nowhere(
    noise: NoiseEntry, monkeypatch: pytest.MonkeyPatch, random: np.random.Generator
) -> None:
    id_ = noise.facts.id
    table = drawn(random, noise)
    assert f"## {id_}\n" in effects_page.page()
    monkeypatch.setattr(registry, "NOISES", tuple(n for n in registry.NOISES if n is not noise))
    assert noise.facts not in irregularities()
    diagnosis = diagnosed(table)
    assert not [ids for ids, _ in diagnosis.posterior if id_ in ids]
    assert id_ not in diagnosis.explain()
    assert f"## {id_}\n" not in effects_page.page()
    assert f" {id_} " not in CliRunner().invoke(app, ["effects"]).output
    with pytest.raises(echocal.UsageError, match=id_):
        find_cause(id_)


def test_every_number_says_its_unit_and_where_it_comes_from() -> None:
    numbers = list(every_threshold(NoiseSettings(), registry.NOISES))
    assert len({each.name for each in numbers}) == len(numbers)
    assert all(each.unit and each.source for each in numbers)
    assert {f"{noise.facts.id}.prior" for noise in registry.NOISES} <= {each.name for each in numbers}
