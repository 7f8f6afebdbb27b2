"""An uncertainty budget on the terminal."""

from collections.abc import Iterable

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from echocal.budget import Budget
from echocal.budget.coverage import plus_minus
from echocal.budget.entries import Entry
from echocal.budget.sources import LAW
from echocal.quantities import QUANTITIES

HEADS = ("source", "type", "u(x)", "sensitivity", "u(d) [mm]", "ν", "share")
"""Source, type and distribution, standard uncertainty of the input, sensitivity coefficient, contribution,
degrees of freedom, part of the variance."""
_MOST = 12  # rows that are listed
_CORRELATED = 3  # parameters whose correlations are told
_MANY = 1000  # degrees of freedom: k differs from that of infinitely many by 0.1 %
_SCALES = {"s": (1e6, "µs"), "m": (1e3, "mm"), "degC": (1.0, "K")}
_LAW = (1e6, "ppm")


def print_budget(budget: Budget, row: int, console: Console) -> None:
    """Print the budget of a row, and the results of the others."""
    title = f"budget of row {budget.row[row]}: {conditions_text(budget, row)}"
    table = Table(title=title, box=SIMPLE_HEAD, padding=(0, 1, 0, 0), title_justify="left")
    for head in HEADS:
        table.add_column(head, overflow="fold")
    for line in lines(budget, row):
        table.add_row(*line)
    console.print(table)
    for text in result_text(budget, row):
        console.print(text, markup=False, highlight=False)
    if len(budget.distance) > 1:
        console.print(_others(budget))
    for note in budget.notes:
        console.print(Text.assemble(("note  ", "dim"), note))


def lines(budget: Budget, row: int) -> list[tuple[str, ...]]:
    """Lines of the budget of a row, as texts under `HEADS`."""
    shares = budget.itemized.shares[row]
    return [
        (
            entry.words,
            f"{entry.evaluation} {entry.distribution}",
            _sized(entry.standard_uncertainty[row], *_scale(entry)),
            _slope(entry, row),
            f"{1e3 * abs(entry.contribution[row]):.3g}",
            "∞" if np.isinf(entry.degrees_of_freedom) else f"{entry.degrees_of_freedom:.0f}",
            f"{100 * share + 0.0:.1f} %".replace("-0.0", "0.0"),
        )
        for entry, share in zip(budget.entries, shares, strict=True)
    ]


def _scale(entry: Entry) -> tuple[float, str]:
    """Factor and unit in which people read an input quantity."""
    if entry.quantity == LAW:
        return _LAW
    if entry.quantity in QUANTITIES and entry.unit not in _SCALES:
        shown = QUANTITIES[entry.quantity].shown
        return shown.factor, shown.unit
    return _SCALES.get(entry.unit, (1.0, "" if entry.unit == "1" else entry.unit))


def _sized(value: float, factor: float, unit: str) -> str:
    return f"{value * factor:.3g} {unit}".rstrip()


def _slope(entry: Entry, row: int) -> str:
    factor, unit = _scale(entry)
    if unit == "mm":
        return f"{entry.sensitivity[row]:.3g}"
    below = f"({unit})" if "/" in unit or " " in unit else unit
    return f"{1e3 * entry.sensitivity[row] / factor + 0.0:.3g} mm{f'/{below}' if unit else ''}"


def probability_text(probability: float) -> str:
    """A probability in percent, also near 0 and 1.

    Examples
    --------
    >>> probability_text(0.9543), probability_text(1e-9), probability_text(0.99999)
    ('95.4 %', 'below 0.1 %', 'above 99.9 %')
    """
    if not 0.001 <= probability <= 0.999:
        return "below 0.1 %" if probability < 0.5 else "above 99.9 %"
    return f"{100 * probability:.1f} %"


