"""The smooth correction, and what is left without a cause, in sentences."""

from echocal.diagnose.findings.parts import HELD_OUT, Remainder, SmoothCorrection
from echocal.diagnose.findings.sentences import enumerated, quantity_text, spoken
from echocal.model import Shape

__all__ = ["refusal", "remainder_text", "smooth_text"]

HOUR_ANGLE = "hour_angle"


def smooth_text(found: SmoothCorrection) -> str:
    """What a smooth correction is a function of, and what it gains."""
    if found.smooth is None:
        return (
            "no smooth correction is offered: no smooth function of "
            f"{enumerated([_words(name) for name in found.tried])} predicts rows that it is not fitted to"
        )
    ranges = "; ".join(_range(term) for term in found.smooth.terms)
    what = f"a sum of smooth functions without a known cause ({ranges})"
    if not found.offered:
        why = found.refused
        return f"no smooth correction is offered: {what} was tried. {_gain(found)}. {why[0].upper()}{why[1:]}"
    rows = f" ({found.rows_outside} rows of this table)" if found.rows_outside else ""
    return (
        f"a smooth correction can be added to the model on request: {what}. {_gain(found)}. Outside of these "
        f"ranges{rows} it adds nothing"
    )


def refusal(found: SmoothCorrection | None) -> str:
    """Why there is no smooth correction to add to a model."""
    if found is None:
        return (
            "the diagnosis offers no smooth correction: the recorded columns leave nothing to reach, or none "
            "of them varies enough"
        )
    return f"the diagnosis offers no smooth correction; {smooth_text(found).partition(': ')[2]}"


def remainder_text(left: Remainder) -> str:
    """What is known of an effect that neither a cause nor an unexplained term describes."""
    if left.turns:
        return left.turns
    chance = "below 1e-12" if left.p_value < 1e-12 else f"{left.p_value:.1g}"
    known = (
        f"the RMS error of the model is {1e3 * left.rms_m:.2f} mm, and all recorded columns together could "
        f"reach {1e3 * left.rms_floor_m:.2f} mm. The probability that noise alone, as autocorrelated as it "
        f"is here, lets them remove as much is {chance}; the probability that there is no effect is "
        f"{left.no_effect:.2g}"
    )
    if left.by_chance:
        return f"{known}. So this is no evidence of an effect"
    tried = enumerated([_words(name) for name in left.against]) if left.against else "no column"
    return (
        f"{known}. No cause and no smooth function of one column is probable enough to be reported. Tried: "
        f"{tried}"
    )


def _gain(found: SmoothCorrection) -> str:
    if found.interval_95 is None or found.variance_removed_interval_95 is None or not found.held_out_rows:
        return "No row can judge it"
    rows = "held-out rows" if found.scheme.startswith(HELD_OUT) else "cross-validated rows"
    low, high = (1e3 * end for end in found.interval_95)
    least, most = (100 * end for end in found.variance_removed_interval_95)
    without, with_it = (1e3 * (rms or 0.0) for rms in (found.rms_before_m, found.rms_after_m))
    return (
        f"On {found.held_out_rows} {rows}, which neither its choice nor its fit has seen, the RMS error is "
        f"{without:.2f} mm without it and {with_it:.2f} mm with it: it removes "
        f"{100 * (found.variance_removed or 0.0):.0f} % of the mean square error ({least:.0f} to {most:.0f} "
        f"%) and gains {low:.2f} to {high:.2f} mm (95 % intervals)"
    )


def _words(name: str) -> str:
    return "hour of day" if name == HOUR_ANGLE else spoken(name)


def _range(term: Shape) -> str:
    if term.against == HOUR_ANGLE:
        return "hour of day"
    low, high = term.at[0], term.at[-1]
    return f"{spoken(term.against)} {quantity_text(term.against, low)} to {quantity_text(term.against, high)}"
