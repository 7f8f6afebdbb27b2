"""Pages of a calibration, a verification and an inspection."""

from echocal.calibrate import Calibration
from echocal.charts.results import columns_chart, errors_chart, residual_chart
from echocal.observations.inspection import ColumnFacts, Inspection
from echocal.report.html.document import Head, Section, notes_of, sections_page
from echocal.report.results import headline
from echocal.verify import Verification


def calibration_page(found: Calibration, heading: str, made_by: str = "") -> str:
    """A calibration as an HTML document that needs no other file and no network."""
    bounded = set(found.at_bounds)
    rows = [
        (
            one.name,
            f"{one.value:.6g}",
            f"{one.standard_uncertainty:.2g}",
            one.unit,
            "on a bound: the uncertainty is not reliable" if one.name in bounded else "",
        )
        for one in found
    ]
    pairs = [
        (second, first, f"{found.correlation[i, j]:+.3f}")
        for i, first in enumerate(found.names)
        for j, second in enumerate(found.names[:i])
    ]
    deviation = 1e3 * found.residual_standard_deviation
    facts = [
        ("rows used", f"{found.rows['used']} of {found.rows['total']}"),
        ("residual standard deviation", f"{deviation:.3f} mm"),
        ("loss", found.loss),
    ]
    sections = [
        Section("Parameters", [], (), ("parameter", "value", "standard uncertainty", "unit", ""), rows),
        Section("Correlations", [], (), ("", "", "correlation"), pairs),
        Section("Residuals", charts=[residual_chart(found)]),
        notes_of(found.notes),
    ]
    return sections_page(
        "calibrate", Head("Calibration", heading, headline(found), "", facts), sections, made_by
    )


def verification_page(found: Verification, heading: str, made_by: str = "") -> str:
    """A verification as an HTML document that needs no other file and no network."""
    sentence = headline(found).partition(": ")[2]
    facts = [
        ("maximum permissible error", f"{1e3 * found.maximum_permissible_error:g} mm"),
        ("errors examined", str(found.count)),
        ("errors beyond it", str(found.exceeding)),
    ]
    if found.guard_band:
        facts.append(("guard band, at most", f"{1e3 * found.guard_band:.2g} mm"))
        facts.append(("errors too near to the bound to decide", str(found.undecided)))
    left = [f"{count} rows are not examined: {why}." for why, count in found.unusable.items()]
    left += [f"{count} rows are examined without it: {why}." for why, count in found.outside_smooth.items()]
    sections = [Section("Errors", charts=[errors_chart(found)]), Section("Rows", left), notes_of(found.notes)]
    head = Head("Verification", heading, sentence, found.decision, facts)
    return sections_page("verify", head, sections, made_by)


def inspection_page(found: Inspection, heading: str, made_by: str = "") -> str:
    """What a log holds, as an HTML document that needs no other file and no network."""
    usable = f"{found.usable} of {found.rows} rows can be used"
    facts = [("format", found.kind), ("rows", str(found.rows)), ("columns", str(len(found.columns)))]
    clock = found.clock
    times = []
    if clock is not None:
        times = [f"From {clock.first} to {clock.last}, a row each {clock.usual_step_s:g} s.", *clock.shown]
    sensors = [f"{count} sensors in {name}." for name, count in found.sensors.items()]
    chart = columns_chart(found)
    sections = [
        Section(
            "Columns",
            sensors,
            (),
            ("column", "holds", "because", "values", "missing"),
            [_column(one) for one in found.columns],
        ),
        Section("Clock", times),
        Section("Values over the rows", charts=[] if chart is None else [chart]),
        notes_of(found.notes),
    ]
    word = "refused" if found.refusal else ""
    head = Head("Inspection", heading, (found.refusal or usable).rstrip("."), word, facts)
    return sections_page("inspect", head, sections, made_by)


def _column(one: ColumnFacts) -> tuple[str, ...]:
    proposal = one.proposal
    values = ", ".join(one.examples)
    if one.median is not None:
        values = f"{one.least:.4g} to {one.most:.4g} {one.unit}".rstrip()
    because = f"a guess: {proposal.reason}" if proposal.guess else proposal.reason
    codes = f"; error code {', '.join(f'{code:g}' for code in one.codes)}?" if one.codes else ""
    return one.name, proposal.request or "no quantity", because, values, f"{one.missing}{codes}"
