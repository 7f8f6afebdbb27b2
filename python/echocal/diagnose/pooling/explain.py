"""A pooled diagnosis in sentences."""

from collections.abc import Sequence

from echocal.concise import decimal
from echocal.diagnose.catalogue import find_cause
from echocal.diagnose.findings.parts import Parameter
from echocal.diagnose.findings.sentences import enumerated, parameter_text, readable, size_text
from echocal.diagnose.pooling.outcome import PooledOutcome
from echocal.diagnose.pooling.parts import InTable, PooledCause, PooledParameter
from echocal.diagnose.results.explain import probability_text

__all__ = [
    "explain",
    "in_table_text",
    "lead",
    "recurrence",
    "sentence",
    "short_sizes",
    "sizes_text",
    "transfer_text",
]


def explain(pooled: PooledOutcome) -> str:
    """Sentences, a line for each fact."""
    lines = [f"{lead(pooled)}."]
    for cause in pooled.causes:
        lines.append(f"{cause.id}, {sizes_text(cause)} ({probability_text(cause)}): {sentence(cause)}")
        lines.append(f"  {cause.because}.")
        lines += [f"  {one.table}: {in_table_text(one)}." for one in cause.tables]
        if cause.doubt:
            lines.append(f"  Doubt: {cause.doubt}.")
        if cause.indistinguishable_from:
            lines.append(f"  No table separates it from {', '.join(cause.indistinguishable_from)}.")
    lines.append(f"{transfer_text(pooled)}.")
    lines += [f"Note: {note}." for note in pooled.notes]
    lines += [f"{one.name} is left out: {one.reason}." for one in pooled.skipped]
    return "\n".join(lines)


def lead(pooled: PooledOutcome) -> str:
    """The verdict in a sentence, without the period."""
    count = f"{len(pooled.tables)} tables"
    if pooled.verdict == "nothing":
        return f"No cause that the {count} share is detected"
    if pooled.verdict == "unknown":
        return f"Several of the {count} show an effect outside the catalogue"
    if pooled.verdict == "ambiguous":
        return f"The {count} share an effect, but no name is certain enough"
    least = pooled.settings.claims.named
    named = [cause.id for cause in pooled.causes if cause.probability >= least and not cause.doubt]
    return f"The {count} name the shared cause{'s' * (len(named) > 1)} {enumerated(named)}"


def sentence(cause: PooledCause) -> str:
    """What the cause is."""
    return find_cause(cause.id).sentence


def sizes_text(cause: PooledCause) -> str:
    """Mean sizes, and how much they vary between tables."""
    if cause.shares == "name":
        return "sizes of each table"
    texts = []
    for p in cause.parameters:
        text = parameter_text(p.name, p.value, p.standard_uncertainty, p.unit)
        if p.standard_uncertainty > 0.0:
            text += f" (standard deviation between tables {_spread(p)})"
        texts.append(text)
    return ", ".join(texts)


def short_sizes(parameters: tuple[Parameter, ...]) -> str:
    """Sizes that are not fixed, without their names: ``80(4) us``."""
    free = (p for p in parameters if p.standard_uncertainty > 0.0)
    return ", ".join(size_text(p.value, p.standard_uncertainty, p.unit) for p in free)


def _spread(size: PooledParameter) -> str:
    factor, unit = readable(max(abs(size.value), size.between_tables), size.unit)
    return f"{decimal(size.between_tables * factor, 2)} {unit}".rstrip()


def recurrence(tables: Sequence[InTable]) -> str:
    """In how many tables a cause is, and which of them say otherwise."""
    counts = {role: [one.table for one in tables if one.role == role] for role in _ROLES}
    parts = [f"{len(names)} {_ROLES[role]}" for role, names in counts.items() if names]
    return f"Of {len(tables)} tables, {enumerated(parts)}"


_ROLES = {
    "supports": "support it",
    "contradicts": "contradict it",
    "undecided": "leave it open",
    "not tested": "cannot test it",
}


def in_table_text(one: InTable) -> str:
    """What one table says."""
    if one.role == "not tested":
        return f"{one.role}: {one.why}"

    def text(parameters: tuple[Parameter, ...]) -> str:
        return ", ".join(
            parameter_text(p.name, p.value, p.standard_uncertainty, p.unit)
            for p in parameters
            if p.standard_uncertainty > 0.0
        )

    sized = f"; alone {text(one.parameters)}; in the pool {text(one.drawn)}" if text(one.parameters) else ""
    return f"log Bayes factor {one.log_bayes:+.1f}{sized}"


def transfer_text(pooled: PooledOutcome) -> str:
    """What the shared causes gain on tables left out."""
    gain = pooled.gain
    rows = f"On {gain.held_out_rows} rows of tables left out in turn, the RMS error is"
    before = f"{rows} {1e3 * gain.rms_before_m:.2f} mm with the base"
    if len(gain.ladder) == 1:
        return before
    low, high = (1e3 * end for end in gain.interval_95)
    least, most = (100 * end for end in gain.variance_removed_interval_95)
    return (
        f"{before} and {1e3 * gain.rms_after_m:.2f} mm with the causes and sizes of the other tables: gain "
        f"{low:.2f} to {high:.2f} mm, {100 * gain.variance_removed:.0f} % of the mean square error "
        f"({least:.0f} to {most:.0f} %) (95 % intervals)"
    )
