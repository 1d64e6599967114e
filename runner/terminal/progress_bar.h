// Progress of long work on standard error: a bar on a terminal, a line at each tenth elsewhere.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace jnd {

// Thread rule: one thread.
class ProgressBar {
 public:
  ProgressBar(std::string what, std::int64_t total);
  ~ProgressBar();  // ends the line
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(std::int64_t done);

 private:
  std::string what_;
  std::int64_t total_;
  int shown_tenths_ = 0;
  bool terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace jnd
