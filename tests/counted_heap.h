// Counts every call of the heap at malloc itself, below operator new and Eigen: counted_heap.cpp replaces malloc and its
// kin in the test programs that it is linked into. The sanitizers replace them too. With a sanitizer or without glibc
// nothing is counted, and a test says SKIPPED.
#pragma once

#include <cstdint>

extern thread_local std::int64_t heap_calls;  // of this thread, since it began
extern const bool counts_heap_calls;
