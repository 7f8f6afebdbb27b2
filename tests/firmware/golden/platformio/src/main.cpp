/**
 * @file main.cpp
 * @brief Reads an HC-SR04 and prints the corrected distance.
 *
 * Wiring: TRIG to pin 7, ECHO to pin 8 (on an UNO or Nano this is ICP1, the input capture pin of Timer1; on a Leonardo
 * ICP1 is pin 4; on an ESP32 TRIG to GPIO4, ECHO to GPIO5), a TMP36 thermometer to A0.
 * The module gives 5 V: an input that takes no more than 3.3 V, as those of an ESP32, needs a divider at ECHO.
 *
 * How the echo is timed, for each kind of board:
 * - Timer1 of an ATmega328P, 168 or 32U4 notes the time of an edge in hardware, to 0.5 us, whatever else the processor does.
 * - On other AVR boards, and with ECHOCAL_NO_INPUT_CAPTURE, pulseIn() counts the turns of a loop. The timer interrupt that
 *   keeps millis() steals turns: with interrupts on it reads about 0.6 % short, 12 mm at 2 m, and no correction of the air
 *   can know. So the sketch holds the interrupts while it counts, up to 60 ms where no echo comes: millis() loses that time,
 *   and the USB of an ATmega32U4 does not answer for as long. There, time the echo in hardware.
 * - Elsewhere micros() tells the time of each edge, with interrupts on. Its clock needs them: an STM32 counts milliseconds
 *   in an interrupt, and without it every echo would end up as 0. An edge that falls into an interrupt is told later.
 *
 * The first two were run on a simulated ATmega328P. The third was run on simulated cores (Cortex-M0, M3, M4 and RV32) with a
 * stand-in for the board's own library; on an STM32 and an ESP32 themselves it was not run.
 *
 * Every line of output: the codes, then the distance [um]; or "out of range", or "no echo".
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include <Arduino.h>

#include <echocal_correction.h>

#if defined(ARDUINO_ARCH_ESP32)
static const uint8_t TRIGGER_PIN = 4;
static const uint8_t ECHO_PIN = 5;
#elif defined(__AVR_ATmega32U4__) && !defined(ECHOCAL_NO_INPUT_CAPTURE)
static const uint8_t TRIGGER_PIN = 7;
static const uint8_t ECHO_PIN = 4; /* ICP1 */
#else
static const uint8_t TRIGGER_PIN = 7;
static const uint8_t ECHO_PIN = 8; /* of an UNO: ICP1 */
#endif
static const uint32_t PATIENCE = 60000UL; /* us */
#if defined(__AVR__)
static const int32_t SUPPLY = 5000; /* of the converter [mV]; an AVR board of 3.3 V: 3300 */
#else
static const int32_t SUPPLY = 3300;
#endif

/* Define ECHOCAL_NO_INPUT_CAPTURE where Timer1 serves something else. */
#if !defined(ECHOCAL_NO_INPUT_CAPTURE) \
    && (defined(__AVR_ATmega328P__) || defined(__AVR_ATmega168__) || defined(__AVR_ATmega32U4__))
/* Timer1 counts an eighth of the processor's clock. */
static uint32_t nanoseconds(uint32_t ticks)
{
    return (uint32_t)(ticks * 8000000000ULL / F_CPU);
}

/* Wait for an edge at the capture pin, and tell when it was, in ticks. */
static bool edge(uint8_t rising, uint32_t since, uint16_t &ticks)
{
    TCCR1B = rising | _BV(CS11);
    TIFR1 = _BV(ICF1); /* a change of the edge can set the flag */
    while ((TIFR1 & _BV(ICF1)) == 0) {
        if (micros() - since > PATIENCE) {
            return false;
        }
    }
    ticks = ICR1;
    return true;
}

