"""Firmware for many units, each with parameters of its own in a block of EEPROM or flash."""

from echocal.per_unit.block import Block, crc16
from echocal.per_unit.box import Box
from echocal.per_unit.design import UnitFirmware, generate_per_unit
from echocal.per_unit.units import TABLE, Written, block_of, number_of, write_units

__all__ = ["TABLE", "Block", "Box", "UnitFirmware", "Written", "block_of", "crc16", "generate_per_unit"]
__all__ += ["number_of", "write_units"]
