#include "data/fields/field.h"

#include <cmath>

namespace jnd {

FieldCore::FieldCore(std::string_view name, std::string_view means, const FieldTraits& traits, bool is_number,
                     CellType of_value, const Getter* get)
    : key(name),
      column(name),
      title(traits.title.value_or(name)),
      meaning(means),
      unit(traits.unit),
      levels(traits.levels),
      limit_text(traits.limit_text),
      number(is_number),
      shown(traits.shown),
      place(traits.place),
      factor(traits.factor),
      limit(traits.limit),
      type(traits.type.value_or(of_value)),
      several(traits.several),
      reveals(traits.reveals),
      getter(get) {
  std::replace(column.begin(), column.end(), '.', '_');
}
FieldCore::FieldCore(const FieldCore& other) = default;
FieldCore::FieldCore(FieldCore&& other) noexcept = default;
FieldCore& FieldCore::operator=(const FieldCore& other) = default;
FieldCore& FieldCore::operator=(FieldCore&& other) noexcept = default;
FieldCore::~FieldCore() = default;
FieldCore::Getter::~Getter() = default;

std::string csv_value(const FieldValue& value) {
  struct Cell {
    std::string operator()(std::monostate) const { return {}; }
    std::string operator()(bool flag) const { return csv_flag(flag); }
    std::string operator()(std::int64_t number) const { return csv_number(number); }
    std::string operator()(double number) const { return csv_number(number); }
    std::string operator()(const std::string& text) const { return csv_text(text); }
    std::string operator()(const std::vector<double>& numbers) const {
      std::string text;
      for (const double number : numbers)
        text.append(text.empty() ? "" : " ").append(std::isnan(number) ? "NaN" : csv_number(number));
      return text;
    }
  };
  return std::visit(Cell{}, value);
}

}  // namespace jnd
