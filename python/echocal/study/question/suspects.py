"""What may have made the Tinkercad column: each suspect is one change of the program or of the scene."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from echocal.study.question import scenes
from echocal.study.question.scenes import Scene


@dataclass(frozen=True)
class Free:
    """A size that is not known."""

    name: str
    unit: str
    # low, high: what is possible, uniformly
    low: float
    high: float
    staged: float  # size on the emulated board; the effect of other sizes is proportional
    why: str  # where the range comes from


@dataclass(frozen=True)
class Suspect:
    """One change of the experiment."""

    id: str
    title: str
    place: str
    """Part of the experiment. Two suspects of one place exclude each other."""
    says: str
    """What happens, in one sentence."""
    macros: Mapping[str, str] = field(default_factory=dict)
    """Steps of the program that are replaced."""
    scene: Scene = scenes.plain
    """What person and module do."""
    free: Free | None = None
    """Its size, if nothing fixes it."""
    tables: int = 2
    """Number of tables that the board makes."""
    silence: float | None = None
    """From the trigger to the rise of ECHO [s]; default: drawn, so that the phase to `millis()` is."""
    absent: str = ""
    """Why Tinkercad cannot have it; empty if it can."""
    cuts_off: bool = False
    """Whether the steps of its rows belong to it."""


_RANDOM_TABLES = 20
_CAME_LATE = "(delayMicroseconds({us}), {call})"
_PRINTS = {"BEFORE": 'Serial.print("the air has the temperature of ");'}  # 31 characters

SUSPECTS = (
    Suspect(
        "nothing",
        "nothing",
        "none",
        "The program as described: single precision, a 10-bit converter, 1 us, 1 mm.",
    ),
    Suspect(
        "pulse_in",
        "pulseIn() loses counts",
        "timer",
        "The interrupt of millis() stops the counting loop of pulseIn() once in 1024 us.",
        {"DURATION()": "pulseIn(echoPin, HIGH)"},
        tables=4,
    ),
    Suspect(
        "print_9600",
        "printing while pulseIn() counts, 9,600 baud",
        "timer",
        "The bytes of a line that is still being sent interrupt pulseIn(), too.",
        {"DURATION()": "pulseIn(echoPin, HIGH)", **_PRINTS},
        tables=4,
    ),
    Suspect(
        "print_115200",
        "printing while pulseIn() counts, 115,200 baud",
        "timer",
        "The same at a baud rate at which the bytes follow each other fast.",
        {"DURATION()": "pulseIn(echoPin, HIGH)", "BAUD": "115200", **_PRINTS},
        tables=4,
    ),
    Suspect(
        "pulse_in_long",
        "pulseInLong()",
        "timer",
        "micros() at both edges, in steps of 4 us.",
        {"DURATION()": "pulseInLong(echoPin, HIGH)"},
    ),
    Suspect(
        "late_pulse_in",
        "pulseIn() begins after the rise",
        "timer",
        "pulseIn() waits until a pulse that it finds has ended, and then for the next one.",
        {"DURATION()": _CAME_LATE.format(us=495, call="pulseIn(echoPin, HIGH, 30000UL)")},
        tables=1,
        silence=450e-6,
    ),
    Suspect(
        "late_polling",
        "own loop begins after the rise",
        "timer",
        "A program that polls ECHO itself and comes too late reads short.",
        {"DURATION()": _CAME_LATE.format(us=495, call="polled()")},
        free=Free("lateness", "us", 0.0, 100.0, 45.0, "some calls of the Arduino core take 5 us each"),
        silence=450e-6,
    ),
    Suspect(
        "latency",
        "latency of the simulator",
        "module",
        "ECHO falls late. The study supposes it.",
        scene=scenes.late(50e-6, 50e-6),
        free=Free("latency", "us", 0.0, 200.0, 50.0, "a latency cannot be negative"),
    ),
    Suspect(
        "time_steps",
        "ECHO falls with the simulator's next step",
        "module",
        "A simulator that updates its pins in steps lengthens each echo by a part of a step.",
        scene=scenes.late(0.0, 100e-6),
        free=Free("step", "us", 0.0, 200.0, 100.0, "judgement: 5,000 updates a second, or more"),
        tables=_RANDOM_TABLES,
    ),
    Suspect(
        "module_factor",
        "module made for Tinkercad's own 0.01723 cm/us",
        "module",
        "The C++ of Tinkercad's blocks multiplies the time by 0.01723 cm/us; so the time may be the distance "
        "over that.",
        scene=scenes.module(2 * 172.3),
    ),
    Suspect(
        "module_58",
        "module made for 58 us/cm",
        "module",
        "The data sheet of the HC-SR04 divides by 58.",
        scene=scenes.module(2e4 / 58.0),
    ),
    Suspect(
        "module_speed",
        "module made for any other speed",
        "module",
        "The simulator uses a speed of sound of its own.",
        scene=scenes.module(345.0),
        free=Free("speed less 343 m/s", "m/s", -3.0, 3.0, 2.0, "speeds of sound in use, 340 to 346 m/s"),
    ),
    Suspect(
        "target",
        "target placed by mouse",
        "target",
        "The target is dragged once and is beside 2 m.",
        scene=scenes.placed(-10e-3),
        free=Free(
            "offset", "mm", -10.0, 10.0, -10.0, "judgement: a label that shows whole centimeters or less"
        ),
    ),
    Suspect(
        "divide_29_1",
        "divisor 29.1",
        "conversion",
        "(duration / 2) / 29.1 is common; it is 343.6 m/s.",
        {"CENTIMETERS(duration)": "((duration) / 2.0 / 29.1)"},
    ),
    Suspect(
        "divide_58",
        "divisor 58",
        "conversion",
        "duration / 58.0 is common; it is 344.8 m/s.",
        {"CENTIMETERS(duration)": "((duration) / 58.0)"},
    ),
    Suspect(
        "factor_034",
        "factor 0.034",
        "conversion",
        "duration * 0.034 / 2 is common; it is 340 m/s.",
        {"CENTIMETERS(duration)": "((duration) * 0.034 / 2)"},
    ),
    Suspect(
        "cut_cm",
        "pulseIn(), distance cut off to whole centimeters",
        "timer",
        "pulseIn() makes 198.8 cm of 2 m, and int or long makes 198 cm of that.",
        {
            "DURATION()": "pulseIn(echoPin, HIGH)",
            "CENTIMETERS(duration)": "((long)((duration) * 0.0343 / 2))",
        },
        cuts_off=True,
    ),
    Suspect(
        "whole_cm",
        "reading in whole centimeters",
        "record",
        "The reading is printed without decimals.",
        {"READING(centimeters)": "round(centimeters)"},
        cuts_off=True,
    ),
    Suspect(
        "halved_integer",
        "half of the time as an integer",
        "conversion",
        "duration / 2 in integers cuts off half a microsecond.",
        {"CENTIMETERS(duration)": "((duration) / 2 * 0.0343)"},
    ),
)
