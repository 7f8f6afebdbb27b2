"""The parts of a pooled diagnosis, as data."""

from dataclasses import dataclass, field
from typing import Literal

from echocal.diagnose.findings.parts import Cause, Parameter
from echocal.diagnose.pooling.transfer import Transfer
from echocal.diagnose.results.diagnosis import Diagnosis
from echocal.model import Model

__all__ = ["InTable", "PooledCause", "PooledParameter", "Role", "SkippedTable", "TableResult"]

Role = Literal["supports", "contradicts", "undecided", "not tested"]


@dataclass(frozen=True)
class PooledParameter(Parameter):
    """A size that tables share: its mean, and the standard deviation between tables."""

    between_tables: float


@dataclass(frozen=True)
class InTable:
    """What one table says about a shared cause.

    Attributes
    ----------
    table : str
        Name.
    role : str
        ``supports`` or ``contradicts``, by `log_bayes`; ``undecided`` between them; ``not tested``:
        the table cannot show the cause.
    log_bayes : float
        Log Bayes factor of this table, given the others, for the cause beside the other shared causes.
    parameters : tuple of Parameter
        Sizes from this table alone. A size that the table hardly shows has a large uncertainty.
    drawn : tuple of Parameter
        Sizes of this table, drawn to the mean of all tables.
    why : str
        Why the cause is not tested.
    """

    table: str
    role: Role
    log_bayes: float
    parameters: tuple[Parameter, ...] = ()
    drawn: tuple[Parameter, ...] = ()
    why: str = ""


@dataclass(frozen=True, kw_only=True)
class PooledCause(Cause):
    """A cause that tables share; no table separates it from those in ``indistinguishable_from``.

    Attributes
    ----------
    shares : str
        ``sizes``: the tables share sizes or a form; ``name``: only that the cause is there.
    recurs_in : tuple of str
        Names of the tables that support it.
    tested_in : int
        Number of tables that can show it.
    """

    parameters: tuple[PooledParameter, ...]
    shares: Literal["sizes", "name"]
    tables: tuple[InTable, ...]
    recurs_in: tuple[str, ...]
    tested_in: int


@dataclass(frozen=True)
class SkippedTable:
    """A table that could not be diagnosed.

    Attributes
    ----------
    name : str
    rows : int or None
        Number of rows, where it is known.
    reason : str
    """

    name: str
    rows: int | None
    reason: str


@dataclass(frozen=True)
class TableResult:
    """One table of a pool.

    Attributes
    ----------
    diagnosis : Diagnosis
        Of this table alone.
    model : Model
        Base, shared causes with the sizes of this table, and causes of its own.
    own_causes : tuple of str
        Effects of its diagnosis that the tables do not share.
    transfer : Transfer
        Error on this table of the model that all other tables choose and fit.
    """

    diagnosis: Diagnosis = field(repr=False)
    model: Model = field(repr=False)
    own_causes: tuple[str, ...]
    transfer: Transfer
