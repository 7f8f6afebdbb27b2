"""The study that echocal began from: every number recomputed, with a verdict."""

import tomllib
from collections import Counter
from dataclasses import asdict, dataclass
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echocal.study import checks
from echocal.study.discoveries import Discovery, discoveries
from echocal.study.origin import REFERENCE_LAW, STATED_LAW, Alternative, alternatives, reading_in
from echocal.study.tables import Tables
from echocal.study.verdict import CHECKS, Claim, Finding, Verdict

__all__ = ["DEFINITION", "Claim", "Finding", "Study", "Tables", "Verdict", "claims", "given", "run"]

HUMIDITIES = {"dry air": 0.0, "50 % RH": 0.5, "100 % RH": 1.0}


@dataclass(frozen=True)
class Curves:
    """Readings [m] of the sensor at 2 m."""

    temperature: NDArray[np.float64]  # temperatures [degC]; shape (n,)
    stated: NDArray[np.float64]  # by the study's equation; shape (n,)
    air: dict[str, NDArray[np.float64]]  # in true air, by humidity; shape (n,)

    @classmethod
    def of(cls, tables: Tables) -> "Curves":
        """Compute the curves over the range of Table 1."""
        temperature = tables.table1.range(201)
        air = {
            name: reading_in(REFERENCE_LAW, temperature, relative_humidity=humidity)
            for name, humidity in HUMIDITIES.items()
        }
        return cls(temperature, reading_in(STATED_LAW, temperature), air)


DEFINITION = (
    "reproduced: the printed inputs can give the printed result, both within their rounding. "
    "not reproduced: they cannot. "
    "physically wrong: the claim contradicts the physics of air or echoes, whatever its arithmetic."
)

assert checks.__all__  # importing the package registers the checks


@dataclass(frozen=True)
class Study:
    """Everything found about the study."""

    tables: Tables  # the tables that were judged
    findings: list[Finding]  # one per claim, in the order of ``claims.toml``
    discoveries: list[Discovery]  # what the tables give away
    alternatives: list[Alternative]  # single changes that may explain the Tinkercad column
    curves: Curves  # the study's sensor in true air, for the figures

    @property
    def verdicts(self) -> dict[str, int]:
        """Number of claims by verdict."""
        counts = Counter(finding.verdict for finding in self.findings)
        return {verdict.value: counts[verdict] for verdict in Verdict}

    def __getitem__(self, id_: str) -> Finding:
        return {finding.claim.id: finding for finding in self.findings}[id_]

    def to_dict(self) -> dict[str, Any]:
        """Everything for JSON (schema ``echocal.study/1``)."""
        return {
            "schema": "echocal.study/1",
            "definition": DEFINITION,
            "verdicts": self.verdicts,
            "claims": [finding.to_dict() for finding in self.findings],
            "given": given(),
            "discoveries": [asdict(discovery) for discovery in self.discoveries],
            "alternatives": [asdict(alternative) for alternative in self.alternatives],
        }


def claims() -> list[Claim]:
    """Every claim of the study, as data.

    Examples
    --------
    >>> from echocal.study import claims
    >>> claims()[0].claim
    'the speeds follow v(T) = 331.4 + 0.6 T'
    """
    return [Claim(**entry) for entry in _data()["claim"]]


def given() -> list[dict[str, str]]:
    """Numbers of the study that are taken as they are, each with the reason."""
    return [dict(entry) for entry in _data()["given"]]


def _data() -> dict[str, Any]:
    text = (resources.files("echocal.study") / "data" / "claims.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


def run(tables: Tables | None = None) -> Study:
    """Recompute every claim.

    Parameters
    ----------
    tables : Tables, optional
        Other tables than those that the package ships.

    Returns
    -------
    Study
        A finding per claim, and what the tables give away.

    Examples
    --------
    >>> from echocal import study
    >>> found = study.run()
    >>> found["rmse-calculation"].verdict.value, found["pressure-percent"].verdict.value
    ('reproduced', 'physically wrong')
    """
    tables = tables or Tables.load()
    findings = [CHECKS[claim.check](tables, claim, **claim.options) for claim in claims()]
    return Study(tables, findings, discoveries(tables), alternatives(tables), Curves.of(tables))
