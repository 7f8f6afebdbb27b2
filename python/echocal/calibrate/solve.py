"""Fit and propagate: values, what the rows can identify, covariance."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echocal.calibrate.problem import Column, Parameter, Problem, psi, robust_scale
from echocal.errors import ModelError

__all__ = ["Solution", "solve"]

SETTLE = 3  # rounds in which robust values and their scale settle together


@dataclass(frozen=True)
class Solution:
    """Where the search ended; residuals are predicted minus observed, in the response's unit."""

    values: Column
    covariance: NDArray[np.float64]
    residuals: Column
    residual_standard_deviation: float


def solve(problem: Problem, loss: str, loss_scale: float | None) -> Solution:
    """Find the values and propagate the scatter to their covariance.

    Parameters
    ----------
    problem : Problem
        What is fitted, to which rows.
    loss : str
        One of `echocal.calibrate.problem.LOSSES`.
    loss_scale : float or None
        Residual at which the loss turns robust; None takes it from the residuals.

    Returns
    -------
    Solution
        Values, covariance, residuals and their standard deviation.

    Raises
    ------
    ModelError
        If the rows cannot identify a parameter.
    """
    values = problem.first()
    _require_rank(problem.jacobian(values), problem.parameters)
    values = problem.polish(values)
    scale = 1.0
    if loss != "linear":
        for _ in range(SETTLE):
            scale = loss_scale or robust_scale(problem.residuals(values), len(values)) or 1.0
            values = problem.search(values, loss, scale)
    residuals = problem.residuals(values)
    deviation = _deviation(residuals, len(values), loss)
    matrix = problem.jacobian(values)
    if loss == "linear":
        covariance = _covariance(matrix, deviation if problem.sigma is None else 1.0)
    else:
        covariance = _sandwich(matrix, *psi(loss, residuals, scale))
    return Solution(values, covariance, residuals / problem.weight, deviation)


def _deviation(residuals: Column, parameters: int, loss: str) -> float:
    degrees = len(residuals) - parameters
    if degrees < 1:
        return float("nan")
    if loss != "linear":
        return robust_scale(residuals, parameters)
    return float(np.sqrt(residuals @ residuals / degrees))


def _covariance(matrix: NDArray[np.float64], deviation: float) -> NDArray[np.float64]:
    """Covariance of least squares (GUM H.3): the inverse of the normal matrix, from its square root."""
    norms = np.linalg.norm(matrix, axis=0)
    _, singular, axes = np.linalg.svd(matrix / norms, full_matrices=False)
    root = axes.T / singular * deviation
    return np.asarray(root @ root.T / np.outer(norms, norms))


def _sandwich(matrix: NDArray[np.float64], first: Column, second: Column) -> NDArray[np.float64]:
    """Covariance of an M-estimate (Huber 1981, 7.6), from the cost's derivatives."""
    norms = np.linalg.norm(matrix, axis=0)
    scaled = matrix / norms
    rows, parameters = matrix.shape
    bread = np.linalg.inv(scaled.T @ (scaled * second[:, None]))
    meat = scaled.T @ (scaled * first[:, None] ** 2) * (rows / max(rows - parameters, 1))
    return np.asarray(bread @ meat @ bread / np.outer(norms, norms))


def _require_rank(matrix: NDArray[np.float64], parameters: Sequence[Parameter]) -> None:
    """Raise `ModelError` with the names of the parameters that the rows cannot separate."""
    norms = np.linalg.norm(matrix, axis=0)
    names = [parameter.name for parameter in parameters]
    idle = [name for name, norm in zip(names, norms, strict=True) if norm == 0.0]
    if idle:
        message = f"cannot identify {' and '.join(idle)}: no influence on these rows; leave it out of fit"
        raise ModelError(message)
    _, singular, axes = np.linalg.svd(matrix / norms, full_matrices=False)
    if singular[-1] > max(matrix.shape) * np.finfo(float).eps * singular[0]:
        return
    together = [name for name, part in zip(names, axes[-1], strict=True) if abs(part) > 0.05]
    message = (
        f"cannot identify {' and '.join(together)}: on these rows they act alike; fit one of them, "
        "or measure at more distances or under other conditions"
    )
    raise ModelError(message)
