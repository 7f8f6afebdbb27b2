"""The speed with which readings become echo times before a model corrects them."""

from echocal.model.composition import Model

INDICATION_SPEED = "indication_speed"
"""What a model keeps of a base that is a fixed speed: its effects count from the readings of that device."""


def speed_of(model: Model, stated: str | float | None = None) -> str:
    """Speed with which readings become echo times: as stated, as the model's diagnosis had it, or the law.

    A diagnosis that was told the speed of the firmware writes it into the model.
    """
    kept = model.provenance.get("reading_speed")
    return str(stated or "") or (kept if isinstance(kept, str) and kept else model.law)


def indication_law(model: Model) -> str:
    """The law, or speed, of the indication that the effects of a model count from."""
    kept = model.provenance.get(INDICATION_SPEED)
    return kept if isinstance(kept, str) and kept else model.law
