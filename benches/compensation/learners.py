"""Plain machine learning, by scikit-learn, from the same rows: raw, and on what physics leaves."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
from sklearn.ensemble import HistGradientBoostingRegressor, RandomForestRegressor
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, WhiteKernel
from sklearn.linear_model import LinearRegression, RidgeCV
from sklearn.neural_network import MLPRegressor
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures, StandardScaler
from threadpoolctl import threadpool_limits

from compensation.methods import Correction, Method, fixed, physics
from compensation.world import Column

_MILLI = 1e3


def features(log: pd.DataFrame) -> Column:
    """Echo as a distance at 343 m/s [m], temperature, humidity and pressure where the log has them."""
    names = [name for name in ("temperature_C", "humidity_percent", "pressure_hPa") if name in log]
    return np.column_stack([fixed(log), *[log[name].to_numpy() for name in names]])


def _plain(make: Callable[[int], Any]) -> Callable[[pd.DataFrame, int], Correction]:
    """Learn the distance itself."""

    def learn(log: pd.DataFrame, seed: int) -> Correction:
        x, y = features(log), log["distance_m"].to_numpy()
        known = np.isfinite(x).all(axis=1)
        with threadpool_limits(1):
            fitted = make(seed).fit(x[known], y[known])
        return lambda other: _filled(fitted, features(other))

    return learn


def _echo(log: pd.DataFrame) -> Column:
    """Return the first of the features alone."""
    return features(log)[:, :1]


def _residual(
    make: Callable[[int], Any], seen: Callable[[pd.DataFrame], Column] = features
) -> Callable[[pd.DataFrame, int], Correction]:
    """Learn what the distance by Cramer leaves."""

    def learn(log: pd.DataFrame, seed: int) -> Correction:
        x, left = seen(log), _MILLI * (log["distance_m"].to_numpy() - physics(log))
        known = np.isfinite(left)
        with threadpool_limits(1):
            fitted = make(seed).fit(x[known], left[known])
        return lambda other: physics(other) + _filled(fitted, seen(other)) / _MILLI

    return learn


def _filled(fitted: Any, x: Column) -> Column:
    """Predict where all features are known."""
    known = np.isfinite(x).all(axis=1)
    found = np.full(len(x), np.nan)
    with threadpool_limits(1):
        found[known] = fitted.predict(x[known])
    return found


def _linear(seed: int) -> Any:
    return LinearRegression()


def _polynomial(seed: int) -> Any:
    return make_pipeline(StandardScaler(), PolynomialFeatures(2), RidgeCV(np.logspace(-8, 2, 11)))


def _forest(seed: int) -> Any:
    return RandomForestRegressor(100, min_samples_leaf=5, random_state=seed)


def _boosting(seed: int) -> Any:
    return HistGradientBoostingRegressor(random_state=seed)


def _network(seed: int) -> Any:
    return make_pipeline(
        StandardScaler(), MLPRegressor(hidden_layer_sizes=(32, 32), max_iter=2000, random_state=seed)
    )


class _Averaged:
    """A Gaussian process of the means of groups of rows: its cost grows with the cube of their number."""

    def __init__(self, seed: int) -> None:
        process = GaussianProcessRegressor(RBF(1.0) + WhiteKernel(0.1), normalize_y=True)
        self.process = make_pipeline(StandardScaler(), process)

    def fit(self, x: Column, y: Column) -> "_Averaged":
        group = np.arange(len(x)) // 5
        frame = pd.DataFrame(np.column_stack([x, y])).groupby(group).mean().to_numpy()
        self.process.fit(frame[:, :-1], frame[:, -1])
        return self

    def predict(self, x: Column) -> Column:
        return np.asarray(self.process.predict(x))


LEARNERS = {
    "linear": Method("linear regression", _plain(_linear)),
    "polynomial": Method("polynomial of degree 2, ridge", _plain(_polynomial)),
    "network": Method("neural network, 2 x 32", _plain(_network)),
    "forest": Method("random forest", _plain(_forest)),
    "boosting": Method("gradient boosting", _plain(_boosting)),
    "forest_left": Method("random forest of what Cramer leaves", _residual(_forest)),
    "boosting_left": Method("gradient boosting of what Cramer leaves", _residual(_boosting)),
    "boosting_echo": Method("gradient boosting over the distance alone", _residual(_boosting, _echo)),
    "process_left": Method("Gaussian process of what Cramer leaves", _residual(_Averaged)),
}
