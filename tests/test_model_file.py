import json
from collections.abc import Callable, Iterator
from copy import deepcopy
from pathlib import Path
from random import Random, randrange
from typing import Any

import numpy as np
import pytest

import echocal

EFFECTS = {"fixed_delay": {"delay": 31e-6}, "temperature_offset": {"offset": -0.7}}
COVARIANCE = [[0.04, 3e-8], [3e-8, 6.4e-13]]  # temperature_offset stands first in the chain


@pytest.fixture
def saved(tmp_path: Path) -> Path:
    model = echocal.Model(
        "331.3+0.606*T", EFFECTS, air={"pressure": 9.8e4}, covariance=COVARIANCE, provenance={"rows": 12}
    )
    model.save(tmp_path / "model.json")
    return tmp_path / "model.json"


def edit(path: Path, change: Callable[[dict[str, Any]], object], *, keep_hash: bool = False) -> Path:
    document = json.loads(path.read_text())
    change(document)
    if not keep_hash:
        document.pop("hash", None)
    path.write_text(json.dumps(document))
    return path


def test_what_is_loaded_is_what_was_saved(saved: Path) -> None:
    model = echocal.Model.load(saved)
    assert model.law == "331.3+0.606*T"
    assert model.effects == EFFECTS
    assert model.air == {"pressure": 9.8e4}
    assert model.provenance == {"rows": 12}
    np.testing.assert_array_equal(model.covariance, COVARIANCE)
    assert model.parameter_names == ("temperature_offset.offset", "fixed_delay.delay")
    assert model.standard_uncertainties == {"temperature_offset.offset": 0.2, "fixed_delay.delay": 8e-7}


def test_whatever_sorts_the_names_moves_no_row_of_the_covariance(tmp_path: Path) -> None:
    """JSON objects have no order; `jq -S` sorts the names."""
    effects = {"fixed_speed": {"weight": 1.0, "speed": 343.2}, "zero_error": {"offset": 1e-3}}
    covariance = np.diag([0.0, 0.08**2, 1e-8])
    model = echocal.Model("linear", effects, covariance=covariance)
    model.save(tmp_path / "model.json")
    ordered = json.loads((tmp_path / "model.json").read_text())
    (tmp_path / "sorted.json").write_text(json.dumps(ordered, sort_keys=True))
    found = echocal.Model.load(tmp_path / "sorted.json")
    assert found == model
    np.testing.assert_array_equal(found.covariance, covariance)


def test_the_file_is_the_published_schema(saved: Path) -> None:
    document = json.loads(saved.read_text())
    assert list(document) == ["schema", "law", "air", "effects", "covariance", "hash", "data"]
    assert document["schema"] == "echocal.model/1"
    assert document["effects"][1] == {
        "id": "fixed_delay",
        "parameters": {"delay": {"value": 31e-6, "standard_uncertainty": 8e-7, "unit": "s"}},
    }


def test_hash_covers_what_is_computed_with_and_not_where_it_comes_from(saved: Path) -> None:
    model = echocal.Model.load(saved)
    same = echocal.Model(model.law, EFFECTS, air=model.air, covariance=COVARIANCE)
    assert same.hash == model.hash == json.loads(saved.read_text())["hash"]
    reordered = echocal.Model(
        model.law, dict(reversed(EFFECTS.items())), air=model.air, covariance=COVARIANCE
    )
    assert reordered.hash == model.hash
    assert echocal.Model(model.law, EFFECTS, air=model.air).hash != model.hash


def test_a_model_without_covariance_says_so(tmp_path: Path) -> None:
    path = tmp_path / "model.json"
    echocal.Model("cramer", EFFECTS).save(path)
    assert json.loads(path.read_text())["covariance"] is None
    assert echocal.Model.load(path).covariance is None
    edit(path, lambda d: [e["parameters"][n].update(standard_uncertainty=0.5) for e, n in pairs(d)])
    np.testing.assert_array_equal(echocal.Model.load(path).covariance, np.diag([0.25, 0.25]))


def pairs(document: dict[str, Any]) -> list[tuple[dict[str, Any], str]]:
    return [(effect, name) for effect in document["effects"] for name in effect["parameters"]]


def test_covariance_follows_the_order_of_the_file(saved: Path) -> None:
    def swap(document: dict[str, Any]) -> None:
        document["effects"].reverse()
        document["covariance"] = np.flip(COVARIANCE).tolist()

    np.testing.assert_array_equal(echocal.Model.load(edit(saved, swap)).covariance, COVARIANCE)


