/*
 * The hardware below ESPHome's own code for its platform `host`: two pins with a virtual HC-SR04, and the clock, which the
 * code asks the C library for. Everything else of the program is ESPHome's.
 *
 * Reads a line for each trigger pulse: microseconds until the echo pulse begins, its length [us] (0: none), the temperature
 * [degC] and the humidity [%]. Prints the published distance [m] of each.
 */
#include "esphome.h"

#include <cstdio>
#include <sys/select.h>
#include <time.h>

using namespace esphome;

enum { TRIGGER = 4, ECHO = 5, PULSE_US = 10 /* of a trigger */ };

static int64_t now = 1'000'000, triggered, rise = -1, fall = -1; /* [us] */
static bool interrupted, level;
static void (*handler)(void *);
static void *argument;

static void edge(int64_t &when, bool high)
{
    now = when;
    when = -1;
    level = high;
    interrupted = true;
    if (handler != nullptr) {
        handler(argument);
    }
    interrupted = false;
}

/* Let time pass. What an interrupt does takes none. */
static void advance(int64_t until)
{
    if (interrupted) {
        return;
    }
    while (rise >= 0 && rise <= until) {
        edge(rise, true);
    }
    while (rise < 0 && fall >= 0 && fall <= until) {
        edge(fall, false);
    }
    now = until;
}

static sensor::Sensor *find(const char *name)
{
    for (sensor::Sensor *one : App.get_sensors()) {
        if (one->get_name() == name) {
            return one;
        }
    }
    return nullptr;
}

static void set(const char *name, float value)
{
    if (sensor::Sensor *one = find(name)) {
        one->state = value;
    }
}

/* The next line of input; at its end the program ends. A module that sounds hears no trigger. */
static void listen()
{
    long silence, length;
    float temperature, humidity;
    if (level || rise >= 0) {
        return;
    }
    if (scanf("%ld %ld %f %f", &silence, &length, &temperature, &humidity) != 4) {
        fflush(stdout);
        _exit(0);
    }
    set("air_temperature", temperature);
    set("air_humidity", humidity);
    if (length > 0) {
        rise = now + silence;
        fall = rise + length;
    }
}

static void write(uint8_t pin, bool value)
{
    if (pin != TRIGGER) {
        return;
    }
    if (value) {
        triggered = now;
    } else if (triggered > 0 && now - triggered >= PULSE_US) {
        triggered = 0;
        listen();
    }
}

extern "C" int clock_gettime(clockid_t, struct timespec *told) noexcept
{
    advance(now + 1);
    told->tv_sec = now / 1'000'000;
    told->tv_nsec = now % 1'000'000 * 1000;
    return 0;
}

extern "C" int nanosleep(const struct timespec *time, struct timespec *)
{
    advance(now + time->tv_sec * 1'000'000 + time->tv_nsec / 1000);
    return 0;
}

extern "C" int select(int, fd_set *, fd_set *, fd_set *, struct timeval *time)
{
    advance(now + time->tv_sec * 1'000'000 + time->tv_usec);
    return 0;
}

namespace esphome {
namespace host {
void HostGPIOPin::pin_mode(gpio::Flags)
{
    if (pin_ == ECHO) {
        find("Distance")->add_on_state_callback([](float distance) { printf("%.9g\n", distance); });
    }
}
void HostGPIOPin::attach_interrupt(void (*function)(void *), void *with, gpio::InterruptType) const
{
    handler = function;
    argument = with;
}
void HostGPIOPin::detach_interrupt() const {}
bool HostGPIOPin::digital_read() { return pin_ == ECHO && level; }
void HostGPIOPin::digital_write(bool value) { write(pin_, value); }
size_t HostGPIOPin::dump_summary(char *buffer, size_t) const { return *buffer = 0; }
ISRInternalGPIOPin HostGPIOPin::to_isr() const { return ISRInternalGPIOPin((void *)(uintptr_t)pin_); }
} // namespace host

bool ISRInternalGPIOPin::digital_read() { return (uintptr_t)arg_ == ECHO && level; }
void ISRInternalGPIOPin::digital_write(bool value) { write((uint8_t)(uintptr_t)arg_, value); }
void ISRInternalGPIOPin::clear_interrupt() {}
InterruptLock::InterruptLock() {}
InterruptLock::~InterruptLock() {}
} // namespace esphome
