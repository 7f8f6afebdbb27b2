/**
 * @file main.cpp
 * @brief Reads an HC-SR04 and prints the corrected distance.
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
 * - Other boards: an interrupt at each edge takes the time by micros(). An edge that occurs during another interrupt is
 *   recorded late, by the duration of that interrupt.
 *
 * The first two methods were tested on a simulated ATmega328P. The third was tested on simulated cores (Cortex-M0, M3, M4
 * and RV32), with a replacement for the board's library. It was not tested on a real STM32 or ESP32.
 *
 * How it measures the temperature: the mean of 16 samples, each taken for the middle of its step.
 * - AVR: the converter's reference is the chip's own, so that the supply does not matter and the steps are small. Chips
 *   differ by up to 10 %: while the sketch runs, measure the voltage at the pin AREF and write it to REFERENCE below.
 * - STM32: the sketch measures the converter's reference with the chip's calibrated one, where the chip has that.
 * - ESP32: the library's calibrated analogReadMilliVolts(). Other boards: measure the supply and write it to REFERENCE.
 *
 * Output, one line for each measurement: the codes and the distance [um], or why there is none: see REASONS.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include <Arduino.h>
#if defined(ARDUINO_ARCH_STM32)
#include <stm32yyxx_ll_adc.h>
#endif

#include <Echocal_7f8cc3f8.h>

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

/* Reference voltage of the converter [mV], its choice, and the number of its steps. */
#if defined(INTERNAL1V1)
static const int32_t REFERENCE = 1100;
static const uint8_t REFERENCE_CHOICE = INTERNAL1V1;
#elif defined(__AVR_ATmega32U4__)
static const int32_t REFERENCE = 2560;
static const uint8_t REFERENCE_CHOICE = INTERNAL;
#elif defined(__AVR__)
static const int32_t REFERENCE = 1100;
static const uint8_t REFERENCE_CHOICE = INTERNAL;
#else
static const int32_t REFERENCE = 3300;
#endif
#if defined(ARDUINO_ARCH_STM32) || defined(ARDUINO_ARCH_SAMD) || defined(ARDUINO_ARCH_RP2040)
#define ECHOCAL_12_BITS
static const int32_t STEPS = 4096;
#else
static const int32_t STEPS = 1024;
#endif
static const int32_t SAMPLES = 16;

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
#if !defined(IRAM_ATTR)
#define IRAM_ATTR /* where interrupts need no memory of their own */
#endif
enum Echo { IDLE, AWAITED, SOUNDING, ENDED };
static volatile uint8_t echo_state = IDLE;
static volatile uint32_t risen; /* times of the edges [us] */
static volatile uint32_t fallen;

/* Runs at each edge of the echo pin. */
static void IRAM_ATTR on_edge()
{
    const uint32_t now = micros();
    if (digitalRead(ECHO_PIN) == HIGH) {
        if (echo_state == AWAITED) {
            risen = now;
            echo_state = SOUNDING;
        }
    } else if (echo_state == SOUNDING) {
        fallen = now;
        echo_state = ENDED;
    }
}

/* Wait until the interrupt leaves this state. Returns false after ECHO_TIMEOUT. */
static bool leaves(uint8_t state, uint32_t since)
{
    while (echo_state == state) {
        if (micros() - since > ECHO_TIMEOUT) {
            echo_state = IDLE;
            return false;
        }
    }
    return true;
}

/* Measure the length of the echo pulse [ns]. Returns false if there was no pulse. A pulse that is high already belongs to
 * an earlier measurement or to its time-out: only a rising edge begins one. */
static bool echo_pulse(uint32_t &length)
{
    echo_state = AWAITED;
    if (!leaves(AWAITED, micros()) || !leaves(SOUNDING, risen)) {
        return false;
    }
    length = 1000UL * (fallen - risen);
    return true;
}
#define ECHOCAL_INTERRUPT
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

/* Sum of the samples at an analog pin [codes; on an ESP32 mV]. */
static int32_t sampled(uint8_t pin)
{
    int32_t sum = 0;
    for (uint8_t sample = 0; sample < SAMPLES; ++sample) {
#if defined(ARDUINO_ARCH_ESP32)
        sum += (int32_t)analogReadMilliVolts(pin);
#else
        sum += analogRead(pin);
#endif
    }
    return sum;
}

/* Reference voltage of the converter [mV]. */
#if !defined(ARDUINO_ARCH_ESP32)
static int32_t reference()
{
#if defined(__LL_ADC_CALC_VREFANALOG_VOLTAGE)
    return (int32_t)__LL_ADC_CALC_VREFANALOG_VOLTAGE(analogRead(AVREF), LL_ADC_RESOLUTION_12B);
#else
    return REFERENCE;
#endif
}
#endif

/* Temperature code of a TMP36: 500 mV at 0 degC, 10 mV/degC. Replace this function to use another thermometer.
 * temperature = temperature_code * 0.5 degC. */
static int16_t read_temperature_code()
{
    const int32_t lsb = 500000; /* [1e-6 degC] */
    const int32_t sum = sampled(A0);
#if defined(ARDUINO_ARCH_ESP32)
    const int32_t microvolts = sum * (1000L / 8) / (SAMPLES / 8);
#else
    if (sum == SAMPLES * (STEPS - 1)) {
        return INT16_MAX; /* hotter than the converter measures: not accepted */
    }
    const int32_t microvolts = (int32_t)((2LL * sum + SAMPLES) * 1000 * reference() / (2 * SAMPLES * STEPS));
#endif
    const int32_t offset = (microvolts - 500000) * 100 - (0); /* from code 0 [1e-6 degC] */
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
#if defined(ECHOCAL_INTERRUPT)
    attachInterrupt(digitalPinToInterrupt(ECHO_PIN), on_edge, CHANGE);
#endif
#if defined(__AVR__)
    analogReference(REFERENCE_CHOICE);
    analogRead(A0);
    delay(50); /* [ms], until the capacitor at AREF is discharged */
#elif defined(ECHOCAL_12_BITS)
    analogReadResolution(12);
#endif
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
