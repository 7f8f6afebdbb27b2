"""A model: a law for the speed of sound and the effects that extend it."""

import copy
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal import _core
from echocal.conditions import columns, refuse_unknown
from echocal.errors import ModelError
from echocal.model import added, arguments, document, expressions, needs, uncertainty
from echocal.model.residual_uncertainty import ResidualUncertainty
from echocal.model.shape import DISTANCE, Shape, Smooth
from echocal.quantities import QUANTITIES
from echocal.registry import find_effect
from echocal.shown import Shown

Values = NDArray[np.float64]


class Model(Shown):
    """A law for the speed of sound and the effects that extend it.

    The law holds for the echo in the true conditions, and the device converts with the same law in the
    recorded conditions; effects change either of them. Methods take the recorded influence quantities as
    keywords:
    ``temperature`` [degC], ``relative_humidity`` [1], ``pressure`` [Pa], ``co2_mole_fraction``
    [1], ``elapsed_time`` [s], ``supply_voltage`` [V], ``angle`` [rad], ``wind_speed`` [m/s],
    ``radiation`` [W/m^2], ``amplitude`` [1], and what `read_observations` derives from a table's rows
    (`echocal.quantities.QUANTITIES` has all). They broadcast against the first argument; scalars
    alone give a float; pandas, xarray, dask and polars (expressions, too) come back as their own
    type, and the keywords `out` and `n_threads` act as in `echocal.distance`. Without their keyword,
    humidity is 0, pressure 101325 Pa and CO2 0.04 %; NaN in gives NaN out, and one `DomainWarning`
    says where a law is used outside its domain.

    Parameters
    ----------
    law : str
        Name of a law, or a linear expression such as ``"331.3+0.606*T"`` or ``"343"``.
    effects : mapping of str to mapping of str to float
        Parameters by effect id and parameter name, SI units; what is not given stays neutral.
    air : mapping of str to float
        Values assumed where a condition is not given, e.g. ``{"relative_humidity": 0.5}``.
    covariance : array_like, shape (n, n), optional
        Covariance of the parameters in the order of `parameter_names`; zero where one was held.
    provenance : mapping, optional
        Where the model comes from; saved without change, not part of the `hash`.
    shape : Shape or Smooth, optional
        An unexplained term, or a smooth correction, that is added to the indications; no firmware can
        contain it.
    columns : mapping of str to str, optional
        Column of a table from which a quantity is read that several columns may hold, e.g.
        ``{"second_temperature": "temperature_box_C"}``.
    residual_uncertainty : ResidualUncertainty, optional
        Standard uncertainty of one corrected distance besides that of the parameters, as measured.

    Raises
    ------
    ModelError
        If a name is unknown, a parameter lies outside its bounds, the effects contradict each
        other or the law, or the covariance does not fit.

    Examples
    --------
    >>> model = Model(law="linear", effects={"fixed_delay": {"delay": 30e-6}})
    >>> round(model.indicate(2.0, temperature=20.0), 6)
    2.005151
    >>> round(model.correct(2.005151, temperature=20.0), 9)
    2.0
    >>> model.parameter_names
    ('fixed_delay.delay',)
    >>> model.jacobian(2.0, temperature=20.0)
    array([  1. , 171.7])
    """

    def __init__(
        self,
        law: str = "cramer",
        effects: Mapping[str, Mapping[str, float]] | None = None,
        *,
        air: Mapping[str, float] | None = None,
        covariance: ArrayLike | None = None,
        provenance: Mapping[str, Any] | None = None,
        shape: Shape | Smooth | None = None,
        columns: Mapping[str, str] | None = None,
        residual_uncertainty: ResidualUncertainty | None = None,
    ) -> None:
        arguments.refuse_no_text(law)
        self._build(law, effects or {})
        arguments.refuse_standstill(self._core.law)
        own = {id_: arguments.by_name(id_, values) for id_, values in self._core.terms}
        self._set(
            air=arguments.fixed(needs.assumed(air or {})),
            effects=arguments.fixed(own),
            covariance=arguments.checked_covariance(
                covariance, tuple(f"{id_}.{p}" for id_ in own for p in own[id_])
            ),
            provenance=arguments.fixed(provenance or {}),
            shape=shape,
            given_columns=arguments.fixed(needs.of_thermometers(columns or {})),
            residual_uncertainty=residual_uncertainty,
        )

    _core: _core.Model
    _needs: needs.Needs
    air: Mapping[str, float]
    effects: Mapping[str, Mapping[str, float]]
    covariance: Values | None
    provenance: Mapping[str, Any]
    shape: Shape | Smooth | None
    given_columns: Mapping[str, str]
    residual_uncertainty: ResidualUncertainty | None

    def _set(self, **parts: Any) -> "Model":
        vars(self).update(parts)
        return self

    def __setattr__(self, name: str, value: object) -> None:
        message = f"a model does not change, and '{name}' cannot be set; build another one: Model(law, ...)"
        raise ModelError(message)

    def __delattr__(self, name: str) -> None:
        self.__setattr__(name, None)

    def __eq__(self, other: object) -> bool:
        same: bool = isinstance(other, Model) and document.content(self) == document.content(other)
        return same

    def __hash__(self) -> int:
        return hash(self.hash)

    def _build(self, law: str, effects: Mapping[str, Mapping[str, float]]) -> None:
        try:
            core = _core.Model(law, arguments.terms(effects))
        except UnicodeEncodeError:
            message = f"the law {law!r}, or the name of an effect or a parameter, is no text in Unicode"
            raise ModelError(message) from None
        self._set(_core=core, _needs=needs.of(core))

    def __getstate__(self) -> dict[str, Any]:
        """What a copy is made of, here or in another process: the compiled parts are built anew."""
        built = {"_core", "_needs"}
        return {"law": self.law, **{name: own for name, own in vars(self).items() if name not in built}}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._set(**{name: own for name, own in state.items() if name != "law"})
        self._build(state["law"], self.effects)

    @property
    def law(self) -> str:
        """Name or expression of the law."""
        return self._core.law

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """Names ``effect.parameter`` in the order of the measurement chain."""
        return tuple(f"{id_}.{name}" for id_, own in self.effects.items() for name in own)

    @property
    def reads(self) -> frozenset[str]:
        """Influence quantities that the law and the effects react to or ask for."""
        effects = [find_effect(id_) for id_ in self.effects]
        own = (name for effect in effects for name in (*effect.reads, *effect.requires))
        return frozenset((*self._core.law_reads, *own))

    @property
    def columns(self) -> dict[str, str]:
        """Column of a table by quantity, for quantities that it reads and several columns may hold."""
        return {quantity: name for quantity, name in self.given_columns.items() if quantity in self.reads}

    @property
    def standard_uncertainties(self) -> dict[str, float | None]:
        """Standard uncertainty by parameter name; None where it is not known."""
        if self.covariance is None:
            return dict.fromkeys(self.parameter_names)
        deviations = np.sqrt(np.diag(self.covariance)).tolist()
        return dict(zip(self.parameter_names, deviations, strict=True))

    @property
    def hash(self) -> str:
        """SHA-256 of the model's canonical content, without its provenance."""
        return document.digest(document.content(self))

    def save(self, path: str | Path) -> None:
        """Write the model as JSON, schema ``echocal.model/1``.

        Parameters
        ----------
        path : str or Path
            File to write; an existing one is replaced when the new one is complete.

        Raises
        ------
        ModelError
            If the file cannot be written, or the provenance is not plain finite data.

        Examples
        --------
        >>> import tempfile, pathlib
        >>> path = pathlib.Path(tempfile.mkdtemp()) / "model.json"
        >>> Model("linear", {"zero_error": {"offset": 2e-3}}).save(path)
        >>> Model.load(path).effects
        {'zero_error': {'offset': 0.002}}
        """
        document.write(self, Path(path))

    @classmethod
    def load(cls, path: str | Path) -> "Model":
        """Read a model that `save` wrote, or one written by hand (which needs no hash).

        Parameters
        ----------
        path : str or Path
            File of schema ``echocal.model/1``.

        Raises
        ------
        ModelError
            If the file cannot be read, is not JSON, has another or a newer schema, does not match
            its hash, or describes no valid model; the text names the file and the place.
        """
        from echocal.model.reading import built  # slow import: only reading a file needs it

        return built(cls, Path(path))

    @overload
    def indicate(self, distance: float, **conditions: float | None) -> float: ...
    @overload
    def indicate(self, distance: ArrayLike, **conditions: ArrayLike | None) -> Values: ...
    def indicate(self, distance: ArrayLike, **conditions: ArrayLike | None) -> float | Values:
        """Return what the device indicates [m] at a true distance [m]."""
        if expressions.among(distance, conditions):
            return expressions.over(self.indicate, distance, conditions, "indication")  # type: ignore[no-any-return]
        if self.shape is None:
            return self._map(self._core.indicate, distance, conditions)
        bare = partial(self._map, self._core.indicate)
        shifted: float | Values = added.indicated(self.shape, self.air, distance, conditions, bare)
        return shifted

    @overload
    def speed_of_sound(self, distance: float, **conditions: float | None) -> float: ...
    @overload
    def speed_of_sound(self, distance: ArrayLike, **conditions: ArrayLike | None) -> Values: ...
    def speed_of_sound(self, distance: ArrayLike, **conditions: ArrayLike | None) -> float | Values:
        """Return the speed of sound on the path [m/s] at a true distance [m]."""
        if expressions.among(distance, conditions):
            return expressions.over(self.speed_of_sound, distance, conditions, "speed_of_sound")  # type: ignore[no-any-return]
        return self._map(self._core.speed_of_sound, distance, conditions)

    @overload
    def time_of_flight(self, distance: float, **conditions: float | None) -> float: ...
    @overload
    def time_of_flight(self, distance: ArrayLike, **conditions: ArrayLike | None) -> Values: ...
    def time_of_flight(self, distance: ArrayLike, **conditions: ArrayLike | None) -> float | Values:
        """Return the echo time, out and back, that the device records [s] at a true distance [m]."""
        if expressions.among(distance, conditions):
            return expressions.over(self.time_of_flight, distance, conditions, "time_of_flight")  # type: ignore[no-any-return]
        self.refuse_shape("an echo time")
        return self._map(self._core.time_of_flight, distance, conditions, times=True)

    @overload
    def correct(self, indication: float, **conditions: float | None) -> float: ...
    @overload
    def correct(self, indication: ArrayLike, **conditions: ArrayLike | None) -> Values: ...
    def correct(self, indication: ArrayLike, **conditions: ArrayLike | None) -> float | Values:
        """Return the true distance [m] of an indication [m]; NaN where there is none."""
        if expressions.among(indication, conditions):
            return expressions.over(self.correct, indication, conditions, "distance")  # type: ignore[no-any-return]
        if self.shape is None:
            return self._map(self._core.correct, indication, conditions)
        own = arguments.numeric("the first argument", indication)
        bare = partial(self._map, self._core.correct)
        corrected: float | Values = added.corrected(self.shape, self.air, own, conditions, bare)
        return corrected

    @overload
    def distance(self, time: float, **conditions: float | None) -> float: ...
    @overload
    def distance(self, time: ArrayLike, **conditions: ArrayLike | None) -> Values: ...
    def distance(self, time: ArrayLike, **conditions: ArrayLike | None) -> float | Values:
        """Return the true distance [m] of a recorded echo time [s]; NaN where there is none."""
        if expressions.among(time, conditions):
            return expressions.over(self.distance, time, conditions, "distance")  # type: ignore[no-any-return]
        self.refuse_shape("the distance of an echo time")
        return self._map(self._core.distance, time, conditions, times=True)

    def jacobian(self, distance: ArrayLike, **conditions: ArrayLike | None) -> Values:
        """Return exact derivatives of the indication, shape (..., 1 + n).

        The first column is the derivative to the distance [1], then one per parameter in the
        order of `parameter_names` [m per unit of the parameter].
        """
        if self.shape is not None and DISTANCE in self.shape.columns:
            self.refuse_shape("a derivative")
        shape, (first, *rest) = columns(distance, self._conditions(conditions))
        return self._core.jacobian(first, rest).reshape(*shape, -1)

    def standard_uncertainty(self, distance: ArrayLike, **conditions: ArrayLike | None) -> Values:
        """Return the standard uncertainty of corrected distances [m]; NaN if the model states none.

        It has the covariance of the parameters, the uncertainty of an unexplained term or a smooth
        correction, and the residual uncertainty; see `echocal.model.uncertainty.standard_uncertainty`.
        """
        return uncertainty.standard_uncertainty(self, distance, conditions)

    def with_shape(self, shape: Shape | Smooth | None) -> "Model":
        """The same model with an unexplained term or a smooth correction."""
        return self._like(self.effects, shape)._set(covariance=self.covariance)

    def without_shape(self) -> "Model":
        """The same model without its unexplained term or smooth correction."""
        return self.with_shape(None)

    def with_provenance(self, provenance: Mapping[str, Any]) -> "Model":
        """The same model with another record of where it comes from."""
        return copy.copy(self)._set(provenance=arguments.fixed(provenance))

    def with_covariance(self, covariance: ArrayLike) -> "Model":
        """The same model with another covariance of its parameters, in the order of `parameter_names`."""
        return copy.copy(self)._set(covariance=arguments.checked_covariance(covariance, self.parameter_names))

    def with_residual_uncertainty(self, residual: ResidualUncertainty | None) -> "Model":
        """The same model with another residual uncertainty."""
        return copy.copy(self)._set(residual_uncertainty=residual)

    def _like(self, effects: Mapping[str, Mapping[str, float]], shape: Shape | Smooth | None) -> "Model":
        names = ("air", "provenance", "residual_uncertainty")
        known: dict[str, Any] = {name: getattr(self, name) for name in names}
        return Model(self.law, effects, **known, shape=shape, columns=self.given_columns)

    @property
    def campaign_effects(self) -> tuple[str, ...]:
        """Effects that belong to the campaign they were found in, such as ``drift``."""
        return tuple(id_ for id_ in self.effects if not find_effect(id_).recurs)

    def transferable(self) -> "Model":
        """The model for another campaign: without effects that began or grew in the course of one.

        Examples
        --------
        >>> model = Model("linear", {"fixed_delay": {"delay": 3e-5}, "drift": {"rate": 1e-8}})
        >>> model.campaign_effects
        ('drift',)
        >>> list(model.transferable().effects)
        ['fixed_delay']
        """
        effects = {id_: own for id_, own in self.effects.items() if id_ not in self.campaign_effects}
        kept = [i for i, name in enumerate(self.parameter_names) if name.partition(".")[0] in effects]
        known = None if self.covariance is None else self.covariance[np.ix_(kept, kept)]
        return self._like(effects, self.shape)._set(covariance=known)

    def refuse_shape(self, what: str) -> None:
        """Raise `ModelError` if the model has an unexplained term, which `what` cannot use."""
        if self.shape is not None:
            kind = "a smooth correction" if isinstance(self.shape, Smooth) else "an unexplained term"
            has = f"the model has {kind} against {self.shape.against}"
            raise ModelError(f"{has}, and {what} cannot use it; Model.without_shape() removes it")

    def __repr__(self) -> str:
        air = f", air={self.air}" if self.air else ""
        kind = "smooth correction" if isinstance(self.shape, Smooth) else "shape"
        shape = f", {kind} against {self.shape.against} (not explained)" if self.shape else ""
        columns = f", columns={self.columns}" if self.columns else ""
        return f"Model({self.law!r}, {self.effects}{air}{columns}{shape})"

    def refuse_missing(self, conditions: Mapping[str, Any]) -> None:
        """Raise `DataError` where a condition that the model needs is not among these names."""
        self._needs.check({**self.air, **conditions})

    def _conditions(
        self, given: Mapping[str, ArrayLike | None], *, times: bool = False
    ) -> dict[str, ArrayLike]:
        refuse_unknown(given)
        known = {name: arguments.numeric(name, value) for name, value in given.items() if value is not None}
        conditions: dict[str, ArrayLike] = {**self.air, **known}
        self._needs.check(conditions, times=times)
        self._needs.warn_outside(conditions, self.effects)
        return conditions

    def _map(
        self,
        function: Callable[..., float | Values],
        first: ArrayLike,
        given: Mapping[str, Any],
        *,
        times: bool = False,
    ) -> float | Values:
        named, out, n_threads = arguments.apart(given)
        conditions = self._conditions(named, times=times)
        first = arguments.numeric("the first argument", first)
        return function(first, [conditions.get(name) for name in QUANTITIES], out, n_threads)
