#include "runner/results/field_output.h"

#include <cmath>

#include <fmt/format.h>

#include "runner/terminal/json_output.h"

namespace jnd {

nlohmann::ordered_json json_value(const FieldValue& value) {
  using Json = nlohmann::ordered_json;
  struct Made {
    Json operator()(std::monostate) const { return nullptr; }
    Json operator()(bool flag) const { return flag; }
    Json operator()(std::int64_t number) const { return number; }
    Json operator()(double number) const { return json_number(number); }
    Json operator()(const std::string& text) const { return text; }
  };
  return std::visit(Made{}, value);
}

std::string value_text(const FieldValue& value, Shown shown, int digits, double factor) {
  const auto number = [&](double of) {
    switch (shown) {
      case Shown::percent:
        return percent_text(of);
      case Shown::p_value:
        return p_value_text(of);
      case Shown::compact:
        if (std::isfinite(of)) return fmt::format("{:.4g}", of);
        break;
      case Shown::number:
        break;
    }
    return number_text(factor * of, digits);
  };
  if (const auto* of = std::get_if<double>(&value)) return number(*of);
  if (const auto* of = std::get_if<std::string>(&value)) return *of;
  return csv_value(value);
}

void set_json(nlohmann::ordered_json& out, std::string_view key, nlohmann::ordered_json value) {
  nlohmann::ordered_json* place = &out;
  for (std::size_t dot; (dot = key.find('.')) != std::string_view::npos; key.remove_prefix(dot + 1))
    place = &(*place)[std::string(key.substr(0, dot))];
  (*place)[std::string(key)] = std::move(value);
}

}  // namespace jnd
