/*
 * The board behind Arduino.h under QEMU. ECHOES are the lengths [us] of the sensor's pulses, one after each trigger, 0
 * for none; MILLIVOLTS stand at each analog pin, one for each trigger, and the last from then on. SUPPLY is the supply [mV].
 * Ends when a trigger finds no length left. Speaks through semihosting.
 */
#include "Arduino.h"

void setup();
void loop();

enum { WRITEC = 0x03, EXIT = 0x18, SILENCE = 450 /* us from trigger to pulse */, PULSE = 10 /* us of a trigger */ };
static const uint32_t echoes[] = { ECHOES };
static const uint32_t volts[] = { MILLIVOLTS };
static uint32_t next, triggered, rise, length;
static bool pulled;
static void (*handler)();
Port Serial;

static uint32_t millivolts()
{
    const uint32_t last = sizeof volts / sizeof *volts;
    return volts[next == 0 ? 0 : (next > last ? last : next) - 1];
}

static void edge();

#ifdef __riscv
enum { TRIGGER_PIN = 4, ECHO_PIN = 5, PER_MICROSECOND = 10 };
static void host(uintptr_t operation, uintptr_t argument)
{
    register uintptr_t a0 __asm__("a0") = operation;
    register uintptr_t a1 __asm__("a1") = argument;
    __asm__ volatile(".balign 16\n.option push\n.option norvc\n"
                     "slli x0, x0, 0x1f\nebreak\nsrai x0, x0, 7\n.option pop"
                     : "+r"(a0) : "r"(a1) : "memory");
}

/* True time [us]: the timer of the machine, in hardware. */
static uint32_t now() { return *(volatile uint32_t *)0x0200BFF8 / PER_MICROSECOND; }
uint32_t micros() { return now(); }
uint32_t analogReadMilliVolts(uint8_t) { return millivolts(); }

