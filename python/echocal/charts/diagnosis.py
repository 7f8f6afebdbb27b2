"""Figures of what a diagnosis gains, and of its probabilities."""

from echocal.charts.parts import Bar, Bars
from echocal.diagnose import Diagnosis
from echocal.diagnose.results.grouped import has_any, in_common, reported, shown_groups

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
    caption = f"{gain.held_out_rows} {gain.judged_rows} ({gain.scheme})."
    if len(gain.ladder) > 1:
        low, high = (1e3 * end for end in gain.interval_95)
        caption += (
            f" On rows that neither the choice nor the fit has seen: {1e3 * gain.rms_after_m:.2f} mm. The "
            f"gain is {low:.2f} to {high:.2f} mm (95 % interval)."
        )
    bars = [Bar(name, 1e3 * rms, f"{1e3 * rms:.2f} mm", tone) for name, rms, tone in rungs]
    return Bars("Error", "RMS error [mm]", bars, max(bar.value for bar in bars), caption)


def posterior_chart(diagnosis: Diagnosis) -> Bars | None:
    """Probability of each group of sets of causes; None for a single one. The axis ends at 1."""
    groups = shown_groups(diagnosis, _GROUPS)
    if len(groups) == 1:
        return None
    common, claimed = in_common(groups), reported(diagnosis)
    bars = [
        Bar(
            group.beyond(common),
            group.probability,
            f"{group.probability:.3f}",
            "after" if has_any(group, claimed) else "quiet",
        )
        for group in groups
    ]
    caption = "Colored: sets with a cause that the verdict reports."
    return Bars("Probabilities", "probability that exactly these causes act", bars, 1.0, caption)
