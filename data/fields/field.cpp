#include "data/fields/field.h"

namespace jnd {

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
