"""Why claims that no row refutes are not in the model."""

from echocal.diagnose.findings.parts import Gain

__all__ = ["unearned"]


def unearned(gain: Gain) -> str:
    """Why no cause is in the model: its gain may be chance."""
    low, high = (1e3 * end for end in gain.interval_95)
    if low == high == 0.0:
        return (
            f"without the rows that judge it, no cause is chosen, so {gain.judged_rows} show no gain over "
            "the base. The model leaves it out, and it is not named"
        )
    rows = f"on {gain.judged_rows}, which its choice has not seen, a model with it"
    if gain.rms_after_m >= gain.rms_before_m:
        return (
            f"{rows} has an error of {1e3 * gain.rms_after_m:.2f} mm, the base {1e3 * gain.rms_before_m:.2f} "
            "mm. Under the noise these rows are more probable with it, so it is not refuted. But the error "
            "is not smaller, so the model leaves it out, and it is not named"
        )
    first, last = gain.log_score_interval_95 or (gain.log_score or 0.0,) * 2
    return (
        f"{rows} gains {low:.2f} to {high:.2f} mm over the base, and the log density of these rows under "
        f"the noise changes by {first:.1f} to {last:.1f} (95 % intervals). Not both intervals are above 0, "
        "so the model leaves it out, and it is not named"
    )
