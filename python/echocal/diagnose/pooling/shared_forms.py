"""Which forms of a cause are the same in every table, and in which unit their sizes are compared."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from echocal.diagnose.candidates.variant import UNKNOWN, Variant
from echocal.registry import find_effect

__all__ = ["BY_NAME", "FormKey", "SharedForm", "by_name", "shared_forms"]

FormKey = tuple[object, ...]

BY_NAME: FormKey = ("by name",)
"""Form of a cause whose sizes or places have no meaning in another table: only its name is shared."""


@dataclass(frozen=True)
class SharedForm:
    """A form of a cause, the same in every table.

    Attributes
    ----------
    weight : float
        Probability among the forms of the cause.
    names : tuple of str
        Parameters whose sizes are shared.
    scales : tuple of float
        Prior standard deviation of each.
    bounds : tuple of (float, float)
        In prior standard deviations.
    """

    cause: str
    key: FormKey
    weight: float
    names: tuple[str, ...]
    scales: tuple[float, ...]
    bounds: tuple[tuple[float, float], ...]

    @property
    def is_by_name(self) -> bool:
        """Whether only the name is shared."""
        return self.key == BY_NAME

    def variant(self, first: int, own: Variant | None = None) -> Variant:
        """The form as a variant, whose sizes are from a position on; with the parameters of a table's own."""
        own = Variant(self.cause, offset=None if self.names else 0) if own is None else own
        free = tuple(range(first, first + len(self.names)))
        return replace(
            own, free=free, names=self.names, scales=self.scales, bounds=self.bounds, weight=self.weight
        )


def by_name(cause: str) -> bool:
    """Whether a cause belongs to its table: it begins at a place or a time, or grows in one campaign."""
    effect = find_effect(cause)
    return not effect.recurs or (effect.edges and bool(_along(cause)))


def _along(cause: str) -> frozenset[str]:
    """Parameters of a cause that are tried at quantiles of a column of the table."""
    return frozenset(p.name for p in find_effect(cause).parameters if p.tried_along is not None)


def keys(variants: Sequence[Variant]) -> dict[int, FormKey]:
    """Key of each form of a table, by the identity of the form; unexplained terms have none."""
    found: dict[int, FormKey] = {}
    widths: dict[FormKey, list[float]] = {}
    named = [v for v in variants if v.cause != UNKNOWN]
    bases = {id(variant): _base(variant, named) for variant in named}
    for variant in named:
        widths.setdefault(bases[id(variant)], []).append(sum(variant.scales))
    for variant in named:
        base = bases[id(variant)]
        rank = sorted(widths[base]).index(sum(variant.scales))
        found[id(variant)] = BY_NAME if by_name(variant.cause) else (*base, rank)
    return found


def _base(variant: Variant, beside: Sequence[Variant]) -> FormKey:
    """What a form is, but for its prior; a quantile of a column is the same in tables that try as many."""
    along, same = _along(variant.cause), [other for other in beside if other.cause == variant.cause]
    at: list[tuple[str, object]] = []
    for name, value in sorted(variant.at.items()):
        tried = sorted({other.at[name] for other in same if name in other.at})
        at.append((name, (tried.index(value), len(tried)) if name in along else value))
    return (variant.cause, tuple(at), variant.names, variant.offset is not None)


def shared_forms(tables: Sequence[Sequence[Variant]]) -> dict[str, list[SharedForm]]:
    """Forms of each cause that competes in some table.

    The scale of a size is the median of the scales that the tables use: they differ where the prior is meant
    for a range of a quantity.
    """
    seen: dict[tuple[str, FormKey], list[Variant]] = {}
    for variants in tables:
        own = keys(variants)
        for variant in variants:
            if id(variant) in own:
                seen.setdefault((variant.cause, own[id(variant)]), []).append(variant)
    forms: dict[str, list[SharedForm]] = {}
    for (cause, key), same in seen.items():
        forms.setdefault(cause, []).append(_form(cause, key, same))
    return forms


def _form(cause: str, key: FormKey, same: Sequence[Variant]) -> SharedForm:
    if key == BY_NAME:
        return SharedForm(cause, key, 1.0, (), (), ())
    first = same[0]
    scales = tuple(float(np.median([v.scales[i] for v in same])) for i in range(len(first.names)))
    bounds = tuple(
        (low * own / scale, high * own / scale)
        for (low, high), own, scale in zip(first.bounds, first.scales, scales, strict=False)
    )
    return SharedForm(cause, key, first.weight, first.names, scales, bounds)
