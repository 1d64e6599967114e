#include "protocols/condition_words.h"

#include <variant>

#include <fmt/format.h>

#include "protocols/random_stream.h"

namespace jnd {

std::vector<std::string> condition_codes(const Protocol& protocol, std::uint64_t seed) {
  std::vector<std::string> codes;
  for (std::size_t i = 0; i < protocol.conditions.size(); ++i)
    codes.emplace_back(1, static_cast<char>('A' + static_cast<int>(i)));
  RandomStream(seed, 0, "condition codes").shuffle(codes);
  return codes;
}

std::string parameter_text(const ParameterValue& value) {
  if (const double* number = std::get_if<double>(&value)) return fmt::format("{:g}", *number);
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  return std::get<std::string>(value);
}

std::string condition_words(const Condition& condition) {
  std::string parameters;
  for (const auto& [name, value] : condition.parameters)
    parameters += fmt::format("{}{} = {}", parameters.empty() ? "" : ", ", name, parameter_text(value));
  return parameters.empty() ? condition.label : fmt::format("{} ({})", condition.label, parameters);
}

}  // namespace jnd