static volatile uint32_t *const comparison = (volatile uint32_t *)0x02004000; /* mtimecmp */
static void interrupt_at(uint32_t time)
{
    comparison[1] = 0xFFFFFFFFU;
    comparison[0] = time * PER_MICROSECOND;
    comparison[1] = time == 0 ? 0xFFFFFFFFU : 0;
}
static __attribute__((interrupt("machine"), aligned(4))) void trap() { edge(); }
static void start()
{
    interrupt_at(0);
    __asm__ volatile(".option push\n.option arch, +zicsr\ncsrw mtvec, %0\ncsrs mie, %1\ncsrs mstatus, %2\n.option pop"
                     : : "r"(trap), "r"(1U << 7), "r"(1U << 3));
}
#else
enum { TRIGGER_PIN = 7, ECHO_PIN = 8 };
static void host(uintptr_t operation, uintptr_t argument)
{
    register uintptr_t r0 __asm__("r0") = operation;
    register uintptr_t r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

struct Tick { uint32_t control, reload, value; };
static volatile Tick &systick = *(volatile Tick *)0xE000E010;
static volatile uint32_t milliseconds; /* counted where interrupts are on, and nowhere else */
extern "C" void tick() { milliseconds = milliseconds + 1; }

uint32_t micros()
{
    uint32_t before, left;
    do {
        before = milliseconds;
        left = systick.value;
    } while (before != milliseconds);
    const uint32_t whole = systick.reload + 1;
    return before * 1000 + (whole - left) * 1000 / whole;
}

static int32_t steps = 1024;
void analogReadResolution(int bits) { steps = 1L << bits; }
int analogRead(uint8_t pin) { return (pin == AVREF ? 1210 : (int32_t)millivolts()) * steps / SUPPLY; }

static volatile uint32_t *const nvic = (volatile uint32_t *)0xE000E100;
static void enable(uint32_t interrupt)
{
    nvic[0xC0 + interrupt / 4] = 0xC0C0C0C0U; /* SysTick comes first */
    nvic[0] = 1U << interrupt;
}

/* True time [us]: a timer of its own, which no interrupt moves. */
#ifdef MICROBIT
static volatile uint32_t *const timer = (volatile uint32_t *)0x40008000; /* TIMER0 of an nRF51 */
static uint32_t now()
{
    timer[0x040 / 4] = 1; /* capture */
    return timer[0x540 / 4];
}
static void start_timer()
{
    timer[0x508 / 4] = 3; /* 32 bits */
    timer[0x510 / 4] = 4; /* 16 MHz / 2^4 */
    timer[0] = 1;
    enable(8);
}
static void interrupt_at(uint32_t time)
{
    timer[0x144 / 4] = 0; /* the event of its second comparison */
    timer[0x544 / 4] = time;
    timer[(time == 0 ? 0x308 : 0x304) / 4] = 1U << 17;
}
#else
static volatile uint32_t *const timer = (volatile uint32_t *)0x40000000; /* TIMER0 of an MPS2 board, counts down */
static uint32_t now() { return (0xFFFFFFFFU - timer[1]) / 25; }
static void start_timer()
{
    timer[2] = timer[1] = 0xFFFFFFFFU;
    timer[0] = 1;
    enable(9);
}
static volatile uint32_t *const alarm = (volatile uint32_t *)0x40001000; /* TIMER1, counts down to its interrupt */
static void interrupt_at(uint32_t time)
{
    alarm[0] = 0;
    alarm[3] = 1;
    if (time != 0) {
        const uint32_t ticks = 0xFFFFFFFFU - time * 25; /* when TIMER0 stands there */
        alarm[2] = alarm[1] = timer[1] - ticks;
        alarm[0] = 9;
    }
}
#endif

static void start()
{
    start_timer();
    systick.reload = CLOCK / 1000 - 1;
    systick.value = 0;
    systick.control = 7; /* on, with its interrupt, at the processor's clock */
}

extern "C" uint32_t stack_top[];
extern "C" void board_main();
static void stopped() { host(EXIT, 0x20023); }
typedef void (*Vector)();
extern "C" __attribute__((section(".vectors"), used)) const Vector vectors[26] = { (Vector)stack_top, board_main, stopped,
    stopped, stopped, stopped, stopped, nullptr, nullptr, nullptr, nullptr, stopped, nullptr, nullptr, stopped, tick, stopped, stopped, stopped,
    stopped, stopped, stopped, stopped, stopped, edge, edge };
#endif

static bool sounding() { return length > 0 && now() - rise < length && now() >= rise; }
int digitalRead(uint8_t pin) { return pin == ECHO_PIN && sounding() ? HIGH : LOW; }
void pinMode(uint8_t, uint8_t) {}
void attachInterrupt(uint8_t, void (*function)(), int) { handler = function; }

/* The interrupt at an edge; after the first the second is due. */
static void edge()
{
    const uint32_t fall = rise + length;
    interrupt_at((int32_t)(fall - now()) > 0 ? fall : 0);
    if (handler != nullptr) {
        handler();
    }
}

void delayMicroseconds(uint32_t microseconds)
{
    const uint32_t start = now();
    while (now() - start < microseconds) { }
}

void delay(uint32_t milliseconds) { delayMicroseconds(1000 * milliseconds); }

void digitalWrite(uint8_t pin, uint8_t level)
{
    if (pin != TRIGGER_PIN) {
        return;
    }
    if (level == HIGH) {
        triggered = now();
        pulled = true;
    } else if (pulled && now() - triggered >= PULSE && !sounding()) { /* while it sounds it hears no trigger */
        if (next == sizeof echoes / sizeof *echoes) {
            host(EXIT, 0x20026);
        }
        length = echoes[next++];
        rise = now() + SILENCE;
        interrupt_at(length > 0 ? rise : 0);
    }
}

void Port::print(char letter) { host(WRITEC, (uintptr_t)&letter); }

void Port::print(const char *text)
{
    while (*text != 0) {
        print(*text++);
    }
}

void Port::print(int32_t number)
{
    if (number < 0) {
        print('-');
    }
    uint32_t left = number < 0 ? 0U - (uint32_t)number : (uint32_t)number;
    char text[11];
    int place = sizeof text;
    text[--place] = 0;
    do {
        text[--place] = (char)('0' + left % 10);
        left /= 10;
    } while (left > 0);
    print(text + place);
}

extern "C" void board_main()
{
    start();
    setup();
    for (;;) {
        loop();
    }
}