def conditions_text(budget: Budget, row: int) -> str:
    """Distance and conditions of a row."""
    shown = [f"{QUANTITIES[name].words} {text}" for name, text in conditions_at(budget, row).items()]
    return ", ".join([f"{budget.distance[row]:.4g} m", *shown])


def conditions_at(budget: Budget, row: int) -> dict[str, str]:
    """Recorded conditions of a row by name, as people read them."""
    found = {}
    for name, values in budget.conditions.items():
        facts = QUANTITIES[name]
        if facts.derived_from is None and not facts.runs_on and np.isfinite(values[row]):
            found[name] = f"{values[row] * facts.shown.factor:.4g} {facts.shown.unit}".rstrip()
    return found


def result_text(budget: Budget, row: int) -> list[str]:
    """The result of a row in sentences."""
    u, k = budget.standard_uncertainty[row], budget.coverage_factor[row]
    degrees = budget.degrees_of_freedom[row]
    effective = f"{degrees:.0f}" if degrees < _MANY else f"more than {_MANY}"
    distance, expanded = 1e3 * budget.distance[row], 1e3 * budget.expanded_uncertainty[row]
    found = [
        f"combined standard uncertainty {1e3 * u:.3g} mm; {effective} effective degrees of freedom; "
        f"k = {k:.2f} for a coverage probability of {100 * budget.coverage:.4g} %",
        f"result: {plus_minus(distance, expanded, 'mm')}",
    ]
    if budget.itemized.correlation is not None and 1 < len(budget.itemized.correlation) <= _CORRELATED:
        r, names = budget.itemized.correlation, [entry.quantity for entry in budget.entries]
        pairs = [f"{names[i]}, {names[j]}: {r[i, j]:.3f}" for j in range(len(r)) for i in range(j)]
        found.append(f"correlation of {'; '.join(pairs)}")
    place = np.flatnonzero(budget.monte_carlo_rows == row)
    if budget.monte_carlo is not None and len(place):
        drawn, at = budget.monte_carlo, int(place[0])
        spread = drawn.standard_uncertainty[at]
        apart = f" ({100 * (spread / u - 1):+.1f} %)" if u > 0.0 else ""
        found.append(
            f"Monte Carlo ({drawn.trials} draws): standard uncertainty {1e3 * spread:.3g} mm"
            f"{apart}, {100 * budget.coverage:.4g} % interval "
            f"{1e3 * drawn.low[at]:.2f} to {1e3 * drawn.high[at]:.2f} mm"
        )
    return found


def conditions_head(budget: Budget, rows: Iterable[int]) -> str:
    """Names of the conditions that `conditions_at` has of some rows."""
    names = {name for row in rows for name in conditions_at(budget, row)}
    ordered = [facts.words for name, facts in QUANTITIES.items() if name in names]
    return ", ".join(ordered) or "conditions"


def _others(budget: Budget) -> Table:
    shown = np.unique(np.linspace(0, len(budget.distance) - 1, _MOST).astype(int)).tolist()
    more = f" ({len(shown)} of {len(budget.distance)} rows)" if len(shown) < len(budget.distance) else ""
    heads = ("row", conditions_head(budget, shown), "result [mm]", "k", "largest source")
    plain = {"box": SIMPLE_HEAD, "padding": (0, 1, 0, 0), "title_justify": "left"}
    table = Table(*heads, title=f"results{more}", **plain)  # type: ignore[arg-type]
    shares = budget.itemized.shares
    for row in shown:
        if not np.isfinite(budget.distance[row]):
            table.add_row(str(budget.row[row]), "", "no distance", "", "")
            continue
        largest = budget.entries[int(np.argmax(shares[row]))].words if shares[row].any() else "none"
        result = plus_minus(1e3 * budget.distance[row], 1e3 * budget.expanded_uncertainty[row])
        where = ", ".join(conditions_at(budget, row).values())
        table.add_row(str(budget.row[row]), where, result, f"{budget.coverage_factor[row]:.2f}", largest)
    return table
