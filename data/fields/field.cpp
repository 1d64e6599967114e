#include "data/fields/field.h"

namespace jnd {

FieldCore::FieldCore(std::string_view name, std::string_view means, const FieldTraits& traits, bool is_number,
                     CellType of_value, const Getter* get)
    : key(name),
      column(traits.column.value_or(name)),
      title(traits.title.value_or(name)),
      meaning(means),
      unit(traits.unit),
      levels(traits.levels),
      number(is_number),
      digits(traits.digits),
      shown(traits.shown),
      factor(traits.factor),
      type(traits.type.value_or(of_value)),
      several(traits.several),
      reveals(traits.reveals),
      getter(get) {}
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
  };
  return std::visit(Cell{}, value);
}

}  // namespace jnd
