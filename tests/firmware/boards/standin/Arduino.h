/*
 * A stand-in for the Arduino core of a board with 32 bits, as far as the example needs one: its clock is of the same
 * kind as that board's, and a virtual HC-SR04 hangs at its pins. The board's own core it is not.
 *
 * Cortex-M, as STM32: milliseconds are counted in the interrupt of SysTick, and micros() adds what its counter shows.
 * RISC-V, as ESP32-C3 (ARDUINO_ARCH_ESP32): micros() reads a counter that needs no interrupt.
 * A timer of its own interrupts the processor at the edges of the echo, as the pin would.
 */
#ifndef ARDUINO_H
#define ARDUINO_H

#include <stdint.h>

enum { LOW, HIGH, INPUT = 0, OUTPUT = 1, CHANGE = 2, A0 = 14, A1 = 15, AVREF = 16 };
#define digitalPinToInterrupt(pin) (pin)
#define constrain(value, low, high) ((value) < (low) ? (low) : (value) > (high) ? (high) : (value))
#define abs(value) ((value) < 0 ? -(value) : (value))

#ifdef ARDUINO_ARCH_ESP32
inline void noInterrupts() {}
inline void interrupts() {}
#define IRAM_ATTR
uint32_t analogReadMilliVolts(uint8_t pin);
#else
inline void noInterrupts() { __asm__ volatile("cpsid i" ::: "memory"); }
inline void interrupts() { __asm__ volatile("cpsie i" ::: "memory"); }
int analogRead(uint8_t pin);
void analogReadResolution(int bits);
#endif
uint32_t micros();
void delay(uint32_t milliseconds);
void delayMicroseconds(uint32_t microseconds);
void pinMode(uint8_t pin, uint8_t mode);
void digitalWrite(uint8_t pin, uint8_t level);
int digitalRead(uint8_t pin);
void attachInterrupt(uint8_t pin, void (*handler)(), int mode);

struct Port {
    void begin(uint32_t) {}
    void print(char letter);
    void print(const char *text);
    void print(int32_t number);
    void print(uint16_t number) { print((int32_t)number); }
    void print(int16_t number) { print((int32_t)number); }
    void print(uint8_t number) { print((int32_t)number); }
    template <typename Thing> void println(Thing thing)
    {
        print(thing);
        print('\n');
    }
};
extern Port Serial;

#endif
