"""The certificate of corrected distances: one HTML file, or a PDF of two pages."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import date
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.budget import Budget, budget
from echocal.budget.conformity import Conformity, assessed, budget_of_errors
from echocal.budget.coverage import COVERAGE, DECISIONS, plus_minus
from echocal.budget.entries import Entry, Itemized
from echocal.concise import concise
from echocal.errors import UsageError
from echocal.model import Model
from echocal.observations import Observations
from echocal.outputs import replace_text, replacing
from echocal.quantities import QUANTITIES
from echocal.registry import find_effect
from echocal.report.budget import (
    HEADS,
    conditions_at,
    conditions_head,
    conditions_text,
    lines,
    probability_text,
    result_text,
)
from echocal.report.html.document import rendered

_MOST = 12  # lines of results, so that they stay on their page
_PARAMETERS = 8  # of the model, that are listed


@dataclass(frozen=True)
class Certificate:
    """Corrected distances with their uncertainty, and what they decide."""

    model: Model
    observations: Observations
    budget: Budget
    conformity: Conformity
    """Of measured errors, where there are reference distances; else of an error of 0 with the uncertainty of
    the distance."""
    measured: bool
    """Whether there are reference distances."""
    rows: NDArray[np.int64]
    """Places of the rows that have a distance, and a reference distance where there are any."""
    of_errors: Itemized = field(default_factory=lambda: Itemized(()))
    """The budget of the measured errors, row by row: its expanded uncertainty is the guard band."""

    @property
    def decision(self) -> str:
        """What is decided about all rows together: the worst of `echocal.budget.coverage.DECISIONS`."""
        return DECISIONS[int(self.conformity.decision.max())]

    @property
    def statement(self) -> str:
        """The statement of conformity in a sentence."""
        counts = np.bincount(self.conformity.decision, minlength=3)
        bound = f"{1e3 * self.conformity.bound:g} mm"
        what = "errors" if self.measured else "distances"
        parts = [
            f"{int(n)} {words}"
            for n, words in zip(counts, ("conform", "are undecided", "do not conform"), strict=True)
            if n
        ]
        return (
            f"Of {len(self.rows)} {what}, {', '.join(parts)} with the maximum permissible error of ±{bound}. "
            f"The least probability of conformity is {probability_text(self.conformity.probability.min())}."
        )


def certify(
    model: Model,
    observations: Observations,
    *,
    maximum_permissible_error: float,
    uncertainties: Any = (),
    coverage: float = COVERAGE,
) -> Certificate:
    """Budget and conformity of the corrected distances of a table.

    With reference distances, errors are measured, and their own budget is the guard band. The maximum
    permissible error is in m; uncertainties are as in `echocal.budget`.

    Examples
    --------
    >>> import echocal
    >>> row = {"echo_us": [5846.0], "temperature_C": [20.0], "humidity_percent": [50.0]}
    >>> table = echocal.read_observations(row)
    >>> stated = {"thermometer": "DHT22", "reading_mm": 0.5, "echo_us": 1.0}
    >>> found = certify(echocal.Model("cramer"), table, maximum_permissible_error=3e-3, uncertainties=stated)
    >>> found.decision
    'conforms'
    """
    if not 0.0 < maximum_permissible_error < np.inf:
        raise UsageError(
            f"the maximum permissible error must be a positive length [m], got {maximum_permissible_error!r}"
        )
    found = budget(model, observations, uncertainties=uncertainties, coverage=coverage)
    rows = np.flatnonzero(np.isfinite(found.distance) & observations.usable)
    measured = observations.reference_distance is not None
    if measured:
        reference = observations.reference_distance
        assert reference is not None  # just seen
        rows = rows[np.isfinite(reference[rows])]
        of_errors = budget_of_errors(observations, model, found.distance, uncertainties)
        own = of_errors.rows(rows)
        error = (found.distance - reference)[rows]
    else:
        own, error, of_errors = found.itemized.rows(rows), np.zeros(len(rows)), Itemized(())
    judged = assessed(error, own, maximum_permissible_error, coverage)
    return Certificate(model, observations, found, judged, measured, rows, of_errors)


def certificate_page(
    certificate: Certificate, identification: Mapping[str, str], made_by: str = "", issued: date | None = None
) -> str:
    """A certificate as an HTML document that needs nothing else.

    `identification` tells line by line what is certified: device, files, hashes. `made_by` is the command
    line that makes it again, and `issued` today by default.
    """
    own, shown = certificate, int(np.nanargmax(certificate.budget.expanded_uncertainty))
    errors = replace(own.budget, itemized=own.of_errors)
    least = int(own.rows[int(np.argmax(own.conformity.expanded_uncertainty))])
    notes = list(dict.fromkeys((*own.budget.notes, *own.observations.notes)))
    return rendered(
        "certificate.html.j2",
        "certificate",
        "certificate",
        issued=(issued or date.today()).isoformat(),
        identification=dict(identification),
        conditions=_conditions(own),
        parameters=_parameters(own.model),
        more_parameters=max(len(_fitted(own.model)) - _PARAMETERS, 0),
        heads=_heads(own),
        results=_results(own),
        statement=own.statement,
        decision=own.decision,
        measured=own.measured,
        bound=f"{1e3 * own.conformity.bound:g}",
        guard=f"{1e3 * own.conformity.expanded_uncertainty.max():.2g}",
        coverage=f"{100 * own.budget.coverage:.4g}",
        budget_heads=HEADS,
        budget_lines=lines(own.budget, shown),
        budget_row=conditions_text(own.budget, shown),
        budget_text=result_text(own.budget, shown),
        error_lines=lines(errors, least) if own.observations.reference_join_uncertainty else [],
        error_row=conditions_text(own.budget, least),
        origins=_origins((*own.budget.entries, *own.of_errors.entries)),
        notes=notes,
        made_by=made_by,
    )


def save_certificate(
    certificate: Certificate, path: Path, identification: Mapping[str, str], made_by: str = ""
) -> None:
    """Write a certificate as ``.html`` or ``.pdf``.

    Raises `UsageError` if the ending is another one, or WeasyPrint is not installed.
    """
    refuse_ending(path)
    page = certificate_page(certificate, identification, made_by)
    if path.suffix.lower() == ".html":
        replace_text(path, page)
        return
    from weasyprint import HTML

    with replacing(path) as new:
        HTML(string=page).write_pdf(
            str(new), pdf_version="1.4"
        )  # its maker can be read in it: `echocal.cli._made_by`


def refuse_ending(path: Path) -> None:
    """Refuse a file that no certificate can be.

    Raises `UsageError` if the ending is another one, or WeasyPrint is not installed.
    """
    if path.suffix.lower() not in (".html", ".pdf"):
        raise UsageError(f"{path}: a certificate is .html or .pdf")
    if path.suffix.lower() == ".pdf":
        try:
            import weasyprint  # noqa: F401
        except (ImportError, OSError):  # the library, or the Pango that it draws with
            message = "a PDF needs WeasyPrint: pip install 'echocal[pdf]', or write .html and print it"
            raise UsageError(message) from None


def sha256_of(path: Path) -> str:
    """SHA-256 of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _conditions(own: Certificate) -> dict[str, str]:
    """Range of each recorded condition, and the time of the measurements."""
    found = {}
    for name, values in own.observations.conditions.items():
        facts = QUANTITIES[name]
        known = values[own.rows] * facts.shown.factor
        if facts.derived_from is None and not facts.runs_on and np.isfinite(known).any():
            low, high = float(np.nanmin(known)), float(np.nanmax(known))
            text = f"{low:.4g}" if low == high else f"{low:.4g} to {high:.4g}"
            found[facts.words] = f"{text} {facts.shown.unit}".rstrip()
    time = own.observations.time
    if time is not None and not np.isnat(time[own.rows]).all():
        first, last = (np.datetime_as_string(f(time[own.rows]), unit="m") for f in (np.nanmin, np.nanmax))
        found["measured (UTC)"] = f"{first} to {last}".replace("T", " ")
    assumed = [
        f"{QUANTITIES[n].words} {v:g}"
        for n, v in own.model.air.items()
        if n not in own.observations.conditions
    ]
    if assumed:
        found["assumed"] = ", ".join(assumed)
    return found


