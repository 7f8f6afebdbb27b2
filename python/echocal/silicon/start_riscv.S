# Entry of a RISC-V machine without an operating system: a stack, then `board_main`.
.section .vectors, "ax"
.global _start
_start:
    la sp, stack_top
    call board_main
1:  j 1b
