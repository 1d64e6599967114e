/* What a Cortex-M4F does before main: the vector table, the floating-point unit on, memory as C expects it. */
#include <stdint.h>
#include <string.h>

#include "semihosting.h"

int main(void);

extern uint32_t data_begin[], data_end[], data_source[], bss_begin[], bss_end[], stack_top[];
void reset(void);

/* The stack below here is painted, so that its deepest use can be seen. */
static const uint32_t paint = 0xC0FFEE42U;

static void fault(void) {
  semihosting_write("FAILED: a fault of the processor\n");
  semihosting_exit(2);
}

__attribute__((section(".vectors"), used)) static const uintptr_t vectors[16] = {
    (uintptr_t)stack_top, (uintptr_t)reset, (uintptr_t)fault, (uintptr_t)fault, (uintptr_t)fault, (uintptr_t)fault,
    (uintptr_t)fault,     (uintptr_t)fault, (uintptr_t)fault, (uintptr_t)fault, (uintptr_t)fault, (uintptr_t)fault,
    (uintptr_t)fault,     (uintptr_t)fault, (uintptr_t)fault, (uintptr_t)fault};

__attribute__((used, noreturn)) static void run(void) {
  memcpy(data_begin, data_source, (size_t)((uintptr_t)data_end - (uintptr_t)data_begin));
  memset(bss_begin, 0, (size_t)((uintptr_t)bss_end - (uintptr_t)bss_begin));
  const uintptr_t here = (uintptr_t)__builtin_frame_address(0);
  for (uint32_t* at = bss_end; (uintptr_t)at < here - 256; ++at) *at = paint;
  semihosting_exit(main());
}

/* Without a frame of its own: no instruction of the floating-point unit may come before it is on. */
__attribute__((naked)) void reset(void) {
  __asm__ volatile(
      "ldr r0, =0xE000ED88\n" /* CPACR: full access to coprocessors 10 and 11 */
      "ldr r1, [r0]\n"
      "orr r1, r1, #0xF00000\n"
      "str r1, [r0]\n"
      "dsb\n"
      "isb\n"
      "b run\n");
}

unsigned stack_used(void) {
  const uint32_t* at = bss_end;
  while (at < stack_top && *at == paint) ++at;
  return (unsigned)((uintptr_t)stack_top - (uintptr_t)at);
}
