#include "analysis/numerics/freed_memory.h"
#include "runner/command_line.h"

int main(int argc, char** argv) {
  jnd::keep_freed_memory();
  return jnd::run_command_line(argc, argv);
}
