// The study could not be opened, read or written. The program exits with 5.
#pragma once

#include <stdexcept>

namespace jnd {

class StorageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace jnd
