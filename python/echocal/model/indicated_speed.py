"""The speed with which readings become echo times before a model corrects them."""

from echocal.model.composition import Model

__all__ = ["speed_of"]


def speed_of(model: Model, stated: str | float | None = None) -> str:
    """Speed with which readings become echo times: as stated, as the model's diagnosis had it, or the law.

    A diagnosis that was told the speed of the firmware writes it into the model.
    """
    kept = model.provenance.get("reading_speed")
    return str(stated or "") or (kept if isinstance(kept, str) and kept else model.law)
