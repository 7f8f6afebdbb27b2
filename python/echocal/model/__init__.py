"""Models: a law for the speed of sound and the effects that extend it."""

from echocal.model.composition import Model
from echocal.model.residual_uncertainty import ResidualUncertainty
from echocal.model.shape import Shape, Smooth

__all__ = ["Model", "ResidualUncertainty", "Shape", "Smooth"]
