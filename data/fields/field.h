// A number or word of the results, said once: what it is called, what it means, how many digits it deserves and where
// it comes from. JSON, the columns of CSV files, their dictionary and the tables for people are all written from it, so
// that none of them can say anything else than the others.
//
// A block of results (cells, group, ...) is a list of fields in the order of its CSV columns; JSON and tables name the
// fields that they show, in their own order.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "data/fields/csv_writer.h"
#include "protocols/protocol.h"

namespace jnd {

// Nothing: null in JSON, empty elsewhere. A double may be NaN (undefined) or infinite.
using FieldValue = std::variant<std::monostate, bool, std::int64_t, double, std::string>;

template <typename T>
FieldValue field_value(const T& value) {
  if constexpr (std::is_same_v<T, bool> || std::is_floating_point_v<T> || std::is_same_v<T, FieldValue>)
    return value;
  else if constexpr (std::is_enum_v<T>)
    return std::string(to_string(value));
  else if constexpr (std::is_integral_v<T>)
    return static_cast<std::int64_t>(value);
  else if constexpr (std::is_convertible_v<T, std::string_view>)
    return std::string(std::string_view(value));
  else
    return value ? field_value(*value) : FieldValue();  // optional
}
// Of the cells that field_value makes of a T. A FieldValue may be anything: its fields say what it is.
template <typename T>
constexpr CellType cell_type() {
  if constexpr (std::is_same_v<T, bool>)
    return CellType::flag;
  else if constexpr (std::is_floating_point_v<T>)
    return CellType::number;
  else if constexpr (std::is_enum_v<T> || std::is_same_v<T, FieldValue> || std::is_convertible_v<T, std::string_view>)
    return CellType::text;
  else if constexpr (std::is_integral_v<T>)
    return CellType::integer;
  else
    return cell_type<typename T::value_type>();  // optional
}
template <typename T>
inline constexpr bool kIsNumber = std::is_arithmetic_v<T> && !std::is_same_v<T, bool>;
template <typename T>
inline constexpr bool kIsNumber<std::optional<T>> = kIsNumber<T>;

// What a member of a row, or a function of it, holds. std::invoke takes several times as long to compile.
template <typename Get, typename Row>
decltype(auto) read(const Get& get, const Row& row) {
  if constexpr (std::is_member_object_pointer_v<Get>)
    return (row.*get);
  else
    return get(row);
}

// How a table shows a number.
enum class Shown {
  number,   // with the field's digits
  percent,  // of a fraction
  p_value,
  compact  // four digits that count, for numbers of any size
};

// What need not be said of every field. Its texts are read while the field is made, so temporary ones may be given there.
struct FieldTraits {
  std::optional<std::string_view> column{};  // of CSV files, where it is not the key; "" where they leave the field out
  std::string_view unit{};
  std::string_view levels{};                // of texts and flags: the values that occur, separated by blanks
  std::optional<std::string_view> title{};  // above a column of a table, where it is not the key
  int digits = 3;                           // of numbers in a table
  Shown shown = Shown::number;
  double factor = 1;  // of the number in a table: slopes are read per 100 N/m
  // Of CSV files: the type of the cells, where the value's own does not tell; whether a cell may hold several levels;
  // what the column tells of a blinded study.
  std::optional<CellType> type{};
  bool several = false;
  Reveals reveals = Reveals::plan;
};

// A field without the type of its rows. Nothing of it is inline, as several hundred fields are made.
class FieldCore {
 public:
  FieldCore(const FieldCore& other);
  FieldCore(FieldCore&& other) noexcept;
  FieldCore& operator=(const FieldCore& other);
  FieldCore& operator=(FieldCore&& other) noexcept;
  ~FieldCore();

  std::string key;  // dots lead into objects of JSON
  std::string column, title, meaning, unit, levels;
  bool number;
  int digits;
  Shown shown;
  double factor;
  CellType type;
  bool several;
  Reveals reveals;

 protected:
  struct Getter {
    virtual ~Getter();
    virtual FieldValue of(const void* row) const = 0;
  };
  // Takes the getter over.
  FieldCore(std::string_view name, std::string_view means, const FieldTraits& traits, bool is_number, CellType of_value,
            const Getter* get);
  std::shared_ptr<const Getter> getter;
};

template <typename Row>
class Field : public FieldCore {
 public:
  // get: a member of the row, or a function of it.
  template <typename Get>
  Field(std::string_view name, std::string_view means, Get get, const FieldTraits& traits = {})
      : FieldCore(name, means, traits, kIsNumber<ValueOf<Get>>, cell_type<ValueOf<Get>>(), new GetterOf<Get>(get)) {}

  FieldValue of(const Row& row) const { return getter->of(&row); }

 private:
  template <typename Get>
  using ValueOf = std::remove_cvref_t<decltype(read(std::declval<const Get&>(), std::declval<const Row&>()))>;
  template <typename Get>
  struct GetterOf final : Getter {
    explicit GetterOf(Get from) : get(from) {}
    FieldValue of(const void* row) const override { return field_value(read(get, *static_cast<const Row*>(row))); }
    Get get;
  };
};

// What JSON and tables have and CSV files have not.
template <typename Row, typename Get>
Field<Row> beside(std::string_view key, Get get, FieldTraits traits = {}) {
  traits.column = "";
  return {key, "", get, traits};
}

template <typename Row>
using Fields = std::vector<Field<Row>>;

template <typename Row>
const Field<Row>& field_of(const Fields<Row>& fields, std::string_view key) {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const auto& field) { return field.key == key; });
  if (found == fields.end()) throw std::logic_error("there is no field " + std::string(key));
  return *found;
}

std::string csv_value(const FieldValue& value);

template <typename Row>
std::vector<CsvColumn<Row>> csv_columns(const Fields<Row>& fields) {
  std::vector<CsvColumn<Row>> columns;
  for (const Field<Row>& field : fields)
    if (!field.column.empty())
      columns.push_back({field.column, field.meaning, field.unit, field.levels,
                         [field](const Row& row) { return csv_value(field.of(row)); }, field.reveals, field.type,
                         field.several});
  return columns;
}

// Empty where the place is that of no condition, -1.
inline std::string condition_of(const Protocol& protocol, int place) {
  return place < 0 ? std::string() : protocol.conditions[static_cast<std::size_t>(place)].name;
}

}  // namespace jnd
