"""Read an HC-SR04 and print the corrected distance, with MicroPython or CircuitPython.

The pins are examples. The program was tested on a PC with replacements for the modules of both. It was not tested on a
board. Replace the fixed temperature below by the reading of your sensor.

SPDX-License-Identifier: MIT OR Apache-2.0
"""

import time

from echocal_correction import OUT_OF_RANGE, distance_um, status

REASONS = ("ok", "no echo", "too near", "too far", "temperature out of range", "humidity out of range")  # by status
TEMPERATURE = 20.0  # [degC]

try:
    from machine import Pin, time_pulse_us
except ImportError:  # CircuitPython
    import board
    import digitalio
    import pulseio

    trigger = digitalio.DigitalInOut(board.D7)
    trigger.switch_to_output(False)
    # The first pulse after resume() is the echo. Some ports also report the pause after it.
    pulses = pulseio.PulseIn(board.D8, maxlen=2)

    def echo_time():
        """Return the length of the echo pulse [us], or a negative number if there is no pulse."""
        pulses.pause()
        pulses.clear()
        pulses.resume()
        trigger.value = True
        time.sleep(0.00001)
        trigger.value = False
        # An ESP32 reports a pulse 65 ms after its end. Without an echo, some modules end the pulse after 200 ms.
        # A length of 65535 us stands for all longer ones, too: PulseIn measures no more.
        for _ in range(30):
            time.sleep(0.01)
            if len(pulses):
                return pulses[0] if pulses[0] < 65535 else -1
        return -1
else:
    trigger, echo = Pin(4, Pin.OUT), Pin(5, Pin.IN)

    def echo_time():
        """Return the length of the echo pulse [us], or a negative number if there is no pulse."""
        if echo.value():  # still the time-out pulse of an earlier measurement: not an echo
            return -1
        trigger.value(1)
        time.sleep_us(10)
        trigger.value(0)
        return time_pulse_us(echo, 1, 50073)  # [us] until it gives up: -1 or -2


while True:
    length = echo_time()
    if length < 0:
        print("no echo")
    else:
        codes = [length, round((TEMPERATURE - 0.0) / 0.5)]
        distance = distance_um(*codes)
        print(REASONS[status(*codes)] if distance == OUT_OF_RANGE else distance)
    time.sleep(0.06)
