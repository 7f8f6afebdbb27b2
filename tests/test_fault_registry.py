"""Every entry of the registry of faults does what its facts say; a new one is tested without a word more."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import effects_page
import numpy as np
import pytest
from planted import accepted, clean, search
from typer.testing import CliRunner

import echocal
from echocal.cli import app
from echocal.diagnose.catalogue import find_cause, irregularities
from echocal.diagnose.faults import FaultSettings, Finding, common, registry
from echocal.diagnose.faults.common.fault import Fault
from echocal.diagnose.settings.causes import every_threshold

EVERY = pytest.mark.parametrize("fault", registry.FAULTS, ids=lambda fault: fault.facts.id)
COLUMNS = {
    "reference_distance": "distance_m",
    "temperature": "temperature_C",
    "relative_humidity": "humidity_percent",
    "elapsed_time": "time_s",
}


def test_each_file_is_an_entry_and_has_the_name_of_its_id() -> None:
    folder = Path(common.__file__).parents[1]
    files = {path.stem for path in folder.glob("*.py")} - {"__init__", "registry"}
    assert files == {fault.facts.id for fault in registry.FAULTS}
    assert len(files) == len(registry.FAULTS)


@EVERY
def test_facts_are_complete(fault: Fault) -> None:
    facts = fault.facts
    assert facts.kind in {"gross", "row"}
    assert facts.sentence.endswith(".")
    assert all((facts.signature, facts.formula, facts.repair, facts.check, facts.source, facts.prior_source))
    assert 0.0 < facts.prior < 0.1
    assert set(facts.needs) <= set(COLUMNS)
    assert facts.parameters
    assert find_cause(facts.id) is facts
    assert facts in (echocal.gross_faults() if facts.kind == "gross" else echocal.row_faults())


@EVERY
def test_the_catalogue_of_causes_has_it(fault: Fault, shared: Path) -> None:
    """By its id, or by an id that its source cites; or it comes from elsewhere."""
    catalogue, source = (shared / "CATALOGUE.md").read_text(), fault.facts.source
    cited = source.rpartition("CATALOGUE, ")[2]
    known = any(f"**{id_}**" in catalogue for id_ in (fault.facts.id, cited))
    assert known or "CATALOGUE" not in source


@pytest.mark.statistical
@EVERY
def test_planted_it_is_found_and_no_row_is_lost_or_moved(fault: Fault, random: np.random.Generator) -> None:
    """Found in 60 of 60 tables drawn."""
    table = clean(random)
    fault.spoil(table, random)
    data, faults = search(table)
    found = {f.cause: f for f in faults.accepted}
    assert fault.facts.id in found
    finding = found[fault.facts.id]
    units = {p.name: p.unit for p in fault.facts.parameters}
    assert all(units[p.name] == p.unit for p in finding.parameters)
    assert finding.rows is not None
    assert finding.rows.any()
    assert finding.repaired is not None
    for repaired in (finding.repaired, faults.observations):
        assert len(repaired) == len(data)
        np.testing.assert_array_equal(repaired.conditions["elapsed_time"], data.conditions["elapsed_time"])
    others = ~finding.rows
    before = as_seen_by(data, fault, found)
    np.testing.assert_array_equal(finding.repaired.echo_time[others], before.echo_time[others])
    np.testing.assert_array_equal(finding.repaired.unusable[others], before.unusable[others])


def as_seen_by(
    data: echocal.Observations, fault: Fault, found: Mapping[str, Finding]
) -> echocal.Observations:
    """The table as the detector of a fault saw it."""
    for other in registry.FAULTS:
        if other is fault:
            break
        if other.facts.id in found:
            data = found[other.facts.id].repaired or data
    return data


@EVERY
def test_without_a_column_that_it_needs_it_is_silent(fault: Fault, random: np.random.Generator) -> None:
    for name in fault.facts.needs:
        table = clean(random)
        fault.spoil(table, random)
        del table[COLUMNS[name]]
        assert fault.facts.id not in accepted(table)


@pytest.mark.statistical
def test_clean_tables_have_no_fault(random: np.random.Generator) -> None:
    """None of 300 tables drawn has one: two of 40 are no chance."""
    wrong = [ids for ids in (accepted(clean(random)) for _ in range(40)) if ids]
    assert len(wrong) < 2, wrong


@EVERY
def test_without_its_line_it_is_nowhere(
    fault: Fault, monkeypatch: pytest.MonkeyPatch, random: np.random.Generator
) -> None:
    id_ = fault.facts.id
    table = clean(random)
    fault.spoil(table, random)
    assert f"## {id_}\n" in effects_page.page()
    monkeypatch.setattr(registry, "FAULTS", tuple(f for f in registry.FAULTS if f is not fault))
    assert fault.facts not in irregularities()
    assert id_ not in accepted(table)
    assert f"## {id_}\n" not in effects_page.page()
    assert f" {id_} " not in CliRunner().invoke(app, ["effects"]).output
    assert not [
        each for each in every_threshold(FaultSettings(), registry.FAULTS) if each.name.startswith(f"{id_}.")
    ]
    with pytest.raises(echocal.UsageError, match=id_):
        find_cause(id_)


def test_every_number_says_its_unit_and_where_it_comes_from() -> None:
    numbers = list(every_threshold(FaultSettings(), registry.FAULTS))
    assert len({each.name for each in numbers}) == len(numbers)
    assert all(each.unit and each.source for each in numbers)
    assert {f"{fault.facts.id}.prior" for fault in registry.FAULTS} <= {each.name for each in numbers}


@EVERY
def test_its_prior_can_be_set(fault: Fault, random: np.random.Generator) -> None:
    table = clean(random)
    fault.spoil(table, random)
    impossible = FaultSettings(priors={fault.facts.id: 1e-300})
    assert fault.facts.id in accepted(table)
    assert fault.facts.id not in accepted(table, impossible)


def test_its_thresholds_can_be_set(random: np.random.Generator) -> None:
    (fault,) = (fault for fault in registry.FAULTS if fault.facts.id == "crosstalk")
    table = clean(random)
    fault.spoil(table, random)
    assert "crosstalk" in accepted(table)
    blind = replace(fault.thresholds, least=0.99)  # type: ignore[type-var]
    assert "crosstalk" not in accepted(table, FaultSettings(thresholds={"crosstalk": blind}))


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (lambda: FaultSettings(priors={"crostalk": 0.1}), "no fault 'crostalk'"),
        (lambda: FaultSettings(thresholds={"crosstalk": 0.1}), "thresholds of crosstalk are a float"),
    ],
)
def test_numbers_of_no_fault_are_refused(settings: Callable[[], FaultSettings], message: str) -> None:
    with pytest.raises(echocal.UsageError, match=message):
        accepted(clean(np.random.default_rng(0)), settings())
