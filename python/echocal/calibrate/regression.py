"""Data-driven forms: regressions in columns of the table, calibrated like a physical model."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from echocal import _core
from echocal.arrays import Column
from echocal.calibrate.problem import Columns, Matrix, Parameter
from echocal.conditions import columns as broadcast
from echocal.errors import DataError, UsageError, among
from echocal.model import Model
from echocal.observations import Observations
from echocal.quantities import FROM_THERMOMETERS, QUANTITIES
from echocal.registry import find_effect

LAW = {"law.intercept": ("speed_intercept", "intercept"), "law.slope": ("speed_slope", "slope")}
"""A law's coefficient moves as the effect that deviates nature's law from the device's."""

UNITS = {name: quantity.unit for name, quantity in QUANTITIES.items()} | {"distance": "m", "echo_time": "s"}


def indication(observations: Observations, device: Model) -> Column:
    """Indication [m] of a device without effects that converts the recorded echoes, shape (n,).

    Its echo time at 1 m is 2/c at the recorded conditions, so no formula for c is needed here.
    """
    rows = len(observations)
    used = observations.usable
    at = {name: column[used] for name, column in observations.conditions.items()}
    per_meter = np.full(rows, np.nan)
    per_meter[used] = device.time_of_flight(np.ones(int(used.sum())), **at)
    return np.asarray(observations.echo_time / per_meter)


@dataclass(frozen=True)
class Regression:
    """A sum of terms in the columns of a table, each with a coefficient.

    Parameters
    ----------
    terms : sequence of str
        ``"1"``, a column's name, a power ``"temperature^2"`` or a product
        ``"temperature*relative_humidity"``. Columns are the influence quantities,
        ``"distance"`` (the reference), ``"echo_time"`` and every further column of the table.
    response : str
        The column to be described; ``"indication"`` is the indication of a device that converts
        the echoes with `law`.
    law : str
        Name or expression of that law.
    values : tuple of float
        Coefficients, once known.

    Examples
    --------
    >>> Regression.polynomial("temperature", 2).terms
    ('1', 'temperature', 'temperature^2')
    """

    terms: Sequence[str]
    response: str = "indication"
    law: str = "linear"
    values: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        repeated = {term for term in self.terms if list(self.terms).count(term) > 1}
        if not self.terms or repeated:
            raise UsageError(f"a regression needs distinct terms; got {list(self.terms)}")

    @classmethod
    def polynomial(
        cls, column: str, degree: int, *, response: str = "indication", law: str = "linear"
    ) -> "Regression":
        """Return a polynomial in one column.

        Parameters
        ----------
        column : str
            The column that the polynomial is in.
        degree : int
            Its degree; 1 is a straight line.
        response : str
            The column to be described.
        law : str
            Law that turns echoes into indications.
        """
        if not isinstance(degree, int) or degree < 0:
            raise UsageError(f"degree is {degree!r}; give a whole number of 0 or more")
        powers = [column if power == 1 else f"{column}^{power}" for power in range(1, degree + 1)]
        return cls(("1", *powers), response, law)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """One coefficient per term, named like the term."""
        start = self.values or (0.0,) * len(self.terms)
        return tuple(
            Parameter(term, self._unit(term), value) for term, value in zip(self.terms, start, strict=True)
        )

    @property
    def unit(self) -> str:
        """Unit of the response, where it is known."""
        return "m" if self.response == "indication" else UNITS.get(self.response, "")

    def _unit(self, term: str) -> str:
        """Unit of a coefficient; empty where a column's unit is not known."""
        parts = [(UNITS.get(name, ""), power) for name, power in _factors(term)]
        if not self.unit or not all(unit for unit, _ in parts):
            return self.unit if term == "1" else ""
        below = [unit if power == 1 else f"{unit}^{power}" for unit, power in parts if unit != "1"]
        return "/".join([self.unit, *below])

    @property
    def has_intercept(self) -> bool:
        """Whether the terms include the constant."""
        return "1" in self.terms

    @property
    def linear(self) -> bool:
        """A sum of terms is linear in its coefficients."""
        return True

    def observed(self, observations: Observations) -> Column:
        """Return what was observed, shape (n,)."""
        if self.response == "indication":
            return indication(observations, Model(self.law))
        return _column(observations, self.response)

    def columns(self, observations: Observations) -> Columns:
        """Return the columns that the terms read."""
        names = {name for term in self.terms for name, _ in _factors(term)}
        return {name: _column(observations, name) for name in sorted(names)}

    def evaluate(self, values: Column, columns: Columns) -> tuple[Column, Matrix]:
        """Return the prediction and its derivatives, which are the terms themselves."""
        columns = {name: np.asarray(column, dtype=np.float64) for name, column in columns.items()}
        shape = np.broadcast_shapes(*(column.shape for column in columns.values()))
        products = [
            np.prod(
                [np.broadcast_to(columns[name], shape) ** power for name, power in _factors(term)], axis=0
            )
            if term != "1"
            else np.ones(shape)
            for term in self.terms
        ]
        jacobian = np.stack(products, axis=-1)
        return jacobian @ values, jacobian

    def fitted(self, values: Column, covariance: Matrix) -> "Regression":
        """Return the regression with these coefficients."""
        return replace(self, values=tuple(values.tolist()))


