"""Targets that differ: each level of a column has an offset of its own.

A sensor hears the nearest point of a target, and a ruler points at some other one. To a pole of the radius r
whose axis is the reference, the reading is d - r at every distance. To a low object that is h beside the axis
of the beam it is sqrt(d^2 + h^2), that is h^2 / (2 d) too long. So the errors of a target have an offset in
common, and another target has another one. The same holds for a mount that is put up again, and for several
sensors. What depends on the distance beside that (h) is not fitted for each target.

Nobody has to say which column tells the targets apart: `stand`, `group`, and every further column of few
levels, numbers or text, are tried. The offsets are random, with one standard deviation between levels
(docs/method.md, Eq. 5, with levels in place of stations). So a column costs one size, and many levels explain
nothing that their standard deviation does not pay for.

An offset belongs to a target and not to the sensor, so no model has it: it would be wrong for a target that
is not in the table. The offsets are told, the model is that of all targets, and the standard deviation is the
standard uncertainty of the offset of a new target. The folds hold out whole levels where there are enough, so
the gain is that on targets which were not seen.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from echocal.diagnose.findings.facts import CauseFacts, Columns, Quantity
from echocal.diagnose.findings.finding import Finding
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.inference.case import Case
from echocal.diagnose.inference.examine import examine
from echocal.diagnose.inference.posterior import Inference, infer
from echocal.diagnose.noises.common.kinds import OffsetNoise, Offsets
from echocal.diagnose.noises.common.without import log_evidence
from echocal.diagnose.preprocess.folds import Folds
from echocal.diagnose.preprocess.table import Table
from echocal.diagnose.settings.threshold import threshold

__all__ = ["NOISE"]

Column = NDArray[np.float64]
Labels = NDArray[np.int64]

_LOOK = 1000  # rows that show whether a column has few levels
_SHOWN = 6  # levels that a sentence lists


_TRIED = 2  # columns whose evidence is computed, likeliest first


@dataclass(frozen=True)
class Thresholds:
    """Numbers that decide about this noise."""

    most: int = threshold(50, "1", "levels of a column, at most: more are no kinds of targets; judgement")
    screened: float = threshold(
        2.0, "1", "log likelihood ratio of white residuals from which on a column is tried; argument"
    )


FACTS = CauseFacts(
    id="target_geometry",
    kind="noise",
    sentence="Targets differ: each has an offset of its own, its radius or where its nearest point is.",
    signature="errors differ by the levels of a column that tells targets or mounts apart",
    source="argument: the first echo is that of the nearest point; a pole of the radius r is heard at d - r",
    parameters=(
        Quantity(
            "standard_deviation",
            "m",
            "between the offsets of the levels",
            (0.0, None),
            "half on 0; else variance 0.1 to 10,000 times the noise's",
        ),
        Quantity("levels", "1", "levels of the column", (2.0, None), "counted"),
    ),
    check="put one target in the place of another; use a large flat plate; measure to the nearest point",
    prior=0.02,
    formula="e_i = b_j + white noise in every row i of level j, b_j normal with standard_deviation",
    needs=("reference_distance",),
)


def find(case: Case, inference: Inference) -> Offsets | None:
    """Compare errors of stations with those of the levels of each column: docs/method/noises.md, Eq. 18b."""
    own, prior = case.settings.noises.of(FACTS, Thresholds), case.settings.noises.prior(FACTS)
    if case.table.reference is None:
        return None
    columns = dict(_columns(case, own))
    scores = {name: _screened(case, inference, levels) for name, levels in columns.items()}
    likely = sorted((n for n, score in scores.items() if score > own.screened), key=lambda n: -scores[n])
    best: tuple[float, str, Case, Inference] | None = None
    for name in likely[:_TRIED]:
        other = _grouped(case, name, columns[name])
        beside = infer(other)
        log = _log_with_errors(other, beside) - _log_rival(case, inference, columns[name])
        if best is None or log > best[0]:
            best = log, name, other, beside
    if best is None:
        return None
    log, name, other, beside = best
    evidence = log - float(np.log(len(columns)))
    finding = _finding(evidence, name, columns[name], other, beside)
    return Offsets(replace(finding, facts=replace(FACTS, prior=prior)), other, beside)


def _columns(case: Case, own: Thresholds) -> Iterator[tuple[str, Labels]]:
    """Columns that divide the rows into few levels, each division once."""
    table, seen = case.table, set()
    fewest = case.settings.rows.rows_per_station
    others = {name: column for name, column in table.extra.items() if name not in table.thermometers}
    for name, column in {**table.labels, **others}.items():
        if len(np.unique(column[:_LOOK])) > own.most or not np.isfinite(column).all():
            continue
        values, first, levels = np.unique(column, return_index=True, return_inverse=True)
        count = len(values)
        if not 2 <= count <= min(own.most, len(table) // fewest) or (
            column.dtype.kind == "i" and values[0] < 0
        ):
            continue
        rank = np.empty(count, dtype=np.int64)
        rank[np.argsort(first)] = np.arange(count)
        levels = rank[levels.reshape(-1)]
        if levels.tobytes() not in seen and not _is_the_distance(table, levels):
            seen.add(levels.tobytes())
            yield name, levels


def _is_the_distance(table: Table, levels: Labels) -> bool:
    """Whether each level has one distance of its own: then an error of the reference is the same."""
    return _pairs(levels, table.reference) == int(levels.max()) + 1


def _pairs(levels: Labels, other: Column | Labels | None) -> int:
    """Different pairs of a level and a value of another column."""
    return int(np.unique(np.stack([levels, np.asarray(other)]), axis=1).shape[1])


def _screened(case: Case, inference: Inference, levels: Labels) -> float:
    """Log likelihood ratio of errors of levels in what the best hypothesis leaves, or the base."""
    best = inference.fits[0]
    noise = inference.reduced.likeliest(best)[0]
    runs = 1 + np.count_nonzero(np.diff(levels))
    memory = (1 + noise.rho) / (1 - noise.rho)
    rows = np.bincount(levels) / (memory if len(levels) > memory * runs else 1.0)
    ratios = np.array(case.settings.noise_models.level_ratios)[:, None]
    scores = []
    for left in (case.left(best, np.arange(len(levels))), case.residual):
        mean = np.bincount(levels, left) / np.bincount(levels)
        variance = float(np.mean((left - mean[levels]) ** 2)) + 1e-18
        off = mean - np.average(mean, weights=rows)
        taken = ratios * (rows * off) ** 2 / ((1 + ratios * rows) * variance)
        scores.append(0.5 * (taken - np.log1p(ratios * rows)).sum(axis=1).max())
    return float(max(scores))


def _grouped(case: Case, name: str, levels: Labels) -> Case:
    """The same table, whose rows share an error with those of their level; folds hold out whole levels."""
    table = replace(case.table, groups=levels, grouped_by=name)
    folds = Folds.of(table, case.settings.rows)
    return examine(table, case.base, folds, case.seed, case.settings, case.offsets)


def _log_with_errors(case: Case, inference: Inference) -> float:
    """Log evidence of all hypotheses under the noises with an error of each level."""
    some = np.array([noise.station_ratio > 0 for noise in inference.reduced.noises])
    return log_evidence(inference, some) - float(np.log1p(-case.settings.noise_models.usual))


def _log_rival(case: Case, inference: Inference, levels: Labels) -> float:
    """Log evidence without such errors, those of stations included, unless the levels are the stations."""
    noises, stations = inference.reduced.noises, case.table.groups
    if _pairs(levels, stations) == len(np.unique(stations)) == int(levels.max()) + 1:
        none = np.array([noise.station_ratio == 0 for noise in noises])
        return log_evidence(inference, none) - float(np.log(case.settings.noise_models.usual))
    return log_evidence(inference, np.ones(len(noises), dtype=bool))


def _finding(evidence: float, name: str, levels: Labels, case: Case, inference: Inference) -> Finding:
    left = case.left(inference.fits[0], np.arange(len(levels)))
    count = np.bincount(levels)
    mean = np.bincount(levels, left) / count
    variance = np.bincount(levels, (left - mean[levels]) ** 2) / np.maximum(count - 1, 1)
    expected = float(np.mean(variance / count))
    total = float(np.var(mean, ddof=1))
    deviation = float(np.sqrt(max(total - expected, 0.0)))
    first = np.unique(levels, return_index=True)[1]
    numbers = case.table.extra.get(name)
    rows = (f"like row {int(row) + 1}" for row in case.table.row[first])
    names = list(rows) if numbers is None else [f"at {number:g}" for number in numbers[first]]
    shown = ", ".join(
        f"{1e3 * mean[k]:+.1f} mm {names[k]} ({count[k]} rows)" for k in np.argsort(-np.abs(mean))[:_SHOWN]
    )
    more = ", ..." if len(mean) > _SHOWN else ""
    because = (
        f"errors differ by '{name}': {shown}{more}. The means of its {len(mean)} levels scatter by "
        f"{1e3 * np.sqrt(total):.2f} mm, where their rows explain {1e3 * np.sqrt(expected):.2f} mm. No model "
        f"has these offsets; that of a new target is uncertain by {1e3 * deviation:.2f} mm"
    )
    parameters = (
        Parameter("standard_deviation", deviation, float(deviation / np.sqrt(2 * (len(mean) - 1))), "m"),
        Parameter("levels", float(len(mean)), 0.0, "1"),
    )
    return Finding(FACTS, evidence, because, parameters, rivals=_rivals(name, levels, case.table))


def _rivals(name: str, levels: Labels, table: Table) -> tuple[str, ...]:
    """What looks the same: a step in time where no level returns, an error of the tape at a placement."""
    returns = np.count_nonzero(np.diff(levels)) > int(levels.max())
    steps = () if returns or "elapsed_time" not in table.conditions else ("step_change",)
    return (*steps, *(("reference_error",) if name == "stand" else ()))


def draw(table: Columns, random: np.random.Generator) -> None:
    """Look at five targets in turn, each with an offset of its own of about a centimeter."""
    target = random.integers(0, 5, len(table["reading_m"])).astype(np.int64)
    table["target"] = target.astype(np.float64)
    table["reading_m"] += random.normal(0.0, 1e-2, 5)[target]


NOISE = OffsetNoise(facts=FACTS, draw=draw, find=find, thresholds=Thresholds())
