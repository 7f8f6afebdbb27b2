/* Vectors of a Cortex-M: the stack's top and the entry, all that runs before `board_main`. */
#include <stdint.h>

extern uint32_t stack_top[];
void board_main(void);

__attribute__((section(".vectors"), used)) static void *const vectors[] = { stack_top, (void *)board_main };