def set_value(value: float) -> Callable[[dict[str, Any]], None]:
    def change(document: dict[str, Any]) -> None:
        document["effects"][1]["parameters"]["delay"]["value"] = value

    return change


BROKEN = {
    "a newer schema": (
        lambda d: d.update(schema="echocal.model/2"),
        "written by a newer echocal: schema echocal.model/2; this one reads up to /1; update",
    ),
    "another schema": (lambda d: d.update(schema="echocal.diagnosis/1"), "schema is 'echocal.diagnosis/1'"),
    "no schema": (lambda d: d.pop("schema"), "schema is None; expected 'echocal.model/1'"),
    "no law": (lambda d: d.pop("law"), "law: Field required"),
    "an unknown law": (lambda d: d.update(law="cramr"), "unknown law 'cramr'"),
    "an unknown effect": (lambda d: d["effects"][1].update(id="fixed_dely"), "did you mean 'fixed_delay'"),
    "an effect twice": (lambda d: d["effects"][1].update(id="temperature_offset"), "is listed twice"),
    "a text": (set_value("31 us"), "effects.1.parameters.delay.value: Input should be a valid number"),
    "not a number": (set_value(float("nan")), "has NaN for a number"),
    "out of bounds": (set_value(3.1), "fixed_delay.delay is 3.1, outside its bounds"),
    "another unit": (
        lambda d: d["effects"][1]["parameters"]["delay"].update(unit="us"),
        "fixed_delay.delay is in 'us'; expected 's'",
    ),
    "an unknown member": (lambda d: d.update(frequency=4e4), "frequency: Extra inputs are not permitted"),
    "an unknown quantity": (lambda d: d["air"].update(humidity=0.5), "air has unknown quantity 'humidity'"),
    "a small covariance": (lambda d: d.update(covariance=[[0.04]]), "shape"),
    "another variance": (lambda d: d["covariance"][0].__setitem__(0, 0.09), "standard_uncertainty 0.2"),
    "a half-known model": (
        lambda d: (
            d["effects"][0]["parameters"]["offset"].update(standard_uncertainty=None)
            or d.update(covariance=None)
        ),
        "temperature_offset.offset has no standard_uncertainty",
    ),
}


def uncertain(value: Any) -> Callable[[dict[str, Any]], object]:
    return lambda d: d["effects"][1]["parameters"]["delay"].update(standard_uncertainty=value)


BROKEN |= {
    "a ragged covariance": (
        lambda d: d.update(covariance=[[0.04, 3e-8], [3e-8]]),
        "covariance is no table of 2 rows of 2 numbers each: temperature_offset.offset, fixed_delay.delay",
    ),
    "a covariance of long integers": (
        lambda d: d.update(covariance=[[10**400, 0], [0, 1]]),
        "covariance",
    ),
    "half a character for a law": (lambda d: d.update(law="\ud800"), "the law is"),
    "half a character for an effect": (lambda d: d["effects"][1].update(id="\ud800"), "unknown effect"),
    "a wide uncertainty": (
        uncertain(1e200),
        "fixed_delay.delay has standard_uncertainty 1e+200; give 1e+150",
    ),
    "an uncertainty below zero": (
        uncertain(-1),
        "standard_uncertainty: Input should be greater than or equal",
    ),
    "an uncertainty that is true": (uncertain(True), "standard_uncertainty: Input should be a valid number"),
    "a schema of many digits": (
        lambda d: d.update(schema=f"echocal.model/{'9' * 5000}"),
        "expected 'echocal.model/1'",
    ),
}


@pytest.mark.parametrize("case", BROKEN)
def test_a_broken_file_is_named_with_its_fault(saved: Path, case: str) -> None:
    change, message = BROKEN[case]
    edit(saved, change)
    with pytest.raises(echocal.ModelError) as caught:
        echocal.Model.load(saved)
    assert str(saved) in str(caught.value)
    assert message in str(caught.value)


def test_an_edit_breaks_the_hash(saved: Path) -> None:
    edit(saved, set_value(32e-6), keep_hash=True)
    with pytest.raises(echocal.ModelError, match="edited or damaged"):
        echocal.Model.load(saved)
    assert echocal.Model.load(edit(saved, lambda _: None)).effects["fixed_delay"] == {"delay": 32e-6}


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"\x89PNG\xff", "is not JSON, not even text"),
        (b"", "is not JSON: line 1, column 1"),
        (b'{"schema": "echocal.model/1",\n', "is not JSON: line 2"),
        (b"[1, 2]", "expected an object of schema echocal.model/1"),
    ],
)
def test_what_is_no_model_file(tmp_path: Path, data: bytes, message: str) -> None:
    path = tmp_path / "model.json"
    path.write_bytes(data)
    with pytest.raises(echocal.ModelError, match=message):
        echocal.Model.load(path)


