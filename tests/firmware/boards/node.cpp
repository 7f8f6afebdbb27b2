/*
 * The hardware below ESPHome's own code for its platform `host`: pins with two virtual HC-SR04, and the clock, which the
 * code asks the C library for. Everything else of the program is ESPHome's, and the component under test.
 *
 * Reads a line for each trigger pulse of a module: microseconds until the echo pulse begins, its length [us] (0: none), the
 * temperature [degC] and the humidity [%]. Prints what each sensor publishes: its letter, the distance [m], the status.
 */
#include "esphome.h"

#include <cstdio>
#include <sys/select.h>
#include <time.h>

using namespace esphome;

enum { PULSE_US = 10 /* of a trigger */ };

struct Line {
    long silence, length;
    float temperature, humidity;
};

struct Module {
    uint8_t trigger, echo;
    const char *sensor;
    int64_t triggered, rise = -1, fall = -1; /* [us] */
    bool level, heard_all;
    size_t heard;
    void (*handler)(void *);
    void *argument;

    /* When the level changes next; -1: never. */
    int64_t next() const { return rise >= 0 ? rise : fall; }
};

static Module modules[] = { { 4, 5, "Distance" }, { 12, 13, "Plain" } };
static std::vector<Line> lines;
static int64_t now = 1'000'000; /* [us] */
static bool interrupted;

static void edge(Module &module)
{
    int64_t &when = module.rise >= 0 ? module.rise : module.fall;
    now = when;
    when = -1;
    module.level = !module.level;
    interrupted = true;
    if (module.handler != nullptr) {
        module.handler(module.argument);
    }
    interrupted = false;
}

/* Let time pass. What an interrupt does takes none. */
static void advance(int64_t until)
{
    if (interrupted) {
        return;
    }
    for (;;) {
        Module *first = nullptr;
        for (Module &module : modules) {
            const int64_t when = module.next();
            if (when >= 0 && when <= until && (first == nullptr || when < first->next())) {
                first = &module;
            }
        }
        if (first == nullptr) {
            break;
        }
        edge(*first);
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

/* The next line of input; at the end of both modules the program ends. A module that sounds hears no trigger. */
static void listen(Module &module)
{
    if (module.level || module.rise >= 0) {
        return;
    }
    if (module.heard == lines.size()) {
        module.heard_all = true;
        if (modules[0].heard_all && modules[1].heard_all) {
            fflush(stdout);
            _exit(0);
        }
        return;
    }
    const Line &line = lines[module.heard++];
    if (&module == modules) {
        set("air_temperature", line.temperature);
        set("air_humidity", line.humidity);
    }
    if (line.length > 0) {
        module.rise = now + line.silence;
        module.fall = module.rise + line.length;
    }
}

static void write(uint8_t pin, bool value)
{
    for (Module &module : modules) {
        if (pin != module.trigger) {
            continue;
        }
        if (value) {
            module.triggered = now;
        } else if (module.triggered > 0 && now - module.triggered >= PULSE_US) {
            module.triggered = 0;
            listen(module);
        }
    }
}

static Module *behind(uint8_t pin)
{
    for (Module &module : modules) {
        if (pin == module.echo) {
            return &module;
        }
    }
    return nullptr;
}

static bool read(uint8_t pin)
{
    const Module *module = behind(pin);
    return module != nullptr && module->level;
}

static const char *status() { return App.get_text_sensors()[0]->state.c_str(); }

/* Print what the module's sensor publishes; once, before the first of them reads the lines. */
static void listen_to(const Module &module)
{
    if (lines.empty()) {
        Line line;
        while (scanf("%ld %ld %f %f", &line.silence, &line.length, &line.temperature, &line.humidity) == 4) {
            lines.push_back(line);
        }
    }
    find(module.sensor)->add_on_state_callback([&module](float distance) {
        if (!module.heard_all) {
            printf("%c %.9g %s\n", module.sensor[0], distance, &module == modules ? status() : "");
        }
    });
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
    if (const Module *module = behind(pin_)) {
        listen_to(*module);
    }
}
void HostGPIOPin::attach_interrupt(void (*function)(void *), void *with, gpio::InterruptType) const
{
    behind(pin_)->handler = function;
    behind(pin_)->argument = with;
}
void HostGPIOPin::detach_interrupt() const {}
bool HostGPIOPin::digital_read() { return read(pin_); }
void HostGPIOPin::digital_write(bool value) { write(pin_, value); }
size_t HostGPIOPin::dump_summary(char *buffer, size_t) const { return *buffer = 0; }
ISRInternalGPIOPin HostGPIOPin::to_isr() const { return ISRInternalGPIOPin((void *)(uintptr_t)pin_); }
} // namespace host

bool ISRInternalGPIOPin::digital_read() { return read((uint8_t)(uintptr_t)arg_); }
void ISRInternalGPIOPin::digital_write(bool value) { write((uint8_t)(uintptr_t)arg_, value); }
void ISRInternalGPIOPin::clear_interrupt() {}
InterruptLock::InterruptLock() {}
InterruptLock::~InterruptLock() {}
} // namespace esphome
