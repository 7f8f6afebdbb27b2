"""Plain machine learning, by scikit-learn, from the same rows: raw, and on what physics leaves."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
from sklearn.ensemble import HistGradientBoostingRegressor, RandomForestRegressor
from sklearn.linear_model import RidgeCV
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures, StandardScaler
from threadpoolctl import threadpool_limits

from compensation.methods import Correction, Method, fixed, physics
from compensation.world import Column

_MILLI = 1e3


def features(log: pd.DataFrame) -> Column:
    """Echo as a distance at 343 m/s [m], temperature and humidity where the log has them."""
    names = [name for name in ("temperature_C", "humidity_percent") if name in log]
    return np.column_stack([fixed(log), *[log[name].to_numpy() for name in names]])


def echo(log: pd.DataFrame) -> Column:
    """Return the first of the features alone."""
    return features(log)[:, :1]


def nothing(log: pd.DataFrame) -> Column:
    """Return zeros: what is left is the distance itself."""
    return np.zeros(len(log))


def learned(
    make: Callable[[int], Any],
    base: Callable[[pd.DataFrame], Column] = physics,
    seen: Callable[[pd.DataFrame], Column] = features,
) -> Callable[[pd.DataFrame, int], Correction]:
    """Learn what a base leaves of the distance [mm], from what is seen."""

    def learn(log: pd.DataFrame, seed: int) -> Correction:
        x, left = seen(log), _MILLI * (log["distance_m"].to_numpy() - base(log))
        known = np.isfinite(x).all(axis=1) & np.isfinite(left)
        with threadpool_limits(1):
            fitted = make(seed).fit(x[known], left[known])
        return lambda other: base(other) + _filled(fitted, seen(other)) / _MILLI

    return learn


def _filled(fitted: Any, x: Column) -> Column:
    """Predict where all features are known."""
    known = np.isfinite(x).all(axis=1)
    found = np.full(len(x), np.nan)
    with threadpool_limits(1):
        found[known] = fitted.predict(x[known])
    return found


def _polynomial(seed: int) -> Any:
    return make_pipeline(StandardScaler(), PolynomialFeatures(2), RidgeCV(np.logspace(-8, 2, 11)))


def _forest(seed: int) -> Any:
    return RandomForestRegressor(100, min_samples_leaf=5, random_state=seed)


def _boosting(seed: int) -> Any:
    return HistGradientBoostingRegressor(random_state=seed)


LEARNERS = {
    "polynomial": Method("polynomial of degree 2, ridge", learned(_polynomial, nothing)),
    "forest_left": Method("random forest of what Cramer leaves", learned(_forest)),
    "boosting_left": Method("gradient boosting of what Cramer leaves", learned(_boosting)),
    "boosting_echo": Method("gradient boosting over the distance alone", learned(_boosting, seen=echo)),
}
