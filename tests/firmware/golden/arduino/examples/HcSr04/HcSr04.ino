/*
 * Reads an HC-SR04 and prints the corrected distance.
 *
 * Wiring: TRIG to pin 7, ECHO to pin 8 (on an UNO or Nano this is ICP1, the input capture pin of Timer1; on a Leonardo
 * ICP1 is pin 4; on an ESP32 TRIG to GPIO4, ECHO to GPIO5), a TMP36 thermometer to A0.
 * The module's ECHO output is 5 V. An input for 3.3 V, such as those of an ESP32, needs a voltage divider.
 *
 * How the sketch measures the echo time:
 * - ATmega328P, ATmega168, ATmega32U4: the input capture of Timer1 records each edge in hardware. Resolution: 0.5 us at
 *   16 MHz. Interrupts do not affect it.
 * - Other AVR boards, and all AVR boards with ECHOCAL_NO_INPUT_CAPTURE: pulseIn() counts the passes of a loop. The
 *   sketch disables interrupts during this count, for up to 50 ms if there is no echo. With interrupts enabled, the
 *   interrupt of millis() delays the loop, and the reading is about 0.6 % short: 12 mm at 2 m. While interrupts are
 *   disabled, millis() loses time, and the USB port of an ATmega32U4 does not respond.
 * - Other boards: micros() at each edge, with interrupts enabled. micros() needs them: an STM32 counts milliseconds in an
 *   interrupt. An edge that occurs during an interrupt is recorded late, by the duration of that interrupt.
 *
 * The first two methods were tested on a simulated ATmega328P. The third was tested on simulated cores (Cortex-M0, M3, M4
 * and RV32), with a replacement for the board's library. It was not tested on a real STM32 or ESP32.
 *
 * Output, one line for each measurement: the codes and the distance [um], or why there is none: see REASONS.
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
static const uint8_t ECHO_PIN = 8; /* ICP1 of an UNO */
#endif
/* Longest wait [us]: the longest accepted echo time, and 25 ms, in which the pulse must begin. */
static const uint32_t ECHO_TIMEOUT = 50073UL;
#if defined(__AVR__)
static const int32_t SUPPLY = 5000; /* reference voltage of the converter [mV]; 3300 on an AVR board with 3.3 V */
#else
static const int32_t SUPPLY = 3300; /* reference voltage of the converter [mV] */
#endif

/* Define ECHOCAL_NO_INPUT_CAPTURE if other code uses Timer1. */
#if !defined(ECHOCAL_NO_INPUT_CAPTURE) \
    && (defined(__AVR_ATmega328P__) || defined(__AVR_ATmega168__) || defined(__AVR_ATmega32U4__))
/* Duration of timer ticks [ns]. Timer1 runs at 1/8 of the processor's clock. */
static uint32_t nanoseconds(uint32_t ticks)
{
    return (uint32_t)(ticks * 8000000000ULL / F_CPU);
}

/* Wait for an edge at the capture pin. ticks: time of the edge. Returns false after ECHO_TIMEOUT. */
static bool edge(uint8_t rising, uint32_t since, uint16_t &ticks)
{
    TCCR1B = rising | _BV(CS11);
    TIFR1 = _BV(ICF1); /* selecting another edge can set the flag: clear it */
    while ((TIFR1 & _BV(ICF1)) == 0) {
        if (micros() - since > ECHO_TIMEOUT) {
            return false;
        }
    }
    ticks = ICR1;
    return true;
}

/* Measure the length of the echo pulse [ns]. Returns false if there was no pulse. */
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
    /* The timer overflows every 65536 ticks. micros() is coarser, and gives the number of overflows. */
    const uint32_t about = (micros() - risen) * (F_CPU / 8000UL) / 1000UL;
    uint32_t ticks = (uint16_t)(fall - rise);
    while (ticks + 32768UL < about) {
        ticks += 65536UL;
    }
    length = nanoseconds(ticks);
    return true;
}
#elif defined(__AVR__)
/* Measure the length of the echo pulse [ns]. Returns false if there was no pulse. */
static bool echo_pulse(uint32_t &length)
{
    noInterrupts();
    length = 1000UL * pulseIn(ECHO_PIN, HIGH, ECHO_TIMEOUT);
    interrupts();
    return length != 0;
}
#else
/* Wait until the echo pin has this level. Returns false after ECHO_TIMEOUT. */
static bool reaches(uint8_t level, uint32_t since)
{
    while (digitalRead(ECHO_PIN) != level) {
        if (micros() - since > ECHO_TIMEOUT) {
            return false;
        }
    }
    return true;
}

/* Measure the length of the echo pulse [ns]. Returns false if there was no pulse. Interrupts stay enabled for micros(). */
static bool echo_pulse(uint32_t &length)
{
    const uint32_t start = micros();
    /* Wait for a low level first: a pulse that is still high belongs to an earlier measurement or to its time-out. */
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

/* Measure the echo time: time_of_flight = echo_us * 0.000001 s. Returns false if there was no echo. */
static bool read_echo_code(uint16_t &echo_us)
{
    const uint64_t lsb = 1000000ULL; /* [ps] */
    uint32_t length = 0;
    digitalWrite(TRIGGER_PIN, HIGH);
    delayMicroseconds(10);
    digitalWrite(TRIGGER_PIN, LOW);
    const bool received = echo_pulse(length);
    const uint64_t code = (1000ULL * length + lsb / 2) / lsb;
    echo_us = (uint16_t)code;
    return received && code <= 65535ULL;
}

/* Voltage at an analog pin [mV]. */
static int32_t millivolts(uint8_t pin)
{
#if defined(ARDUINO_ARCH_ESP32)
    return (int32_t)analogReadMilliVolts(pin);
#else
    return ((2L * analogRead(pin) + 1) * SUPPLY + 1024) / 2048; /* the middle of the converter's step */
#endif
}

/* Temperature code of a TMP36: 500 mV at 0 degC, 10 mV/degC. Replace this function to use another thermometer.
 * temperature = temperature_code * 0.5 degC. */
static int16_t read_temperature_code()
{
    const int32_t lsb = 500000; /* [1e-6 degC] */
    const int32_t offset = (millivolts(A0) - 500) * 100000 - (0); /* from code 0 [1e-6 degC] */
    const int32_t code = (offset + (offset < 0 ? -abs(lsb) : abs(lsb)) / 2) / lsb;
    /* Without this limit a code too large for the type would wrap to another temperature. */
    return (int16_t)constrain(code, INT16_MIN, INT16_MAX);
}

/* By status. */
static const char *const REASONS[] = {
    "ok",
    "no echo",
    "too near",
    "too far",
    "temperature out of range",
    "humidity out of range"
};

void setup()
{
    Serial.begin(115200);
    pinMode(TRIGGER_PIN, OUTPUT);
    pinMode(ECHO_PIN, INPUT);
}

void loop()
{
    uint16_t echo_us;
    if (read_echo_code(echo_us)) {
        const int16_t temperature_code = read_temperature_code();
        const int32_t distance = echocal_distance_um(echo_us, temperature_code);
        Serial.print(echo_us);
        Serial.print(' ');
        Serial.print(temperature_code);
        Serial.print(' ');
        if (distance == ECHOCAL_OUT_OF_RANGE) {
            Serial.println(REASONS[echocal_status(echo_us, temperature_code)]);
        } else {
            Serial.println(distance);
        }
    } else {
        Serial.println("no echo");
    }
    delay(60); /* [ms], until the last echo has decayed */
}
