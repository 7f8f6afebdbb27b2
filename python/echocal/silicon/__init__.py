"""Simulated silicon: what generated functions cost there, and what whole sketches print.

`measure` and `output_hash` call a generated function on a core and compare it with what was proven.
`compile_sketch` and `play` run a sketch on an emulated Arduino UNO with a virtual HC-SR04.

Needs the compilers and simulators of the core in question, nothing of which comes with this package:
avr-gcc, libsimavr and a C compiler for an ATmega328P, the Arduino core for sketches; arm-none-eabi-gcc or
riscv64-unknown-elf-gcc and QEMU for the others.
"""

from echocal.silicon.arduino import SKETCHES, Sketch, compile_sketch, missing_for_sketches, refuse_missing
from echocal.silicon.board import Generated
from echocal.silicon.cores import CORES, cores_of
from echocal.silicon.measurement import Measurement, measure, missing, output_hash
from echocal.silicon.uno import Played, play, refuse_impossible
from echocal.time_outs import HC_SR04 as TIME_OUT

__all__ = ["CORES", "SKETCHES", "TIME_OUT", "Generated", "Measurement", "Played", "Sketch", "compile_sketch"]
__all__ += ["cores_of", "measure", "missing", "missing_for_sketches", "output_hash", "play"]
__all__ += ["refuse_impossible", "refuse_missing"]
