/*
 * A simulated UNO with a virtual HC-SR04: TRIG is watched on pin 7, ECHO answered on pin 8.
 *
 *     uno SKETCH.elf MILLIVOLTS_A0 MILLIVOLTS_A1 ECHO_US...
 *
 * Each trigger pulse of at least 10 us gets the next echo, 0 for none at all; while an echo lasts a trigger is not heard.
 * Prints what the sketch sends over its serial port, until it has answered the last. The simulator is GPL-3: a companion of the tests, never part of what is shipped.
 */
#include <simavr/avr_adc.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <simavr/sim_time.h>
#include <stdio.h>
#include <stdlib.h>

enum { SILENCE_US = 450, PULSE_US = 10, LINE_US = 30000, GIVEN_UP_US = 90000, PATIENCE = 160 /* cycles run at once: all calls far between */ };

static avr_t *avr;
static avr_irq_t *echo;
static char **lengths;
static int left, sounding;
static avr_cycle_count_t triggered, finish;

static avr_cycle_count_t fall(avr_t *chip, avr_cycle_count_t when, void *unused)
{
    (void)chip, (void)unused;
    avr_raise_irq(echo, 0);
    sounding = 0;
    if (left == 0) {
        finish = when + avr_usec_to_cycles(avr, LINE_US);
    }
    return 0;
}

static avr_cycle_count_t rise(avr_t *chip, avr_cycle_count_t when, void *unused)
{
    (void)unused;
    const uint32_t length = (uint32_t)atoi(*lengths++);
    left--;
    if (length > 0) {
        avr_raise_irq(echo, 1);
        sounding = 1;
        /* From this edge on, to the cycle. */
        avr_cycle_timer_register(chip, avr_usec_to_cycles(avr, length) - (chip->cycle - when), fall, NULL);
    } else if (left == 0) {
        finish = when + avr_usec_to_cycles(avr, GIVEN_UP_US);
    }
    return 0;
}

static void trigger(avr_irq_t *irq, uint32_t value, void *unused)
{
    (void)irq, (void)unused;
    if (value) {
        triggered = avr->cycle;
    } else if (left > 0 && !sounding && avr->cycle - triggered >= avr_usec_to_cycles(avr, PULSE_US)) {
        avr_cycle_timer_register_usec(avr, SILENCE_US, rise, NULL);
    }
}

static void spoken(avr_irq_t *irq, uint32_t value, void *unused)
{
    (void)irq, (void)unused;
    putchar((int)value);
}

int main(int count, char **words)
{
    elf_firmware_t sketch = {0};
    if (count < 4 || elf_read_firmware(words[1], &sketch) != 0 || !(avr = avr_make_mcu_by_name("atmega328p"))) {
        return 1;
    }
    avr_init(avr);
    avr->frequency = 16000000;
    avr->vcc = avr->avcc = avr->aref = 5000;
    avr_load_firmware(avr, &sketch);
    avr->log = LOG_NONE;
    avr->run_cycle_limit = PATIENCE;
    lengths = words + 4;
    left = count - 4;
    finish = left == 0 ? avr_usec_to_cycles(avr, LINE_US) : 0;
    uint32_t flags = 0;
    avr_ioctl(avr, AVR_IOCTL_UART_GET_FLAGS('0'), &flags);
    flags &= ~(uint32_t)AVR_UART_FLAG_STDIO;
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    echo = avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('B'), 0);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('D'), 7), trigger, NULL);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), spoken, NULL);
    for (int pin = 0; pin < 2; pin++) {
        avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_ADC_GETIRQ, ADC_IRQ_ADC0 + pin), (uint32_t)atoi(words[2 + pin]));
    }
    while (finish == 0 || avr->cycle < finish) {
        const int state = avr_run(avr);
        if (state == cpu_Done || state == cpu_Crashed) {
            return 1;
        }
    }
    return 0;
}
