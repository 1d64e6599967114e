#include "runner/command_line.h"
namespace jnd { int run_command_line(int, const char* const*) { return 2; } }
