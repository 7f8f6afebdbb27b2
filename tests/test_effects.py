import json
import os
import subprocess
import sys
from pathlib import Path

import effects_page
import numpy as np
import pytest
from typer.testing import CliRunner

import echocal
from echocal.cli import app, main
from echocal.diagnose.catalogue import irregularities
from echocal.diagnose.findings.facts import CauseFacts
from echocal.quantities import QUANTITIES
from echocal.registry import Effect, find_effect

EVERY = pytest.mark.parametrize("effect", echocal.effects(), ids=lambda effect: effect.id)
RECORD = {name: facts.example for name, facts in QUANTITIES.items()}
SENSES = {quantity: value * 1.1 for quantity, value in RECORD.items()}


def values(effect: Effect) -> dict[str, float]:
    """Every parameter half a scale from neutral, inside its bounds."""
    return {p.name: min(p.neutral + 0.5 * p.prior_scale, p.bounds[1]) for p in effect.parameters}


def law(effect: Effect, usual: str = "linear") -> str:
    """A law that the effect extends."""
    return effect.extends[0] if effect.extends else usual


def recorded(effect: Effect) -> dict[str, float]:
    return {name: value for name, value in RECORD.items() if name not in effect.excludes}


@EVERY
def test_neutral_is_identity_bit_for_bit(effect: Effect, random: np.random.Generator) -> None:
    distance = random.uniform(0.02, 10.0, 100)
    conditions = recorded(effect)
    base = echocal.Model(law(effect)).indicate(distance, **conditions)
    shapes = {p.name: v for p in effect.parameters if p.role == "shape" for v in (p.neutral, *p.known)}
    model = echocal.Model(law(effect), {effect.id: shapes})
    assert model.indicate(distance, **conditions).tobytes() == base.tobytes()


@EVERY
def test_what_it_does_not_read_leaves_the_echo_alone(effect: Effect) -> None:
    """Twin of the core's test, through the whole chain: the linear law reads the temperature alone."""
    conditions = recorded(effect)
    base, model = (echocal.Model(law(effect), effects) for effects in ({}, {effect.id: values(effect)}))

    def reacts(model: echocal.Model, name: str) -> bool:
        here, there = conditions, {**conditions, name: SENSES[name]}
        chain = [(model.time_of_flight(2.0, **at), model.indicate(2.0, **at)) for at in (here, there)]
        return chain[0] != chain[1]

    for name in conditions:
        if effect.edges and name in effect.reads:
            continue  # reacts where an edge lies between: the core's test draws many places
        assert reacts(model, name) == (reacts(base, name) or name in effect.reads), name


@EVERY
def test_compensation_undoes_it(effect: Effect, random: np.random.Generator) -> None:
    model, conditions = echocal.Model(law(effect), {effect.id: values(effect)}), recorded(effect)
    distance = random.uniform(0.02, 10.0, 100)
    back = model.correct(model.indicate(distance, **conditions), **conditions)
    np.testing.assert_allclose(back, distance, rtol=0, atol=1e-12)


@EVERY
def test_save_and_load_keep_it(effect: Effect, tmp_path: Path) -> None:
    model = echocal.Model(law(effect), {effect.id: values(effect)})
    model.save(tmp_path / "model.json")
    assert echocal.Model.load(tmp_path / "model.json").effects == model.effects


@EVERY
def test_a_quantity_that_it_requires_must_be_given(effect: Effect) -> None:
    model = echocal.Model(law(effect, "343"), {effect.id: {}})
    for name in effect.requires:
        lacking = {other: value for other, value in recorded(effect).items() if other != name}
        with pytest.raises(echocal.DataError, match=rf"(effect '{effect.id}'|law '\w+') needs {name}"):
            model.indicate(2.0, **lacking)


@EVERY
def test_facts_are_typed(effect: Effect) -> None:
    assert {*effect.reads, *effect.requires, *effect.excludes} <= set(QUANTITIES)
    assert json.loads(json.dumps(effect.to_dict()))["id"] == effect.id
    assert find_effect(effect.id) is effect


def test_page_is_fresh() -> None:
    assert effects_page.PAGE.read_text(encoding="utf-8") == effects_page.page(), (
        "run: python tests/reference/effects_page.py --write"
    )


def run(*arguments: str) -> str:
    result = CliRunner().invoke(app, ["effects", *arguments])
    assert result.exit_code == 0, result.output
    return result.output


@pytest.mark.parametrize("arguments", [(), ("list",)])
def test_list_names_every_effect(arguments: tuple[str, ...]) -> None:
    output = run(*arguments)
    assert all(cause.id in output for cause in (*echocal.effects(), *irregularities()))


@EVERY
def test_show_tells_formula_and_parameters(effect: Effect, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    output = run("show", effect.id)
    assert effect.formula in output
    assert effect.source in output
    assert all(parameter.name in output for parameter in effect.parameters)


@pytest.mark.parametrize("cause", irregularities(), ids=lambda cause: cause.id)
def test_show_tells_noises_and_faults_too(cause: CauseFacts, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "250")
    output = run("show", cause.id)
    assert all(text in output for text in (cause.sentence, cause.signature, cause.check, cause.source))
    assert all(quantity.meaning in output for quantity in cause.parameters)


def test_json_is_the_registry(tmp_path: Path) -> None:
    listed = json.loads(run("--json", "-"))
    assert listed == json.loads(run("list", "--json", "-"))
    causes = (*echocal.effects(), *irregularities())
    assert [cause["id"] for cause in listed] == [cause.id for cause in causes]
    assert sum(cause["kind"] == "effect" for cause in listed) == len(echocal.effects())
    for id_ in ("humidity", "cycle_slip", "timeout", "unit_mixup"):
        assert run("show", id_, "--quiet", "--json", str(tmp_path / "shown.json")) == ""
        assert json.loads((tmp_path / "shown.json").read_text()) in listed


def test_quiet_prints_nothing() -> None:
    assert run("--quiet") == run("list", "-q") == run("show", "humidity", "-q") == ""


def test_an_unknown_id_suggests_the_nearest() -> None:
    run_ = subprocess.run(
        [sys.executable, "-m", "echocal", "effects", "show", "humidty"],
        capture_output=True,
        text=True,
        check=False,
        env=dict(os.environ),
    )
    assert run_.returncode == 2
    assert run_.stdout == ""
    assert run_.stderr.startswith("echocal: unknown cause 'humidty'; did you mean 'humidity'? Known: ")
    assert run_.stderr.count("\n") == 1


def test_a_file_that_cannot_be_written_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    target = tmp_path / "absent" / "effects.json"
    monkeypatch.setattr(sys, "argv", ["echocal", "effects", "--json", str(target)])
    with pytest.raises(SystemExit) as stopped:
        main()
    assert stopped.value.code == 2
    told = f"echocal: {target} cannot be written: there is no folder {target.parent}; make it first\n"
    assert capsys.readouterr().err == told
