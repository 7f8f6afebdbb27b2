"""The decision rule: which causes are claimed, and which are named."""

from dataclasses import dataclass

from echocal.diagnose.settings.threshold import threshold

__all__ = ["ClaimSettings"]


@dataclass(frozen=True, kw_only=True)
class ClaimSettings:
    """Numbers of the decision rule."""

    claim_below: float = threshold(
        0.6,
        "P(no effect)",
        "below it an effect is claimed, even if each single effect is improbable; tested only if the best "
        "set of effects is empty; chosen by hand on development tables; no script repeats it. "
        "docs/diagnosis-benchmark.md has the false alarms; the target is 0.02. Of few rows, the prior "
        "of no cause (`priors.no_cause`) takes its place, then also under each single autoregression of the "
        "noise: the data must support an effect. 539 nulls of design a were run, see docs/method/evidence.md",
    )
    few_rows: int = threshold(
        100, "rows", "fewer rows are too few to detect autocorrelated noise; chosen by hand"
    )
    claim_below_amid_noise: float = threshold(
        0.25,
        "P(no effect)",
        "the same, if the noise is autocorrelated, the air is slow or the stations have errors; measured on "
        "750 fresh nulls when claim_below was 0.44: half the false alarms at the same power; not repeated "
        "since",
    )
    named: float = threshold(
        0.9, "probability", "from it on, a class of causes is named; promise of the interface"
    )
    credible: float = threshold(0.95, "probability", "of the credible set; convention")
    separable: float = threshold(
        3.0,
        "expected log odds",
        "below it two causes are in one class; argument: odds of 20, as for `strong`. On 110 tables of "
        "the virtual bench, 1.0 names 3 single causes and a pair less, 3 confident wrong names more",
    )
    plausible_size: float = threshold(
        9.0,
        "prior sd",
        "a cause that needs a larger size to imitate another one is separable from it; three standard "
        "deviations of the widest prior",
    )
    nearly: float = threshold(
        1 / 3,
        "of the largest probability",
        "of the sets of causes above it, the one that most devices can compensate is taken; chosen by hand: "
        "such odds decide nothing in practice",
    )
    mentioned_from: float = threshold(
        0.05,
        "probability",
        "from it on, another possible cause is listed, and sets of effects beside larger ones are tried; "
        "chosen by hand",
    )
    strong: float = threshold(
        3.0,
        "log odds",
        "a cause beside others is named if the rows that judge the model are more probable with it by this; "
        "an autoregression under which few rows are less probable by more does not count; argument: odds of "
        "20, which count as strong evidence (doi:10.1080/01621459.1995.10476572). In 28 logs of "
        "examples/make_snow.py with held-out rows, it withholds 2 of 3 false names and no true one",
    )
    beyond_shared: float = threshold(
        2.0,
        "standard deviations",
        "a cause that is less visible beyond what all rows share is not named; GUM 6.3.3: a coverage factor "
        "of 2; on 176 tables of the virtual bench with an ideal detector, 3 of 17 names below it are those "
        "of a planted cause, 44 of 54 above",
    )
    minor: float = threshold(
        3e-4,
        "m",
        "an effect that adds less to every reading is told in one line, unless the user states another "
        "difference or the readings have coarser steps; a tenth of the 3 mm that the datasheet of an HC-SR04 "
        "states as its accuracy, the smallest such figure of the sensors of docs/real-records.md",
    )
    implausible: float = threshold(
        5.0,
        "prior standard deviations",
        "a cause with a larger size is not named; the model keeps it; argument: 1 in 31 sizes is larger by "
        "Eq. 6; the prior of an effect outside the catalogue is 1 in 20. Without it, 3 of 12 tanks whose "
        "thermometer is in the box get the name of a gain that is wrong",
    )
