"""Models: a law for the speed of sound and the effects that extend it."""

from echocal.model.composition import Model

__all__ = ["Model"]
