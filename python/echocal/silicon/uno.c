/*
 * A simulated UNO with a virtual HC-SR04 and voltages at its analog pins:
 *
 *     uno SKETCH.elf TRIGGER_PIN ECHO_PIN REFERENCE_MILLIVOLTS EARLY PATIENCE_S SERIAL_ADDRESS < ROWS
 *
 * A row is a line of four numbers: silence before ECHO rises [us], length of ECHO [us], 0 for no pulse at all, and the
 * voltages at A0 and A1 [mV]. Each trigger pulse of at least 10 us takes the next row; while the module listens or ECHO
 * is high, no trigger is heard. Lengths are rounded to a cycle, 1/16 us. The voltages of a row are there from its
 * trigger on, or, with EARLY 1, from the end of the echo before it: some sketches read the thermometer first.
 *
 * Prints a line for each event, with the cycle in which it happens:
 *
 *     t CYCLE            a trigger is heard
 *     f CYCLE            ECHO falls
 *     c ROW PIN CODE CYCLE   the analog converter starts, for which row, and what it will give
 *     w CYCLE COUNT      bytes that the sketch has written to Serial so far, sent or waiting in its buffer
 *     l CYCLE FIRST LAST TEXT   a line that was sent: cycle and number of its first byte, number of its last
 *     a CYCLE            a trigger after the last row
 *     p PIN COUNT CYCLES pulses of another pin that could be a trigger, and the length of the longest
 *     s COUNT CYCLES     pulses of the trigger pin that are too short, and the length of the longest
 *     e CYCLE REASON     the end: done, silent (no trigger for PATIENCE_S), stopped (the chip sleeps for good)
 *
 * The simulator is GPL-3: it is used where it is installed, and is no part of what is shipped.
 */
#include <math.h>
#include <simavr/avr_adc.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <simavr/sim_time.h>
#include <stdio.h>
#include <stdlib.h>

enum { CLOCK = 16000000, PULSE_US = 10, LONG_PULSE_US = 1000, PINS = 20, CHANNELS = 2, LONGEST_LINE = 1000 };
enum { AT_ONCE = 160 /* cycles: events of the sketch are far between */, WATCH_US = 250, QUIET_US = 3000, DRAIN_US = 200000 };
enum { ADMUX = 0x7C, INTERNAL_MILLIVOLTS = 1100 };
/* Where HardwareSerial of the Arduino core 1.8 has _tx_buffer_head and _tx_buffer_tail, and the length of the buffer. */
enum { HEAD = 27, TAIL = 28, RING = 64 };

struct row {
    double silence, length, millivolts[CHANNELS];
};

static avr_t *avr;
static avr_irq_t *echo;
static struct row *rows;
static long count, heard, answered;
static int listening, early, trigger_pin;
static double reference;
static unsigned serial;
static avr_cycle_count_t last_event, asked_again, last_byte, begun;
static unsigned long sent, written, first_byte;
static char line[LONGEST_LINE + 1];
static int length_of_line;
static avr_cycle_count_t rose[PINS], longest[PINS], too_short;
static unsigned long pulses[PINS], short_pulses;

static unsigned long long now(void)
{
    return (unsigned long long)avr->cycle;
}

static avr_cycle_count_t cycles(double microseconds)
{
    return (avr_cycle_count_t)llround(microseconds * (CLOCK / 1e6));
}

static int waiting(void)
{
    return serial == 0 ? 0 : (avr->data[serial + HEAD] - avr->data[serial + TAIL]) & (RING - 1);
}

/* Called at every event that could be between two lines, and by the clock. */
static void note_written(void)
{
    const unsigned long total = sent + (unsigned long)waiting();
    if (total > written) {
        written = total;
        printf("w %llu %lu\n", now(), written);
    }
}

static avr_cycle_count_t watch(avr_t *chip, avr_cycle_count_t when, void *unused)
{
    (void)chip, (void)unused;
    note_written();
    return when + cycles(WATCH_US);
}

