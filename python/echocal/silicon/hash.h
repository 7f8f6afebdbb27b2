/* The hash of outputs, as firmware_gen/src/hash.rs defines it: a polynomial in 40503, modulo 2^61 - 1. */
#include <stdint.h>

/* The hash with one more output, as the function's register holds it. */
static uint64_t append(uint64_t hash, uint32_t output)
{
    const uint64_t prime = UINT64_C(0x1FFFFFFFFFFFFFFF);
    const uint64_t low = (hash & 0xFFFFFFFFU) * 40503U, high = (hash >> 32) * 40503U; /* high * 2^32 is turned by 32 */
    const uint64_t sum = low + ((high & 0x1FFFFFFFU) << 32) + (high >> 29) + (output ^ 0x80000000U);
    const uint64_t next = (sum & prime) + (sum >> 61);
    return next < prime ? next : next - prime;
}
