"""Read an HC-SR04 and print the corrected distance, with MicroPython or CircuitPython.

Pins are examples. Put your thermometer where a fixed value stands.

SPDX-License-Identifier: MIT OR Apache-2.0
"""

import time

from echocal_correction import OUT_OF_RANGE, distance_um

TEMPERATURE = 20.0  # [degC]

try:
    from machine import Pin, time_pulse_us
except ImportError:  # CircuitPython
    import board
    import digitalio
    import pulseio

    trigger = digitalio.DigitalInOut(board.D7)
    trigger.switch_to_output(False)
    echo = pulseio.PulseIn(board.D8, maxlen=1)

    def echo_time():
        """Length of the echo pulse [us]; less than 0 if there is none."""
        echo.clear()
        trigger.value = True
        time.sleep(0.00001)
        trigger.value = False
        time.sleep(0.06)
        return echo[0] if len(echo) else -1
else:
    trigger, echo = Pin(4, Pin.OUT), Pin(5, Pin.IN)

    def echo_time():
        """Length of the echo pulse [us]; less than 0 if there is none."""
        trigger.value(1)
        time.sleep_us(10)
        trigger.value(0)
        return time_pulse_us(echo, 1, 60000)


while True:
    codes = [echo_time(), round((TEMPERATURE - 0.0) / 0.5)]
    distance = distance_um(*codes)
    print("out of range" if distance == OUT_OF_RANGE else distance)
    time.sleep(0.06)
