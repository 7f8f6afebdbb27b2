"""The page of the study: each claim with its verdict and its reason, and the figures."""

from typing import Any

from echocal.report.html.document import Drawn, drawn, rendered
from echocal.study import DEFINITION, Study, given
from echocal.study.origin import CAUSES
from echocal.study.report import MARKS
from echocal.study.verdict import Finding, Verdict

__all__ = ["study_page"]

_COLORS = ("#9fb3c8", "#2d7dd2", "#12355b")
_MM = 1e3


def study_page(study: Study) -> str:
    """The study as an HTML document that needs no other file and no network.

    Parameters
    ----------
    study : Study

    """
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


def _reading(study: Study) -> Drawn:
    """Error of the study's sensor at its distance: by its own equation, printed, and in true air."""
    import plotly.graph_objects as go

    from echocal.report.html.figures import styled
    from echocal.study.tables import DISTANCE

    curves, figure = study.curves, go.Figure()
    lines = [(name, curve, color) for (name, curve), color in zip(curves.air.items(), _COLORS, strict=True)]
    for name, curve, color in [*lines, ("the study's equation", curves.stated, "#d64545")]:
        figure.add_scatter(
            x=curves.temperature.round(2).tolist(),
            y=(_MM * (curve - DISTANCE)).round(3).tolist(),
            name=name,
            line={"color": color, "width": 2},
            hovertemplate="%{x} degC<br>%{y:.2f} mm",
        )
    figure.update_xaxes(title="temperature [degC]")
    figure.update_yaxes(title=f"reading less {DISTANCE:g} m [mm]")
    figure.update_layout(legend={"orientation": "h", "y": -0.2, "yanchor": "top"})
    caption = (
        f"A sensor that assumes one speed of sound, before a target at {DISTANCE:g} m; true air by humidity."
    )
    return drawn("The reading over the temperature", styled(figure, 400), caption)
