"""The virtual bench: ultrasonic sensors in air, from the waveform to the table.

It is a second world, independent of the rest on purpose: `air` has laws of its own, and nothing
here knows the effects that a diagnosis looks for. `waveform` makes readings, `campaign` tables.
"""

from echocal.virtual_bench.campaign.causes import CAUSES, Cause
from echocal.virtual_bench.campaign.designs import DESIGNS
from echocal.virtual_bench.campaign.simulate import Simulation, simulate
from echocal.virtual_bench.waveform.burst import Resonance
from echocal.virtual_bench.waveform.measure import Echoes, measure, waveform
from echocal.virtual_bench.waveform.scene import Scene
from echocal.virtual_bench.waveform.sensor import Comparator, Sensor
from echocal.virtual_bench.waveform.target import Target

__all__ = [
    "CAUSES",
    "DESIGNS",
    "Cause",
    "Comparator",
    "Echoes",
    "Resonance",
    "Scene",
    "Sensor",
    "Simulation",
    "Target",
    "measure",
    "simulate",
    "waveform",
]
