#include "runner/results/result_format.h"

#include <cmath>

namespace jnd {

std::string size_text(double value) {
  return number_text(value, decimals_of_size(std::abs(value)));
}

std::string_view unit_of(const Protocol& protocol) noexcept {
  return to_string(protocol.stimulus.unit);
}

const std::string& condition_text(const Protocol& protocol, int place) {
  return protocol.conditions[static_cast<std::size_t>(place)].name;
}

std::string condition_title(const Condition& condition) {
  return condition.label.empty() || condition.label == condition.name ? condition.name
                                                                      : condition.name + ": " + condition.label;
}

}  // namespace jnd
