// The study could not be opened, read or written. The program exits with 5.
#pragma once

#include <stdexcept>

namespace jnd {

class StorageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The disk is full or failed just now: nothing was written, everything before is kept, and the same event may be tried
// again.
class StorageTrouble : public StorageError {
 public:
  using StorageError::StorageError;
};

// A study that is not what was recorded: no results are computed from it. The program exits with 1.
class BrokenChain : public StorageError {
 public:
  using StorageError::StorageError;
};

}  // namespace jnd
