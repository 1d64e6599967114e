// What a program frees stays with it, for what it asks for next.
#pragma once

#include <malloc.h>

namespace jnd {

// By itself glibc gives memory back to the system whenever a little lies free at its end, and asks again a moment later;
// every page is then made and cleared anew, which of a power study of hierarchical fits was a tenth of the time. From
// here on up to 64 MiB stay. Source: mallopt(3).
inline void keep_freed_memory() noexcept {
  mallopt(M_TRIM_THRESHOLD, 64 << 20);
  mallopt(M_MMAP_THRESHOLD, 4 << 20);  // which no longer adapts once the other is set
}

}  // namespace jnd
