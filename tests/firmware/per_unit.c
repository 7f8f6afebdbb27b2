/* Calls the functions of echocal_unit.h for lines of stdin: a letter, then numbers. */
#include "echocal_unit.h"
#include <inttypes.h>
#include <stdio.h>

static void show(const uint8_t *block)
{
    for (unsigned place = 0; place < ECHOCAL_UNIT_BLOCK_BYTES; place++) {
        printf("%02x", block[place]);
    }
    printf("\n");
}

static int get(uint8_t *block)
{
    for (unsigned place = 0; place < ECHOCAL_UNIT_BLOCK_BYTES; place++) {
        unsigned byte;
        if (scanf("%2x", &byte) != 1) {
            return 0;
        }
        block[place] = (uint8_t)byte;
    }
    return 1;
}

int main(void)
{
    uint8_t block[ECHOCAL_UNIT_BLOCK_BYTES];
    echocal_unit unit;
    char what;
    while (scanf(" %c", &what) == 1) {
        if (what == 'l' && get(block)) { /* load: the status */
            printf("%d\n", echocal_unit_load(&unit, block));
        } else if (what == 'd') { /* distances and statuses of all 65536 echo codes at a temperature, summed in a hash */
            int code;
            uint64_t hash = 0;
            if (scanf("%d", &code) != 1) {
                return 1;
            }
            for (uint32_t echo = 0; echo < 65536U; echo++) {
                const int32_t distance = echocal_unit_distance_um((uint16_t)echo, (int16_t)code, &unit);
                const uint8_t status = echocal_unit_status((uint16_t)echo, (int16_t)code, &unit);
                hash = hash * 40503U + (uint32_t)distance + status;
            }
            printf("%016" PRIx64 "\n", hash);
        } else if (what == 'w') { /* write */
            unsigned long number;
            int delay;
            int rate;
            if (scanf("%lu %d %d", &number, &delay, &rate) != 3) {
                return 1;
            }
            echocal_unit_write(block, (uint32_t)number, (int16_t)delay, (int16_t)rate);
            show(block);
        } else if (what == 'r' && get(block)) { /* recalibrate: status and block */
            echocal_unit_point points[2];
            int many = 0;
            if (scanf("%d", &many) != 1) {
                return 1;
            }
            for (int point = 0; point < many && point < 2; point++) {
                long distance;
                unsigned long echo;
                int code;
                if (scanf("%ld %lu %d", &distance, &echo, &code) != 3) {
                    return 1;
                }
                points[point].distance = (int32_t)distance;
                points[point].echo_sum = (uint32_t)echo;
                points[point].temperature_code = (int16_t)code;
            }
#ifdef BOTH
            printf("%d ", echocal_unit_recalibrate(block, (many > 0) ? points : NULL, (uint8_t)many));
#else
            printf("%d ", echocal_unit_recalibrate(block, &points[0]));
#endif
            show(block);
        } else {
            return 1;
        }
    }
    return 0;
}