static avr_cycle_count_t fall(avr_t *chip, avr_cycle_count_t when, void *unused)
{
    (void)chip, (void)unused;
    note_written();
    avr_raise_irq(echo, 0);
    printf("f %llu\n", (unsigned long long)when);
    listening = 0;
    answered++;
    last_event = when;
    return 0;
}

static avr_cycle_count_t rise(avr_t *chip, avr_cycle_count_t when, void *unused)
{
    (void)unused;
    const double length = rows[heard - 1].length;
    last_event = when;
    if (length > 0.0) {
        avr_raise_irq(echo, 1);
        /* From this edge on, to the cycle. */
        avr_cycle_timer_register(chip, cycles(length) - (chip->cycle - when), fall, NULL);
    } else {
        listening = 0;
        answered++;
    }
    return 0;
}

static void pulse(avr_cycle_count_t length)
{
    if (length < cycles(PULSE_US)) {
        short_pulses++;
        too_short = length > too_short ? length : too_short;
    } else if (heard < count && !listening) {
        last_event = avr->cycle;
        listening = 1;
        note_written();
        printf("t %llu\n", now());
        fflush(stdout);
        avr_cycle_timer_register(avr, cycles(rows[heard++].silence), rise, NULL);
    } else if (heard == count && !listening && asked_again == 0) {
        asked_again = avr->cycle;
        note_written();
        printf("a %llu\n", now());
    }
}

static void pin_changed(avr_irq_t *irq, uint32_t value, void *which)
{
    (void)irq;
    const int pin = *(int *)which;
    if (value) {
        rose[pin] = avr->cycle;
    } else if (rose[pin] != 0) {
        const avr_cycle_count_t length = avr->cycle - rose[pin];
        rose[pin] = 0;
        if (pin == trigger_pin) {
            pulse(length);
        } else if (length < cycles(LONG_PULSE_US)) {
            pulses[pin]++;
            longest[pin] = length > longest[pin] ? length : longest[pin];
        }
    }
}

static avr_irq_t *pin_irq(int pin)
{
    const char port = pin < 8 ? 'D' : pin < 14 ? 'B' : 'C';
    return avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ(port), pin < 8 ? pin : pin < 14 ? pin - 8 : pin - 14);
}

/*
 * The code by the data sheet (ATmega328P, 24.7): 1024 Vin / Vref, rounded down. simavr multiplies whole millivolts by
 * 1023: it is given those from which it makes this code.
 */
static void converts(avr_irq_t *irq, uint32_t value, void *unused)
{
    (void)irq, (void)unused;
    union {
        avr_adc_mux_t mux;
        uint32_t word;
    } selected = {.word = value};
    const unsigned pin = selected.mux.src;
    if (selected.mux.kind != ADC_MUX_SINGLE || pin >= CHANNELS || count == 0) {
        return;
    }
    note_written();
    const long row = heard - 1 + (early && !listening);
    const double volts = rows[row < 0 ? 0 : row < count ? row : count - 1].millivolts[pin];
    const double top = (avr->data[ADMUX] >> 6) == 3 ? INTERNAL_MILLIVOLTS : reference;
    const double code = fmin(fmax(floor(volts * 1024.0 / top), 0.0), 1023.0);
    avr_irq_t *input = avr_io_getirq(avr, AVR_IOCTL_ADC_GETIRQ, (int)(ADC_IRQ_ADC0 + pin));
    avr_raise_irq(input, (uint32_t)ceil(code * round(top) / 1023.0)); /* its reference is in whole millivolts, too */
    printf("c %ld %u %d %llu\n", row, pin, (int)code, now());
}

static void end_line(void)
{
    line[length_of_line] = 0;
    printf("l %llu %lu %lu %s\n", (unsigned long long)begun, first_byte, sent, line);
    length_of_line = 0;
}

