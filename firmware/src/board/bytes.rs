//! Copying, moving, filling and comparing bytes in little code. The linker takes these functions
//! instead of Rust's, which are optimized for speed and take 3.5 kB of flash. Words of four bytes
//! are moved at any address, because the processor allows unaligned access. Word-aligned data are
//! copied eight words at a time: the core's records are some hundred bytes long.

core::arch::global_asm!(
    "
    .macro is name
        .global \\name
        .thumb_func
    \\name:
    .endm
    .syntax unified
    .thumb
    .section .text.bytes, \"ax\", %progbits

    @ (to, from, length), overlapping or not
    is memmove
    is __aeabi_memmove
    is __aeabi_memmove4
    is __aeabi_memmove8
        subs r3, r0, r1
        cmp r3, r2
        bhs memcpy
    1:  subs r2, #1
        itt hs
        ldrbhs r3, [r1, r2]
        strbhs r3, [r0, r2]
        bhs 1b
        bx lr

    @ (to, from, length), both on a word: eight words at a time, then by the bits of what is left
    is __aeabi_memcpy4
    is __aeabi_memcpy8
        push {{r4-r11}}
        subs r2, #32
        blo 2f
    1:  ldm r1!, {{r4-r11}}
        stm r0!, {{r4-r11}}
        subs r2, #32
        bhs 1b
    2:  lsls r3, r2, #28
        itt cs
        ldmcs r1!, {{r4-r7}}
        stmcs r0!, {{r4-r7}}
        itt mi
        ldmmi r1!, {{r4-r5}}
        stmmi r0!, {{r4-r5}}
        lsls r3, r2, #30
        itt cs
        ldrcs r3, [r1], #4
        strcs r3, [r0], #4
        itt mi
        ldrhmi r3, [r1], #2
        strhmi r3, [r0], #2
        lsls r3, r2, #31
        itt mi
        ldrbmi r3, [r1]
        strbmi r3, [r0]
        pop {{r4-r11}}
        bx lr

    @ (to, from, length)
    is memcpy
    is __aeabi_memcpy
        mov ip, r0
    1:  subs r2, #4
        itt hs
        ldrhs r3, [r1], #4
        strhs r3, [ip], #4
        bhs 1b
        adds r2, #4
    2:  subs r2, #1
        itt hs
        ldrbhs r3, [r1], #1
        strbhs r3, [ip], #1
        bhs 2b
        bx lr

    @ (to, length), on a word: six words at a time
    is __aeabi_memclr4
    is __aeabi_memclr8
        movs r2, #0
        movs r3, #0
        mov ip, r2
        subs r1, #24
        blo 2f
    1:  stm r0!, {{r2, r3, ip}}
        stm r0!, {{r2, r3, ip}}
        subs r1, #24
        bhs 1b
    2:  adds r1, #24
    @ (to, length)
    is __aeabi_memclr
        movs r2, #0
    @ (to, length, byte)
    is __aeabi_memset
    is __aeabi_memset4
    is __aeabi_memset8
        mov r3, r1
        mov r1, r2
        mov r2, r3
    @ (to, byte, length)
    is memset
        uxtb r1, r1
        orr r1, r1, r1, lsl #8
        orr r1, r1, r1, lsl #16
        mov ip, r0
        subs r2, #16
        blo 2f
    1:  str r1, [ip], #4
        str r1, [ip], #4
        str r1, [ip], #4
        str r1, [ip], #4
        subs r2, #16
        bhs 1b
    2:  lsls r3, r2, #29
        itt cs
        strcs r1, [ip], #4
        strcs r1, [ip], #4
        it mi
        strmi r1, [ip], #4
        lsls r3, r2, #31
        it cs
        strhcs r1, [ip], #2
        it mi
        strbmi r1, [ip]
        bx lr

    @ (one, other, length)
    is memcmp
    is bcmp
        mov ip, r0
    1:  subs r2, #1
        blo 2f
        ldrb r0, [ip], #1
        ldrb r3, [r1], #1
        subs r0, r3
        beq 1b
        bx lr
    2:  movs r0, #0
        bx lr

    .purgem is
    .text
"
);