/* Length of the echo pulse [ns]; false if there was none. */
static bool echo_pulse(uint32_t &length)
{
    uint16_t rise;
    uint16_t fall;
    const uint32_t start = micros();
    TCCR1A = 0;
    if (!edge(_BV(ICES1), start, rise)) {
        return false;
    }
    const uint32_t risen = micros();
    if (!edge(0, risen, fall)) {
        return false;
    }
    /* The timer starts again every 65536 ticks; how often it did, the coarser clock knows. */
    const uint32_t about = (micros() - risen) * (F_CPU / 8000UL) / 1000UL;
    uint32_t ticks = (uint16_t)(fall - rise);
    while (ticks + 32768UL < about) {
        ticks += 65536UL;
    }
    length = nanoseconds(ticks);
    return true;
}
#elif defined(__AVR__)
/* Length of the echo pulse [ns]; false if there was none. */
static bool echo_pulse(uint32_t &length)
{
    noInterrupts();
    length = 1000UL * pulseIn(ECHO_PIN, HIGH, PATIENCE);
    interrupts();
    return length != 0;
}
#else
/* Wait until the echo pin has a level; false if that takes too long. */
static bool reaches(uint8_t level, uint32_t since)
{
    while (digitalRead(ECHO_PIN) != level) {
        if (micros() - since > PATIENCE) {
            return false;
        }
    }
    return true;
}

/* Length of the echo pulse [ns]; false if there was none. Interrupts stay on: micros() needs them. */
static bool echo_pulse(uint32_t &length)
{
    const uint32_t start = micros();
    /* First low: a pulse that is still there is the rest of another, or of a time-out. */
    if (!reaches(LOW, start) || !reaches(HIGH, start)) {
        return false;
    }
    const uint32_t risen = micros();
    if (!reaches(LOW, risen)) {
        return false;
    }
    length = 1000UL * (micros() - risen);
    return true;
}
#endif

/* Time_of_flight = echo_us * 0.000001 s; false if there was no echo. */
static bool echo_time(uint16_t &echo_us)
{
    const uint32_t lsb = 1000; /* [ns] */
    uint32_t length = 0;
    digitalWrite(TRIGGER_PIN, HIGH);
    delayMicroseconds(10);
    digitalWrite(TRIGGER_PIN, LOW);
    const bool heard = echo_pulse(length);
    const uint32_t code = (length + lsb / 2) / lsb;
    echo_us = (uint16_t)code;
    return heard && code <= 65535UL;
}

static int32_t millivolts(uint8_t pin)
{
#if defined(ARDUINO_ARCH_ESP32)
    return (int32_t)analogReadMilliVolts(pin);
#else
    return analogRead(pin) * SUPPLY / 1024;
#endif
}

/* Of a TMP36: 500 mV at 0 degC, 10 mV for each degree. Put your thermometer here: temperature = temperature_code * 0.5 degC. */
static int16_t temperature_code()
{
    const int32_t lsb = 500000; /* 1e-6 degC */
    const int32_t above = (millivolts(A0) - 500) * 100000 - (0);
    const int32_t code = (above + (above < 0 ? -abs(lsb) : abs(lsb)) / 2) / lsb;
    /* What is too much for the type must not come out as another temperature. */
    return (int16_t)constrain(code, INT16_MIN, INT16_MAX);
}

void setup()
{
    Serial.begin(115200);
    pinMode(TRIGGER_PIN, OUTPUT);
    pinMode(ECHO_PIN, INPUT);
}

void loop()
{
    uint16_t echo_us;
    if (echo_time(echo_us)) {
        const int16_t warm = temperature_code();
        const int32_t distance = echocal_distance_um(echo_us, warm);
        Serial.print(echo_us);
        Serial.print(' ');
        Serial.print(warm);
        Serial.print(' ');
        if (distance == ECHOCAL_OUT_OF_RANGE) {
            Serial.println("out of range");
        } else {
            Serial.println(distance);
        }
    } else {
        Serial.println("no echo");
    }
    delay(60); /* for the last echo to die away */
}
