"""Tables that speak against a cause: their rows refute it. Eq. 39."""

from collections.abc import Sequence

import numpy as np

from echocal.diagnose.findings.parts import Refuted
from echocal.diagnose.pooling.search import Pool
from echocal.diagnose.pooling.table import TableInference
from echocal.diagnose.settings import Settings

__all__ = ["opposition"]


def opposition(tables: Sequence[TableInference], settings: Settings) -> dict[tuple[str, str], float]:
    """Log odds of tables against causes, by the names of both; not above 0.

    A cause that its table refutes has the difference of the log scores on the rows of the folds. Chance
    refutes a weak cause often, so this counts for strong ones only.
    """
    pool = Pool(tables, settings)
    limit = settings.pooling.against
    found: dict[tuple[str, str], float] = {}
    for table in tables:
        for refuted in table.diagnosis.refuted:
            loss = _log_score(table, refuted)
            if loss < 0.0 and _likelihood_ratio(pool, table, refuted.id) >= settings.pooling.strong:
                found[table.name, refuted.id] = max(loss, -limit)
    return {key: value for key, value in found.items() if key[1] in pool.forms}


def _log_score(table: TableInference, refuted: Refuted) -> float:
    """Log score with the cause less that without it; of errors alone, on as many rows as were independent."""
    if refuted.log_score is not None:
        return refuted.log_score
    noise, rows = table.diagnosis.noise, len(table.table)
    independent = rows * (1 - noise["autoregression"]) / (1 + noise["autoregression"])
    return float(-independent * np.log(refuted.rms_with_m / refuted.rms_without_m))


def _likelihood_ratio(pool: Pool, table: TableInference, cause: str) -> float:
    """Log likelihood ratio of a cause at its best size, against the rest of the hypotheses of its table."""
    if cause not in table.competing:
        return 0.0
    best = -np.inf
    for form in pool.forms[cause]:
        log, information, precision = table.likelihood((form,))
        best = max(best, log + 0.5 * float(information @ np.linalg.pinv(precision) @ information))
    without = [fit.log_posterior for fit in table.fits if cause not in fit.hypothesis.causes]
    return best - float(np.logaddexp.reduce(without)) if without else np.inf
