"""A table of a campaign, with what is true about it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from echocal.errors import UsageError
from echocal.keywords import command_line
from echocal.virtual_bench.campaign.campaign import INTERFERENCE, TILT, Campaign, Random
from echocal.virtual_bench.campaign.causes import CAUSES
from echocal.virtual_bench.campaign.designs import lay_down
from echocal.virtual_bench.waveform.fluctuations import remembering
from echocal.virtual_bench.waveform.measure import Echoes, measure
from echocal.virtual_bench.waveform.possible import check_seed
from echocal.virtual_bench.waveform.scene import Scene
from echocal.virtual_bench.waveform.sensor import Sensor

Column = NDArray[np.float64]

_MICRO, _PERCENT, _SUPPLY = 1e6, 100.0, 5.0
_THERMOMETER_NOISE = 0.05  # K, of one reading: DS18B20 datasheet, 12 bits: steps of 0.0625 K


@dataclass(frozen=True)
class Simulation:
    """A table and its truth.

    Attributes
    ----------
    table : DataFrame
        As the user's logger wrote it.
    campaign : Campaign
    scene : Scene
    echoes : Echoes
        What the sensor said.
    causes : dict
        Id and size of what was staged.
    seed : int
    detector : str
        The one that measured: some causes act on the comparator and bring it with them.
    notes : tuple of str
        Which causes the design hardly shows.
    """

    table: pd.DataFrame
    campaign: Campaign
    scene: Scene
    echoes: Echoes
    causes: dict[str, float]
    seed: int
    detector: str
    notes: tuple[str, ...]

    def truth(self) -> dict[str, Any]:
        """What is true, as a document of JSON."""
        staged = [
            {"id": name, "size": size, "unit": CAUSES[name].unit, "sentence": CAUSES[name].sentence}
            for name, size in self.causes.items()
        ]
        base = "cramer" if "echo_us" in self.table else None
        unknown = self.campaign.unknown_constant
        return {
            "schema": "echocal.simulation/1",
            "design": self.campaign.design,
            "seed": self.seed,
            "detector": self.detector,
            "rows": len(self.table),
            "causes": staged,
            "notes": list(self.notes),
            "diagnose": command_line("diagnose", "TABLE", base=base, constant_distance=unknown),
        }


def offers(campaign: Campaign) -> frozenset[str]:
    """List what a cause may need of a design."""
    found = {"time"} if np.ptp(campaign.seconds) > 0 else set()
    if np.ptp(campaign.distance) > 0.3:
        found.add("distances")
    if np.ptp(campaign.seconds) > 86400.0:
        found.add("weather")
    if campaign.around.radiation.max() > 0:
        found.add("open air")
    found.add("reference" if campaign.reference is not None else "unknown distance")
    if campaign.by_hand:
        found.add("visits")
    return frozenset(found)


def simulate(
    design: str,
    causes: Mapping[str, float | None] | None = None,
    *,
    seed: int = 0,
    detector: str = "comparator",
    replicate: int = 0,
    sensor: Sensor | None = None,
) -> Simulation:
    """Run a campaign on the bench.

    Parameters
    ----------
    design : str
        One of `designs()`.
    causes : mapping of str to float or None, optional
        Size of each cause, in its unit; None: a usual size is drawn.
    seed : int
        The same seed gives the same table; with and without a cause it gives the same air and noise.
    detector : {"comparator", "ideal"}
        "ideal" tells the front of each echo: no time walk.
    replicate : int
        Above 0: the same sensor, places and causes in another campaign, with air, noise and references of
        its own.
    sensor : Sensor, optional
        The one that measures; default: an HC-SR04.

    Returns
    -------
    Simulation

    Raises
    ------
    UsageError
        If a name is not known, a design has not what a cause needs, or a size cannot be or brings a scene
        about that cannot be, such as a target behind the sensor.

    Examples
    --------
    >>> from echocal.virtual_bench import simulate
    >>> made = simulate("quick", {"fixed_delay": 80e-6}, seed=1)
    >>> len(made.table)
    48
    """
    check_seed("seed", seed)
    check_seed("replicate", replicate)
    random = Random(seed, replicate)
    campaign = lay_down(design, random)
    if detector not in ("comparator", "ideal"):
        raise UsageError(f"detector is 'comparator' or 'ideal', not '{detector}'")
    campaign.sensor = (sensor or campaign.sensor).but(ideal=detector == "ideal")
    sizes = {name: _stage(campaign, name, size, random) for name, size in (causes or {}).items()}
    try:
        scene = scene_of(campaign, random)
    except UsageError as error:
        given = " and ".join(f"{name}={size:g}" for name, size in sizes.items())
        message = f"{design} with {given or 'no cause'} cannot be: {error}; give a smaller size"
        raise UsageError(message) from None
    echoes = measure(scene, campaign.sensor, random("noise"))
    table = _written(campaign, echoes, random)
    used = "ideal" if campaign.sensor.comparator.ideal else "comparator"
    notes = tuple(
        f"{name} hardly shows in the design '{design}', which has no weather of days"
        for name in sizes
        if "weather" in CAUSES[name].needs - offers(campaign)
    )
    return Simulation(table, campaign, scene, echoes, sizes, seed, used, notes)


def _stage(campaign: Campaign, name: str, size: float | None, random: Random) -> float:
    """Stage a cause, and return its size."""
    if name not in CAUSES:
        raise UsageError(f"the bench cannot stage '{name}'; it stages {', '.join(sorted(CAUSES))}")
    lacks = CAUSES[name].refused(offers(campaign))
    if lacks:
        raise UsageError(
            f"'{name}' needs {' and '.join(sorted(lacks))}, which the design '{campaign.design}' has not"
        )
    drawn = CAUSES[name].draw(random(f"size {name}", kept=True)) if size is None else CAUSES[name].check(size)
    CAUSES[name].stage(campaign, drawn, random(f"cause {name}", kept=True))
    return drawn


def scene_of(campaign: Campaign, random: Random) -> Scene:
    """Draw slow air, hands and turbulence of a campaign, and return what its sensor stands before."""
    own = random("air")
    air = campaign.air + campaign.slow_air * remembering(campaign.seconds, 1800.0, own)
    mounted = not campaign.by_hand  # once, and in a replicate it still is
    hands = random("hand", kept=mounted).normal(size=(2, campaign.placement.max() + 1))
    hand = hands[:, campaign.placement]
    way, louder = campaign.turbulence.draw(
        campaign.seconds, campaign.distance, campaign.placement, random("turbulence")
    )
    return Scene(
        campaign.distance,
        temperature=air,
        relative_humidity=campaign.around.relative_humidity,
        pressure=campaign.around.pressure,
        co2_mole_fraction=campaign.co2,
        device_temperature=campaign.device_temperature,
        wind_along=campaign.around.wind_along,
        wind_across=campaign.around.wind_across,
        supply=campaign.around.supply,
        target=replace(campaign.target, tilt=campaign.target.tilt + TILT * hand[0]),
        way=way,
        louder=louder * np.exp(INTERFERENCE * hand[1]),
        **campaign.scene,
    )


def _written(campaign: Campaign, echoes: Echoes, random: Random) -> pd.DataFrame:
    """What the logger writes."""
    pulse = echoes.time
    for stage in campaign.pulse:
        pulse = stage(pulse)
    noise = random("thermometer").normal(size=len(campaign))
    recorded = campaign.around.temperature + _THERMOMETER_NOISE * noise
    for warm in campaign.thermometer:
        recorded = warm(recorded)
    columns: dict[str, NDArray[np.generic] | None] = {
        "time_s": np.round(campaign.seconds, 2),
        "echo_us": np.round(_MICRO * pulse),
        "temperature_C": np.round(recorded, 2),
        "humidity_percent": np.round(_PERCENT * campaign.around.relative_humidity, 1),
        "pressure_hPa": np.round(0.01 * campaign.around.pressure, 1),
    }
    further: dict[str, NDArray[np.generic] | None] = {
        "wind_m_s": np.round(np.abs(campaign.around.wind_along), 2),
        "radiation_W_m2": np.round(campaign.around.radiation, 0),
        "supply_V": np.round(_SUPPLY * campaign.around.supply, 3),
        "amplitude": np.round(echoes.amplitude, 4),
        "temperature_wall_C": campaign.second_thermometer,
    }
    columns |= {name: further[name] for name in further if name in campaign.shown}
    if campaign.reference is not None:
        columns["distance_m"] = np.round(campaign.reference, 4)
    if campaign.by_hand and campaign.numbered:
        columns["stand"] = 1 + campaign.placement
    table = pd.DataFrame(columns)
    for write in campaign.logger:
        table = write(table)
    return table
