// The person beside a device that is calibrated: questions on standard error, answers by the line on standard input.
#pragma once

#include <optional>
#include <string>

#include "devices/hid/calibration/calibration_bench.h"

namespace jnd {

// Thread rule: one thread, the only one that reads standard input meanwhile.
class TypingOperator final : public CalibrationOperator {
 public:
  void ask(const std::string& question) override;
  std::optional<std::string> answer() override;
  void say(const std::string& text) override;

 private:
  std::string typed_;  // of the line that is not complete
};

}  // namespace jnd
