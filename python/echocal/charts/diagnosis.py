"""Figures of what a diagnosis gains, and of its probabilities."""

from collections.abc import Set

from echocal.charts.parts import Bar, Bars
from echocal.diagnose import Diagnosis
from echocal.diagnose.results.grouped import LEAST, Group, has_any, in_common, reported, shown_groups

__all__ = ["gain_chart", "posterior_chart"]

_GROUPS = 8


def gain_chart(diagnosis: Diagnosis) -> Bars | None:
    """Error on rows that take no part in the fit, as causes are added."""
    gain = diagnosis.gain
    if gain is None:
        return None
    rungs = [
        (f"+ {ids[-1]}" if ids else "base", rms, "after" if ids else "before") for ids, rms in gain.ladder
    ]
    if gain.rms_fixed_speed_m is not None:
        rungs.insert(0, ("one fixed speed", gain.rms_fixed_speed_m, "quiet"))
    if len(gain.ladder) > 1 and gain.judged_rows != "held-out rows":
        rungs.append(("chosen by each fold", gain.rms_after_m, "after"))
    smooth = diagnosis.smooth
    if smooth is not None and smooth.offered and smooth.rms_after_m is not None:
        rungs.append(("+ smooth correction", smooth.rms_after_m, "term"))
    rungs.append(("all columns could reach", gain.rms_floor_m, "quiet"))
    rows = f"{gain.held_out_rows} {gain.judged_rows} ({gain.scheme})"
    after = f" to {1e3 * gain.rms_after_m:.2f}" if len(gain.ladder) > 1 else ""
    notes = [f"RMS error on {rows}: {1e3 * gain.rms_before_m:.2f}{after} mm"]
    if len(gain.ladder) > 1:
        low, high = (1e3 * end for end in gain.interval_95)
        least, most = (100 * end for end in gain.variance_removed_interval_95)
        notes.append(
            f"the model removes {100 * gain.variance_removed:.0f} % of the mean square error ({least:.0f} to "
            f"{most:.0f} %) on rows that neither its choice nor its fit has seen: the RMS error is {low:.2f} "
            f"to {high:.2f} mm smaller (95 % intervals)"
        )
    else:
        notes.append("no effect extends the base")
    if smooth is not None and smooth.offered and smooth.rms_after_m is not None:
        notes.append("the smooth correction has no known cause")
    bars = [Bar(name, 1e3 * rms, f"{1e3 * rms:.2f} mm", tone) for name, rms, tone in rungs]
    label = f"RMS error on {gain.judged_rows} [mm]"
    return Bars("Error", label, bars, max(bar.value for bar in bars), notes)


def posterior_chart(diagnosis: Diagnosis, most: int = _GROUPS) -> Bars:
    """Probability of the sets of causes; sets that the data cannot separate share a bar. It ends at 1."""
    groups = shown_groups(diagnosis, most)
    common, claimed = in_common(groups), reported(diagnosis)
    bars = [
        Bar(
            _label(group, common),
            group.probability,
            f"{group.probability:.3f}",
            "after" if has_any(group, claimed) else "quiet",
            group.shares,
        )
        for group in groups
    ]
    notes = _remarks(groups, common, claimed)
    return Bars("Probabilities", "probability that exactly these causes act", bars, 1.0, notes)


def _label(group: Group, common: Set[str]) -> str:
    """What acts beyond the causes of all sets; the set without more is these causes themselves."""
    more = f"{'+ ' * bool(common)}{group.beyond(common)}"
    return more if set(group.classes) - common else " + ".join(group.classes) or "no effect"


def _remarks(groups: list[Group], common: Set[str], claimed: Set[str]) -> list[str]:
    remarks = []
    if common:
        remarks.append(f"in every set: {', '.join(sorted(common))}")
    if len({has_any(group, claimed) for group in groups}) > 1:
        remarks.append("in color: sets with a cause that the verdict reports")
    if any(len(group.shares) > 1 and group.shares[1] >= LEAST for group in groups):
        remarks.append("the parts of a bar are sets that these data cannot separate")
    for name, members in {name: m for group in groups for name, m in group.members.items()}.items():
        remarks.append(f"{name}: {', '.join(members[1:])}")
    return remarks
