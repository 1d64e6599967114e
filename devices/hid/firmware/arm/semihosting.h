/* Words and an exit status through the debugger or the emulator: ARM's semihosting. */
#ifndef SEMIHOSTING_H
#define SEMIHOSTING_H

void semihosting_write(const char* text);
void semihosting_number(long value);
_Noreturn void semihosting_exit(int status);

/* The deepest that the stack has been, bytes. */
unsigned stack_used(void);

#endif
