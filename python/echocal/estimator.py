"""A correction as an estimator of scikit-learn."""

import warnings
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from echocal.calibrate import Calibration, calibrate
from echocal.correct import correct
from echocal.correct.needed import NOT_CHECKED
from echocal.correct.results import DISTANCE
from echocal.diagnose import Diagnosis, diagnose
from echocal.errors import DataError, DataWarning, UsageError
from echocal.model import Model
from echocal.observations.mount import is_level
from echocal.observations.plan import read_columns

try:
    from sklearn.base import BaseEstimator, RegressorMixin, TransformerMixin
    from sklearn.utils.validation import check_is_fitted, validate_data
except ImportError:
    raise UsageError("EchoCorrector needs scikit-learn: pip install 'echocal[sklearn]'") from None

__all__ = ["EchoCorrector"]

_ORDER = ("echo_us", "temperature_C", "humidity_percent")
"""What the columns of an array without names are; those after them are further columns."""

_REFERENCE = "distance_m"


class EchoCorrector(RegressorMixin, TransformerMixin, BaseEstimator):  # type: ignore[misc]
    """Learn what a sensor gets wrong from reference distances, and correct other echoes.

    Parameters
    ----------
    model : Model, optional
        Where the fit begins; default: ``Model("cramer")``. Also the base of the diagnosis.
    parameters : sequence of str, optional
        What to fit, as in `echocal.calibrate`: ``["fixed_delay", "zero_error.offset"]``. Default: what
        `echocal.diagnose` finds.
    columns : mapping of str to str, optional
        Meaning of columns of a table by their names, as in `echocal.read_observations`.
    reading_speed : str or float, optional
        Speed that the firmware made readings with [m/s]; default: the law of the model.

    Attributes
    ----------
    model_ : Model
        The model that corrects.
    result_ : Diagnosis or Calibration
        How it was found.
    n_features_in_ : int
    feature_names_in_ : ndarray of str
        Columns of the table of the fit, where it has names.

    Notes
    -----
    A table with names is read by them, with their units, as `echocal.read_observations` does:
    ``echo_us``, ``reading_cm``, ``temperature_C``, ``humidity_percent``, ... An array has no names. Its
    columns are ``echo_us``, ``temperature_C``, ``humidity_percent`` in this order, and further ones without
    a meaning.
    An array of one column has echo times at 20 degC.

    A column of a table that looks as if it were in another unit is refused. That of an array is believed.

    A row with NaN, or with a value that is not possible, does not count in the fit. `predict` and
    `transform` give NaN for it. An infinite value is an error.

    Examples
    --------
    >>> import numpy as np
    >>> import echocal
    >>> celsius = np.linspace(5.0, 35.0, 60)
    >>> distance = np.tile([0.5, 1.0, 2.0], 20)
    >>> device = echocal.Model("cramer", {"fixed_delay": {"delay": 30e-6}})
    >>> echo = device.time_of_flight(distance, temperature=celsius)
    >>> X = np.column_stack([1e6 * echo, celsius])
    >>> corrector = echocal.EchoCorrector(parameters=["fixed_delay"]).fit(X, distance)
    >>> round(corrector.model_.effects["fixed_delay"]["delay"] * 1e6, 3)
    30.0
    >>> corrector.transform(X[:2]).round(6).tolist()
    [[0.5], [1.0]]
    """

    def __init__(
        self,
        model: Model | None = None,
        parameters: Sequence[str] | None = None,
        columns: Mapping[str, str] | None = None,
        reading_speed: str | float | None = None,
    ) -> None:
        self.model = model
        self.parameters = parameters
        self.columns = columns
        self.reading_speed = reading_speed

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.input_tags.allow_nan = True
        tags.input_tags.positive_only = True  # of an echo time; a temperature may be below 0
        tags.target_tags.positive_only = True
        tags.regressor_tags.poor_score = True  # physics: it fits no numbers that are none of an echo
        return tags

    def fit(self, X: Any, y: ArrayLike) -> "EchoCorrector":
        """Find the model of the sensor.

        Parameters
        ----------
        X : DataFrame or array_like, shape (n, m)
            Echoes; see the notes of the class.
        y : array_like, shape (n,)
            Reference distance [m].

        Raises
        ------
        DataError
            If there are too few rows, or they cannot be read.
        """
        if y is None:
            raise DataError("EchoCorrector requires y to be passed, but the target y is None")
        table, y = self._table(X, y)
        begin = Model("cramer") if self.model is None else self.model
        if levels := [n for n, own in read_columns(self.columns).items() if is_level(n, own)]:
            raise DataError(
                f"'{levels[0]}' is a level, and y is a distance: give distances, mount height - level"
            )
        if _REFERENCE in table:
            raise DataError(
                f"X has a column '{_REFERENCE}', and y is the reference distance: leave the column out"
            )
        if len(table) < 2:
            raise DataError("n_samples=1: one row tells nothing of a sensor; give more")
        how: dict[str, Any] = {
            "columns": self.columns,
            "reading_speed": self.reading_speed,
            "trust": self._trusted(table, _REFERENCE),
        }
        how = {name: value for name, value in how.items() if value is not None}
        rows = table.assign(**{_REFERENCE: np.asarray(y, dtype=np.float64)})
        self.result_: Diagnosis | Calibration
        if self.parameters is None:
            self.result_ = diagnose(rows, base=begin, **how)
        else:
            self.result_ = calibrate(rows, begin, self.parameters, **how)
        self.model_ = self.result_.model
        return self

    def predict(self, X: Any) -> NDArray[np.float64]:
        """Corrected distances.

        Parameters
        ----------
        X : DataFrame or array_like, shape (n, m)

        Returns
        -------
        ndarray, shape (n,)
            Corrected distance [m]; NaN where a row could not be used. `echocal.correct` with `model_` tells
            the reasons.
        """
        check_is_fitted(self)
        table, _ = self._table(X)
        how: dict[str, Any] = {"reading_speed": self.reading_speed, "trust": self._trusted(table)}
        done = correct(table, self.model_, self.columns, **how)
        for note in done.notes:
            if note.startswith(NOT_CHECKED):
                warnings.warn(note, DataWarning, stacklevel=2)
        return np.array(done.table[DISTANCE], dtype=np.float64)

    def transform(self, X: Any) -> NDArray[np.float64]:
        """Corrected distances as a column, shape (n, 1) [m]; see `predict`."""
        return self.predict(X)[:, np.newaxis]

    def get_feature_names_out(self, input_features: Any = None) -> NDArray[np.object_]:
        """Name of the column of `transform`: ``corrected_distance_m``."""
        check_is_fitted(self)
        return np.array([DISTANCE], dtype=object)

    def _trusted(self, table: pd.DataFrame, *more: str) -> list[str]:
        """Columns whose unit is not doubted: those of an array, which has the order for a name."""
        return [] if hasattr(self, "feature_names_in_") else [*table, *more]

    def _table(self, X: Any, y: Any = None) -> tuple[pd.DataFrame, Any]:
        """X with names, and y, checked as scikit-learn checks them."""
        fitting = y is not None
        checks: dict[str, Any] = {"reset": fitting, "dtype": np.float64, "ensure_all_finite": "allow-nan"}
        if fitting:
            numbers, y = validate_data(self, X, y, y_numeric=True, **checks)
        else:
            numbers = validate_data(self, X, **checks)
        names = getattr(self, "feature_names_in_", None)
        if names is None:
            more = [f"x{place}" for place in range(len(_ORDER), numbers.shape[1])]
            names = [*_ORDER, *more][: numbers.shape[1]]
        table = pd.DataFrame(numbers, columns=list(names))
        if hasattr(self, "feature_names_in_") or "temperature_C" in table:
            return table, y
        return table.assign(temperature_C=20.0), y
