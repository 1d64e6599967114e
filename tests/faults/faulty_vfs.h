// SQLite's access to files, with the faults of a FaultyDisk between SQLite and the real folder.
#pragma once

#include "tests/faults/faulty_disk.h"

namespace jnd::test {

// From now on every connection that names no VFS of its own works on FaultyDisk::of_the_program(): main files, their
// journals and write-ahead logs. The index of a write-ahead log (-shm) is passed through, since nothing in it has to
// survive. Syncs reach the model only, which makes them cheap.
FaultyDisk& use_faulty_disk();

}  // namespace jnd::test