def _fitted(model: Model) -> list[str]:
    return [name for name, u in model.standard_uncertainties.items() if u]


def _parameters(model: Model) -> dict[str, str]:
    units = {f"{id_}.{p.name}": p.unit for id_ in model.effects for p in find_effect(id_).parameters}
    sizes, found = model.standard_uncertainties, {}
    for name in _fitted(model)[:_PARAMETERS]:
        id_, _, parameter = name.partition(".")
        factor, unit = {"s": (1e6, "µs"), "m": (1e3, "mm")}.get(units[name], (1.0, units[name]))
        unit = "" if unit == "1" else unit
        found[name] = concise(factor * model.effects[id_][parameter], factor * (sizes[name] or 0.0), unit)
    return found


def _heads(own: Certificate) -> list[str]:
    conditions = conditions_head(own.budget, own.rows.tolist())
    heads = ["row", "rows", conditions, "corrected distance and U [mm]", "k"]
    return [
        *heads,
        *(["largest error and U [mm]"] if own.measured else []),
        "probability",
        "decision",
    ]


def _results(own: Certificate) -> list[list[str]]:
    """A line for each row, or for each group of rows: the row that is nearest to the bound."""
    found = []
    for places in _groups(own):
        judged = own.conformity
        worst = places[int(np.lexsort((judged.probability[places], -judged.decision[places]))[0])]
        row = int(own.rows[worst])
        line = [
            str(row + 1),
            str(len(places)),
            ", ".join(conditions_at(own.budget, row).values()),
            plus_minus(1e3 * own.budget.distance[row], 1e3 * own.budget.expanded_uncertainty[row]),
            f"{own.budget.coverage_factor[row]:.2f}",
        ]
        if own.measured:
            line.append(plus_minus(1e3 * judged.error[worst], 1e3 * judged.expanded_uncertainty[worst]))
        found.append(
            [*line, probability_text(judged.probability[worst]), DECISIONS[int(judged.decision[worst])]]
        )
    return found


def _groups(own: Certificate) -> list[NDArray[np.int64]]:
    """Places of the rows of each line: one row, those of a reference distance, or a range of distances."""
    places = np.arange(len(own.rows))
    if len(places) <= _MOST:
        return [np.array([place]) for place in places]
    distance = own.budget.distance[own.rows]
    if own.observations.reference_distance is not None:
        reference = own.observations.reference_distance[own.rows]
        if len(np.unique(reference)) <= _MOST:
            return [places[reference == one] for one in np.unique(reference)]
    return [part for part in np.array_split(np.argsort(distance, kind="stable"), _MOST // 2) if len(part)]


def _origins(entries: Sequence[Entry]) -> list[str]:
    """Sources of the numbers, once each."""
    own = ("stated", "model", "covariance of the model")
    named = {e.origin: e.words.partition(", ")[0] for e in reversed(entries) if e.origin not in own}
    return [f"{words}: {origin}" for origin, words in reversed(named.items())]
