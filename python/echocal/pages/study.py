"""The page of the study: each claim with its verdict and its reason, and the figures."""

from typing import Any

from echocal.charts.parts import Axis, Chart, Line, Panel, span
from echocal.report.html.document import rendered
from echocal.study import DEFINITION, Study, given
from echocal.study.origin import CAUSES
from echocal.study.report import MARKS
from echocal.study.verdict import Finding, Verdict

_TONES = ("three", "two", "one")
_MM = 1e3


def study_page(study: Study) -> str:
    """The study as an HTML document that needs no other file and no network."""
    groups = dict.fromkeys(finding.claim.group for finding in study.findings)
    return rendered(
        "study.html.j2",
        "study",
        "the study, recomputed",
        total=len(study.findings),
        verdicts=[(MARKS[Verdict(name)], count, name) for name, count in study.verdicts.items()],
        definition=[f"{part.strip()}." for part in DEFINITION.rstrip(".").split(". ")],
        figure=_reading(study),
        discoveries=study.discoveries,
        alternatives=[
            (CAUSES[one.cause], one.cause, str(one), f"{_MM * one.residual_standard_deviation:.2f} mm")
            for one in study.alternatives
        ],
        groups=[(name, [_claim(f) for f in study.findings if f.claim.group == name]) for name in groups],
        given=given(),
    )


def _claim(finding: Finding) -> dict[str, Any]:
    claim = finding.claim
    return {
        "mark": MARKS[finding.verdict],
        "verdict": finding.verdict.value,
        "kind": finding.verdict.value.replace(" ", "-"),
        "claim": claim.claim,
        "where": claim.where,
        "printed": f"{claim.printed} {claim.unit}".strip(),
        "recomputed": finding.recomputed,
        "physical": finding.physical,
        "because": finding.because,
    }


def _reading(study: Study) -> Chart:
    """Error of the study's sensor at its distance: by its own equation, printed, and in true air."""
    from echocal.study.tables import DISTANCE

    curves = study.curves
    named = [*zip(curves.air.items(), _TONES, strict=True), (("the study's equation", curves.stated), "five")]
    lines = [Line(name, tone, curves.temperature, _MM * (curve - DISTANCE)) for (name, curve), tone in named]
    x = Axis("temperature [degC]", *span([curves.temperature]))
    y = Axis(f"reading less {DISTANCE:g} m [mm]", *span([line.y for line in lines]))
    caption = (
        f"A sensor that assumes one speed of sound, before a target at {DISTANCE:g} m; true air by humidity"
    )
    return Chart("", x, [Panel("", y, lines)], [caption])
