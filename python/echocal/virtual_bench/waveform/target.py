"""What a target returns: beam pattern, spreading, diffraction at the edges."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import fresnel, j1

from echocal.virtual_bench.waveform.possible import Limits, check

Column = NDArray[np.float64]
Phasor = NDArray[np.complex128]

_EXTENT = Limits(0.0, above=True, endless=True, unit="m")
_POSSIBLE = {
    "reflectivity": Limits(0.0, 1.0),
    "half_width": _EXTENT,
    "half_height": _EXTENT,
    "tilt": Limits(-np.pi / 2, np.pi / 2, unit="rad", way_out="turned further, it shows its back"),
    "offset": Limits(unit="m"),
    "radius": _EXTENT,
    "roughness": Limits(0.0, unit="m"),
}


@dataclass(frozen=True)
class Target:
    """A flat or curved reflector; each number may be one for every reading.

    Attributes
    ----------
    reflectivity : float or ndarray, shape (n,)
        Pressure that comes back over that of a hard wall.
    half_width, half_height : float or ndarray, shape (n,)
        Half of its extent [m].
    tilt : float or ndarray, shape (n,)
        Between its normal and the axis of the sensor, about the vertical [rad].
    offset : float or ndarray, shape (n,)
        Of its center from the axis, to the side [m].
    radius : float or ndarray, shape (n,)
        Of curvature about the vertical [m]; infinite where it is flat. A pole has the radius of its section.
    roughness : float or ndarray, shape (n,)
        Standard deviation of its surface along the axis [m].

    Raises
    ------
    UsageError
        If something cannot be, such as a width of zero.
    """

    reflectivity: float | Column = 1.0
    half_width: float | Column = 0.3
    half_height: float | Column = 0.3
    tilt: float | Column = 0.0
    offset: float | Column = 0.0
    radius: float | Column = np.inf
    roughness: float | Column = 0.0

    def __post_init__(self) -> None:
        for name, limits in _POSSIBLE.items():
            check(f"target.{name}", getattr(self, name), limits)

    def at(self, rows: NDArray[np.int64]) -> Self:
        """Return the targets of some readings."""
        given = {name: value for name, value in vars(self).items() if isinstance(value, np.ndarray)}
        return replace(self, **{name: value[rows] for name, value in given.items()})


def directivity(angle: ArrayLike, radius: float, wave_number: ArrayLike) -> Column:
    """Compute the pressure of a piston in a wall off its axis, over that on the axis.

    Every second lobe is negative. Kinsler, Frey, Coppens & Sanders 2000, Fundamentals of Acoustics, 4th ed.,
    section 7.4. The angle off the axis is in rad, the radius in m, the wave number in rad/m.
    """
    x = np.asarray(wave_number) * radius * np.sin(angle)
    near = np.abs(x) < 1e-6
    safe = np.where(near, 1.0, x)
    return np.where(near, 1.0, 2 * j1(safe) / safe)


def aperture(half: ArrayLike, center: ArrayLike, distance: Column, wave_number: Column) -> Phasor:
    """Compute the part of the wave that a strip returns, over an endless wall: 1 inside, 1/2 at its edge.

    The strip reaches from `center - half` to `center + half` beside the foot of the perpendicular. The
    way to a point at x and back is 2 d + x^2 / d: Fresnel's integral of exp(-i k x^2 / d), Goodman 2005,
    Introduction to Fourier Optics, 3rd ed., section 4.5.1.
    """
    scale = np.sqrt(2 * wave_number / (np.pi * distance))
    sine_high, cosine_high = fresnel(scale * (np.asarray(center) + half))
    sine_low, cosine_low = fresnel(scale * (np.asarray(center) - half))
    wave = (cosine_high - cosine_low) - 1j * (sine_high - sine_low)
    return np.asarray(wave / (1 - 1j))


def echo_of(
    target: Target, distance: Column, wave_number: Column, piston: float, spacing: float = 0.0
) -> tuple[Phasor, Column]:
    """Compute the echo of a target over that of an endless hard wall at one meter on the axis.

    `distance`, shape (n,), is from the sensor to the middle of the target along the axis [m], `spacing` that
    between the axes of the transducers [m], which lie in the plane in which the target tilts. The phasor has
    spreading, beam, edges, curvature and roughness, not the absorption of the air; the path is out and back
    by the nearest point [m].

    Notes
    -----
    The foot is the point of the surface where its normal leads to the sensor. Where it lies beyond an edge,
    the edge is the nearest point. Both edges are taken together from the beginning, as in a steady wave.
    A rough surface returns the coherent part `exp(-2 (k s)^2)` (Eckart 1953, doi:10.1121/1.1907123); what it
    scatters to the sides is left out.
    """
    tilt, offset, bend = np.asarray(target.tilt), np.asarray(target.offset), 1 / np.asarray(target.radius)
    flat = distance * np.cos(tilt) - offset * np.sin(tilt)  # to the plane that touches the middle
    aside = distance * np.sin(tilt) + offset * np.cos(tilt)  # of the middle, from the foot in that plane
    curved = 1 / (1 + flat * bend)
    foot = flat + 0.5 * aside**2 * bend * curved  # of a curved surface: its foot moves toward the middle
    aside = aside * curved
    edge = np.sign(aside) * np.maximum(np.abs(aside) - np.asarray(target.half_width), 0.0)
    along = np.sqrt(curved)
    further = 2 * (np.hypot(foot, edge / along) - foot)  # to the edge and back, beyond the way to the foot
    wide = aperture(np.asarray(target.half_width) / along, aside / along, foot, wave_number)
    high = aperture(target.half_height, 0.0, foot, wave_number)
    seen = np.arctan2(aside / curved - aside + edge, foot) - tilt  # of the nearest point, off the axis
    half = np.arctan2(0.5 * spacing, foot)  # between the axes and the two ways
    beam = directivity(seen + half, piston, wave_number) * directivity(seen - half, piston, wave_number)
    rough = np.exp(-2 * (wave_number * np.asarray(target.roughness)) ** 2)
    path = np.hypot(2 * np.maximum(foot, 1e-3), spacing) + further
    size = 2 * np.asarray(target.reflectivity) * beam * along * rough / path
    # The way to the edge has its phase in the aperture; as it is in the path too, it is taken out here.
    turned = np.exp(1j * wave_number * edge**2 / (foot * curved))
    return np.asarray(size * wide * high * turned), np.asarray(path)