def _factors(term: str) -> list[tuple[str, int]]:
    """Names and powers in a term: ``"a^2*b"`` is ``[("a", 2), ("b", 1)]``."""
    if term == "1":
        return []
    factors = []
    for factor in term.split("*"):
        name, caret, power = factor.strip().partition("^")
        if not name or (caret and not power.strip().isdigit()):
            message = f"cannot read the term '{term}'; write '1', 'temperature', 'temperature^2' or 'a*b'"
            raise UsageError(message)
        factors.append((name, int(power) if caret else 1))
    return factors


def _column(observations: Observations, name: str) -> Column:
    known: dict[str, Column] = {"echo_time": observations.echo_time}
    known |= observations.conditions
    known |= observations.extra
    if observations.reference_distance is not None:
        known["distance"] = observations.reference_distance
    if name not in known:
        raise DataError(f"the table has no column '{name}'{among(name, known)}")
    return known[name]


class Chain:
    """A `Model` with some of its parameters free.

    `fit` names parameters as in `echocal.calibrate`; an effect that the model lacks is added. The values of
    the model are where the search begins. Raises `UsageError` if a name is unknown or repeated, or the law
    has no such coefficient.
    """

    unit = "m"
    has_intercept = True
    linear = False

    def __init__(self, model: Model, fit: Iterable[str]) -> None:
        model.refuse_shape("a calibration")
        self.model = model
        self.names = [name for request in fit for name in _expand(request)]
        if not self.names or len(set(self.names)) < len(self.names):
            raise UsageError(f"fit needs distinct parameters, e.g. ['zero_error.offset']; got {self.names}")
        self._law = self._coefficients() if LAW.keys() & set(self.names) else {}
        self._keys = [LAW.get(name, tuple(name.split("."))) for name in self.names]
        self.parameters = [self._parameter(name) for name in self.names]
        start = np.array([parameter.start for parameter in self.parameters])
        self._columns = model.given_columns
        self._extended = Model(model.law, self._effects(start), air=model.air, columns=self._columns)
        order = self._extended.parameter_names
        self._picked = [1 + order.index(".".join(key)) for key in self._keys]

    def observed(self, observations: Observations) -> Column:
        """Return what the device indicated with the model's law [m]."""
        return indication(observations, Model(self.model.law, air=self.model.air))

    def columns(self, observations: Observations) -> Columns:
        """Return the reference distance and the recorded conditions, checked against the model."""
        distance = observations.reference_distance
        if distance is None:
            raise DataError("calibration needs a reference distance; add a column distance_m, _cm or _mm")
        used = observations.usable
        self._columns = {**self._only_thermometer(observations), **self._columns}
        self._extended = Model(
            self.model.law, self._extended.effects, air=self.model.air, columns=self._columns
        )
        given = {**observations.conditions, **observations.bound(self._extended.columns)}
        at = {name: column[used] for name, column in given.items()}
        self._extended.indicate(distance[used], **at)  # refuses or warns as the model does, once
        return {"distance": distance, **given}

    def _only_thermometer(self, observations: Observations) -> dict[str, str]:
        """Where a table has one further thermometer, the effects that read one read this one."""
        names = list(observations.thermometers)
        return {} if len(names) != 1 else dict.fromkeys(FROM_THERMOMETERS, names[0])

    def evaluate(self, values: Column, columns: Columns) -> tuple[Column, Matrix]:
        """Return the indication [m] and the core's exact derivatives."""
        effects = [(id_, list(own.items())) for id_, own in self._effects(values).items()]
        core = _core.Model(self.model.law, effects)
        given = {name: column for name, column in columns.items() if name != "distance"}
        shape, (distance, *rest) = broadcast(columns["distance"], {**self.model.air, **given})
        derivatives = core.jacobian(distance, rest)[:, self._picked]
        return core.indicate(distance, rest).reshape(shape), derivatives.reshape(*shape, -1)

    def fitted(self, values: Column, covariance: Matrix) -> Model:
        """Return the model with these values and their covariance; coefficients go into the law."""
        effects = self._effects(values)
        moved = {name: float(value) for name, value in zip(self.names, values, strict=True) if name in LAW}
        coefficients = self._law | moved
        for name in moved:
            del effects[LAW[name][0]]
        law = (
            f"{coefficients['law.intercept']!r}{coefficients['law.slope']:+.17g}*T"
            if moved
            else self.model.law
        )
        model = Model(law, effects, air=self.model.air, columns=self._columns)
        kept = [index for index, name in enumerate(self.names) if name not in LAW]
        if kept:
            places = [model.parameter_names.index(self.names[index]) for index in kept]
            whole = np.zeros((len(model.parameter_names),) * 2)
            whole[np.ix_(places, places)] = covariance[np.ix_(kept, kept)]
            model = Model(law, effects, air=self.model.air, covariance=whole, columns=self._columns)
        return model

    def _effects(self, values: Column) -> dict[str, dict[str, float]]:
        effects = {id_: dict(parameters) for id_, parameters in self.model.effects.items()}
        for name, (effect, parameter), value in zip(self.names, self._keys, values, strict=True):
            effects.setdefault(effect, {})[parameter] = float(value) - self._law.get(name, 0.0)
        return effects

    def _parameter(self, name: str) -> Parameter:
        effect, parameter = self._keys[self.names.index(name)]
        if name in LAW and effect in self.model.effects:
            raise UsageError(f"cannot fit '{name}': the model already has {effect}, which acts alike")
        facts = next(p for p in find_effect(effect).parameters if p.name == parameter)
        value = self.model.effects.get(effect, {}).get(parameter, facts.neutral)
        shift = self._law.get(name, 0.0)
        low, high = facts.bounds
        return Parameter(name, facts.unit, value + shift, (low + shift, high + shift), facts.prior_scale)

    def _coefficients(self) -> dict[str, float]:
        """Coefficients of the linear law: its speed at 0 degC and per degree, from the core."""
        bare = Model(self.model.law)
        facts = {law["id"]: law["reads"] for law in _core.laws()}
        if facts.get(bare.law, ["temperature"]) != ["temperature"]:
            message = f"law '{bare.law}' has no coefficients to fit; use a linear one, e.g. '331.3+0.606*T'"
            raise UsageError(message)
        at_zero, at_one = bare.speed_of_sound(1.0, temperature=np.array([0.0, 1.0]))
        return {"law.intercept": float(at_zero), "law.slope": float(at_one - at_zero)}


def _expand(request: str) -> list[str]:
    """Names that a request means: one parameter, or all of an effect or of the law."""
    id_, _, parameter = request.partition(".")
    names = list(LAW) if id_ == "law" else [f"{id_}.{facts.name}" for facts in find_effect(id_).parameters]
    if parameter and request not in names:
        raise UsageError(f"cannot fit '{request}'; {id_} has: {', '.join(names)}")
    return [request] if parameter else names