static void byte_sent(avr_irq_t *irq, uint32_t value, void *unused)
{
    (void)irq, (void)unused;
    last_byte = avr->cycle;
    if (value == '\n' || length_of_line == LONGEST_LINE) {
        end_line();
    } else if (value != '\r') {
        if (length_of_line == 0) {
            begun = avr->cycle;
            first_byte = sent;
        }
        line[length_of_line++] = (char)(value == 0 ? '?' : value);
    }
    sent++;
}

/* All rows are answered, the sketch has begun anew, and what it wrote has been sent. */
static int is_done(void)
{
    if (asked_again == 0 || avr->cycle < asked_again + cycles(QUIET_US)) {
        return 0;
    }
    const int quiet = waiting() == 0 && avr->cycle > last_byte + cycles(QUIET_US);
    return quiet || avr->cycle > asked_again + cycles(DRAIN_US);
}

/* A chip that sleeps costs no time here. */
static void sleep_at_once(avr_t *chip, avr_cycle_count_t how_long)
{
    (void)chip, (void)how_long;
}

static const char *run(double patience)
{
    const avr_cycle_count_t limit = cycles(patience * 1e6);
    for (;;) {
        const int state = avr_run(avr);
        if (state == cpu_Done || state == cpu_Crashed) {
            return "stopped";
        }
        if (is_done()) {
            return "done";
        }
        if (avr->cycle > last_event + limit) {
            return "silent";
        }
    }
}

static int read_rows(void)
{
    struct row row;
    long room = 0;
    while (scanf("%lf %lf %lf %lf", &row.silence, &row.length, &row.millivolts[0], &row.millivolts[1]) == 4) {
        if (count == room) {
            room = room ? 2 * room : 64;
            rows = realloc(rows, (size_t)room * sizeof row);
            if (rows == NULL) {
                return 0;
            }
        }
        rows[count++] = row;
    }
    return feof(stdin);
}

static void connect(int echo_pin)
{
    static int numbers[PINS];
    uint32_t flags = 0; /* neither print what is sent, nor sleep where the sketch polls */
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    echo = pin_irq(echo_pin);
    for (int pin = 0; pin < PINS; pin++) {
        numbers[pin] = pin;
        if (pin != echo_pin) {
            avr_irq_register_notify(pin_irq(pin), pin_changed, &numbers[pin]);
        }
    }
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), byte_sent, NULL);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_ADC_GETIRQ, ADC_IRQ_OUT_TRIGGER), converts, NULL);
    avr_cycle_timer_register_usec(avr, WATCH_US, watch, NULL);
}

int main(int words, char **word)
{
    elf_firmware_t sketch = {0};
    if (words != 8 || !read_rows() || elf_read_firmware(word[1], &sketch) != 0) {
        return 1;
    }
    if (!(avr = avr_make_mcu_by_name("atmega328p"))) {
        return 1;
    }
    trigger_pin = atoi(word[2]);
    reference = atof(word[4]);
    early = atoi(word[5]);
    serial = (unsigned)atoi(word[7]);
    avr_init(avr);
    avr->frequency = CLOCK;
    avr->vcc = avr->avcc = avr->aref = (uint32_t)lround(reference);
    avr_load_firmware(avr, &sketch);
    avr->log = LOG_NONE;
    avr->run_cycle_limit = AT_ONCE;
    avr->sleep = sleep_at_once;
    connect(atoi(word[3]));
    const char *reason = run(atof(word[6]));
    if (length_of_line > 0) {
        end_line();
    }
    for (int pin = 0; pin < PINS; pin++) {
        if (pulses[pin] > 0) {
            printf("p %d %lu %llu\n", pin, pulses[pin], (unsigned long long)longest[pin]);
        }
    }
    if (short_pulses > 0) {
        printf("s %lu %llu\n", short_pulses, (unsigned long long)too_short);
    }
    printf("e %llu %s\n", now(), reason);
    return 0;
}