def test_files_that_cannot_be_read_or_written(tmp_path: Path) -> None:
    with pytest.raises(echocal.ModelError, match="No such file"):
        echocal.Model.load(tmp_path / "absent.json")
    with pytest.raises(echocal.ModelError, match="directory"):
        echocal.Model.load(tmp_path)
    with pytest.raises(echocal.ModelError, match="cannot be written"):
        echocal.Model().save(tmp_path / "absent" / "model.json")
    unplain = echocal.Model(provenance={"mean": float("nan")})
    with pytest.raises(echocal.ModelError, match="provenance"):
        unplain.save(tmp_path / "model.json")


@pytest.mark.parametrize(
    ("covariance", "message"),
    [
        ([[1.0]], "2 parameters"),
        ([[1.0, 0.0], [0.5, 1.0]], "not symmetric"),
        ([[1.0, 0.0], [0.0, -1.0]], "fixed_delay.delay the variance -1"),
        ([[1.0, 0.0], [0.0, np.inf]], "not finite"),
    ],
)
def test_a_covariance_that_cannot_be(covariance: list[list[float]], message: str) -> None:
    with pytest.raises(echocal.ModelError, match=message):
        echocal.Model("linear", EFFECTS, covariance=covariance)


def nested(depth: int) -> list[Any]:
    whole: list[Any] = []
    for _ in range(depth):
        whole = [whole]
    return whole


STRANGE: tuple[Any, ...] = (
    *(None, True, False, 0, -1, 1e200, -1e308, 10**30, 10**400, 5e-324, float("nan"), float("inf")),
    *("", "x", "\ud800", "\0", "343", "1e400", "9" * 400, "(((((", "1/0", "T*T", "cramer", "a" * 10_000),
    *([], {}, [[]], [[1.0]], [1, 2], {"a": 1}, {"id": "drift"}, {"value": 1.0}, nested(50), nested(400)),
)
NAMES = ("x", "", "\ud800", "value", "unit", "id", "shape", "covariance", "parameters", "delay")


def places(document: Any) -> Iterator[tuple[Any, Any]]:
    """Every container of a document, with every key or position in it."""
    inside = document.items() if isinstance(document, dict) else enumerate(document)
    for key, value in list(inside):
        yield document, key
        if isinstance(value, dict | list):
            yield from places(value)


def mutate(document: dict[str, Any], random: Random) -> None:
    """Replace, remove, repeat or rename what stands at some place of a document."""
    container, key = random.choice(list(places(document)))
    match random.randrange(8):
        case 0:
            del container[key]
        case 1 if isinstance(container, list):
            container.insert(key, deepcopy(container[key]))
        case 1:
            container[random.choice(NAMES)] = deepcopy(container[key])
        case _:
            container[key] = deepcopy(random.choice(STRANGE))


@pytest.mark.slow
def test_any_file_is_a_model_or_told_why_not(saved: Path) -> None:
    seed = randrange(2**32)
    print(f"seed {seed}")  # pytest shows it where this fails
    random = Random(seed)
    whole = json.loads(saved.read_text())
    del whole["hash"]
    shape = {"against": "temperature", "at": [0.0, 20.0], "shift": [0.0, 2e-3], "unit": "m"}
    whole["shape"] = {**shape, "standard_uncertainty": [1e-4, 1e-4]}
    outcomes = {True: 0, False: 0}
    for _ in range(1000):
        document = deepcopy(whole)
        for _ in range(random.choice((1, 1, 1, 2, 3))):
            mutate(document, random)
        text = json.dumps(document)
        if random.random() < 0.1:
            place = random.randrange(len(text))
            text = (
                text[:place] + random.choice(('"', "{", "}", ",", "-", "\0", "9" * 5000)) + text[place + 1 :]
            )
        saved.write_text(text)
        try:
            model = echocal.Model.load(saved)
        except echocal.ModelError:
            outcomes[False] += 1
        else:
            assert echocal.Model(model.law, model.effects).effects == model.effects
            outcomes[True] += 1
    assert min(outcomes.values()) > 0
