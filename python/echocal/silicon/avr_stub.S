; One call of the generated function, at address 0: the simulator stops at `sleep`.
.section .vectors, "ax"
.global once
once:
    call DISTANCE
    sleep
