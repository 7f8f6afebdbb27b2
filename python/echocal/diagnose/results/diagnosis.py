"""The diagnosis that a user gets: its data and its methods."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echocal.diagnose.experiment_design.average import Estimate, averaged
from echocal.diagnose.findings.parts import OF_THIS_TABLE
from echocal.diagnose.results.explain import explain
from echocal.diagnose.results.outcome import Outcome
from echocal.diagnose.results.smooth import refusal
from echocal.errors import UsageError
from echocal.keywords import keyword
from echocal.model import Model
from echocal.observations import Observations
from echocal.outputs import replace_text
from echocal.shown import Shown

if TYPE_CHECKING:
    from pandas import DataFrame

    from echocal.correct.tables import Corrected

__all__ = ["Diagnosis", "plain"]

SCHEMA = "echocal.diagnosis/1"
_TOLD = (
    *("verdict", "causes", "posterior", "credible_set", "unexplained", "smooth", "remainder", "refuted"),
    *("gain", "next_measurements", "rows", "base", "noise", "notes", "settings", "seconds"),
    *("matters_mm", "matters_because", "good_enough"),
)
Column = NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class Diagnosis(Shown, Outcome):
    """What the base simulation gets wrong, with probabilities.

    Its attributes are those of `echocal.diagnose.results.outcome.Outcome`:
    ``verdict``, ``causes``, ``posterior``, ``credible_set``, ``unexplained``, ``refuted``, ``gain``,
    ``next_measurements``, ``rows``, ``base``, ``noise``, ``notes``, ``settings``, ``model``, ``traces``,
    ``fates``, ``members``, ``seconds``, ``smooth``, ``remainder``, ``moved``, ``hidden``,
    ``matters_mm``, ``matters_because`` and ``good_enough``.

    Examples
    --------
    >>> import numpy as np
    >>> import echocal
    >>> reading = 1.008 + 1e-3 * np.sin(np.arange(40.0) ** 2)
    >>> table = {"reading_m": reading, "temperature_C": np.full(40, 20.0)}
    >>> diagnosis = echocal.diagnose(table, reference_distance=1.0)
    >>> print(diagnosis.explain().splitlines()[1])
    40 of 40 rows are used.
    >>> diagnosis.to_dict()["schema"]
    'echocal.diagnosis/1'
    """

    def to_dict(self) -> dict[str, Any]:
        """As ``echocal.diagnosis/1``: plain lists, dictionaries, strings and finite numbers, else None."""
        said = {name: plain(getattr(self, name)) for name in _TOLD}
        if self.smooth is not None:
            said["smooth"]["offered"] = self.smooth.offered
        sets = [{"ids": list(ids), "probability": p} for ids, p in self.posterior]
        return {"schema": SCHEMA, **said, "posterior": sets, "settings": self.settings.to_dict()}

    def row_table(self) -> "DataFrame":
        """What became of each row of the source.

        Returns
        -------
        DataFrame
            ``row`` counts from 1, as messages do. ``fate`` is ``used``, ``held out``, or the reason why the
            row is left out. ``error_before_mm`` and ``error_after_mm`` are reading less reference (or
            level) with the base and with the extended model [mm]; empty for a row that is left out.

        Examples
        --------
        >>> import numpy as np
        >>> import echocal
        >>> reading = 1.008 + 1e-3 * np.sin(np.arange(40.0) ** 2)
        >>> reading[[3, 17, 30]] = 1.9, 1.7, 2.3
        >>> table = {"reading_m": reading, "temperature_C": np.full(40, 20.0)}
        >>> found = echocal.diagnose(table, reference_distance=1.0).row_table()
        >>> found["fate"].iloc[2:4].tolist()
        ['used', 'multipath']
        """
        import pandas as pd  # takes long to import

        before, after = 1e3 * self.traces.before, 1e3 * self.traces.after
        columns = self.fates.columns(self.traces.row, error_before_mm=before, error_after_mm=after)
        return pd.DataFrame(columns)

    def to_json(self, path: str | Path) -> None:
        """Write `to_dict` to a file."""
        text = json.dumps(self.to_dict(), indent=2, allow_nan=False) + "\n"
        replace_text(path, text)

    def predict(self, distance: ArrayLike, **conditions: ArrayLike) -> Estimate:
        """Reading of the device at a true distance, averaged over the possible sets of causes.

        Parameters
        ----------
        distance : array_like
            True distance [m].
        **conditions
            Influence quantities, as for `echocal.Model`. Where humidity, pressure or CO2 is not
            given, the median of the table is used.

        Returns
        -------
        Estimate
            Of the reading [m]. A `DisagreementWarning` reports where the possible sets of causes
            predict different readings.

        Examples
        --------
        >>> import echocal
        >>> import numpy as np
        >>> reading = 1.01 + 1e-3 * np.sin(np.arange(40.0) ** 2)
        >>> table = {"reading_m": reading, "temperature_C": np.linspace(0.0, 40.0, 40)}
        >>> diagnosis = echocal.diagnose(table, reference_distance=1.0)
        >>> estimate = diagnosis.predict([1.0, 3.0], temperature=20.0)
        >>> [round(float(value), 2) for value in estimate.value[:1]], estimate.agreed.tolist()
        ([1.01], [True, False])
        """
        return self._averaged("indicate", distance, conditions)

    @overload
    def correct(self, table: "DataFrame | Mapping[str, Any] | str | Path", **options: Any) -> "Corrected": ...

    @overload
    def correct(self, table: ArrayLike, **options: ArrayLike) -> Estimate: ...

    def correct(self, table: Any, **options: Any) -> "Corrected | Estimate":
        """True distance of each row of a table by `model`, or of readings by all possible sets of causes.

        Parameters
        ----------
        table : table as for `echocal.correct`, or array_like
            A table is read and corrected as `echocal.correct` does. Numbers are readings of the device
            [m], with the base's speed of sound.
        **options
            With a table, arguments of `echocal.correct`. With readings, influence quantities, as for
            `predict`.

        Returns
        -------
        Corrected or Estimate
            Of readings, the estimate of the true distance [m].

        Examples
        --------
        >>> import numpy as np
        >>> import echocal
        >>> reading = 1.008 + 1e-3 * np.sin(np.arange(40.0) ** 2)
        >>> table = {"reading_m": reading, "temperature_C": np.full(40, 20.0)}
        >>> diagnosis = echocal.diagnose(table, reference_distance=1.0)
        >>> diagnosis.correct(table).table["corrected_distance_m"].round(2).unique().tolist()
        [1.0]
        >>> diagnosis.correct([1.008], temperature=20.0).value.round(2).tolist()
        [1.0]
        """
        a_table = isinstance(table, Mapping | str | Path | Observations)
        if a_table or hasattr(table, "columns") or hasattr(table, "schema"):
            from echocal.correct.tables import correct  # takes long to import

            return correct(table, self.model, **options)
        return self._averaged("correct", table, options)

    def _averaged(
        self, method: Literal["indicate", "correct"], first: ArrayLike, conditions: Mapping[str, ArrayLike]
    ) -> Estimate:
        noise, residual = self.noise["standard_deviation_m"], self.model.residual_uncertainty
        return averaged(self.members, method, first, conditions, noise, residual)

    @property
    def model_with_shape(self) -> Model:
        """The model with the unexplained term: a smooth function of one column, without a known cause.

        The function is constant outside the range of the data. Firmware cannot include it. As its
        cause is not known, the function may not hold at another time or place.

        Raises
        ------
        UsageError
            If there is no unexplained term, if it is a function of the row or the time, which no
            later reading has, or if it does not reduce the error on cross-validated or held-out rows.

        Examples
        --------
        >>> import numpy as np
        >>> import echocal
        >>> celsius = 20.0 + 20.0 * np.sin(2.4 * np.arange(200.0))
        >>> kink = 8e-3 * np.exp(-(((celsius - 22) / 5) ** 2)) + 5e-4 * np.sin(np.arange(200.0) ** 2)
        >>> table = {"reading_m": 1.0 + kink, "temperature_C": celsius, "distance_m": np.full(200, 1.0)}
        >>> diagnosis = echocal.diagnose(table)
        >>> model = diagnosis.model_with_shape
        >>> model.shape.against, abs(model.correct(1.008, temperature=22.0) - 1.0) < 2e-3
        ('temperature', True)
        """
        found = self.unexplained
        if found is None or found.shape is None:
            message = "the diagnosis has no unexplained term, so there is none to add to the model"
            raise UsageError(message)
        if found.against in OF_THIS_TABLE:
            message = (
                f"the unexplained term is a function of the {found.against} of this table; later readings "
                "have no such column, so the term cannot extend a model"
            )
            raise UsageError(message)
        if not found.extends:
            without, with_it = (1e3 * (rms or 0.0) for rms in (found.rms_without_m, found.rms_with_m))
            rows = "cross-validated rows" if self.gain is None else self.gain.judged_rows
            message = (
                f"the unexplained term against {found.against} does not reduce the error on {rows} "
                f"({without:.2f} mm without it, {with_it:.2f} mm with it), so it cannot extend the model; "
                f"use the model without it (omit {keyword('with_shape')})"
            )
            raise UsageError(message)
        return self.model.with_shape(found.shape)

    @property
    def model_with_smooth(self) -> Model:
        """The model with the smooth correction: functions of recorded columns, without a known cause.

        Where a column is outside of its range, the correction adds nothing: it does not extrapolate.
        Firmware cannot include it. Use it until the cause is known.

        Raises
        ------
        UsageError
            If none is offered: the interval of its gain on rows that neither its choice nor its fit has
            seen is not above zero.

        Examples
        --------
        >>> import numpy as np
        >>> import echocal
        >>> celsius = 20.0 + 20.0 * np.sin(2.4 * np.arange(200.0))
        >>> kink = 8e-3 * np.exp(-(((celsius - 22) / 5) ** 2)) + 5e-4 * np.sin(np.arange(200.0) ** 2)
        >>> table = {"reading_m": 1.0 + kink, "temperature_C": celsius, "distance_m": np.full(200, 1.0)}
        >>> model = echocal.diagnose(table).model_with_smooth
        >>> model.shape.columns, abs(model.correct(1.008, temperature=22.0) - 1.0) < 2e-3
        (('temperature',), True)
        """
        found = self.smooth
        if found is None or found.smooth is None or not found.offered:
            raise UsageError(refusal(found))
        return self.model.with_shape(found.smooth)

    def explain(self) -> str:
        """The diagnosis in sentences that a user can check in the data."""
        return explain(self)


def plain(value: Any) -> Any:
    """A value as JSON can hold it."""
    if hasattr(value, "__dataclass_fields__"):
        return {name: plain(getattr(value, name)) for name in value.__dataclass_fields__}
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, tuple | list):
        return [plain(item) for item in value]
    bare = value.item() if isinstance(value, np.generic) else value
    return None if isinstance(bare, float) and not math.isfinite(bare) else bare
