// A number or word of the results, said once: what it is called, what it means and where it comes from. JSON, the columns
// of CSV files, their dictionary and the tables for people are all written from it (block.h), so that none of them can say
// anything else than the others.
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

// Nothing: null in JSON, empty elsewhere. A double may be NaN (undefined) or infinite. Several numbers are a list in JSON, and
// stand in one cell elsewhere, separated by blanks.
using FieldValue = std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<double>>;

template <typename T>
FieldValue field_value(const T& value) {
  if constexpr (std::is_same_v<T, bool> || std::is_floating_point_v<T> || std::is_same_v<T, FieldValue> ||
                std::is_same_v<T, std::vector<double>>)
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
  else if constexpr (std::is_enum_v<T> || std::is_same_v<T, FieldValue> || std::is_same_v<T, std::vector<double>> ||
                     std::is_convertible_v<T, std::string_view>)
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

// How a table shows a number: with how many digits follows from its size and its interval (number_text.h); given: all that it
// was given with, as a level.
enum class Shown { number, given, percent, p_value };

// Where a field stands: in files and JSON, or in tables for people alone, as what is told there in other words.
enum class Place { everywhere, table };

// What need not be said of every field. Its texts are read while the field is made, so temporary ones may be given there.
struct FieldTraits {
  std::string_view unit{};
  std::string_view levels{};                // of texts and flags: the values that occur, separated by blanks
  std::optional<std::string_view> title{};  // above a column of a table, where it is not the key
  Shown shown = Shown::number;
  double factor = 1;  // of the number in a table: slopes are read per 100 N/m
  double limit = 0;   // of the number: what lies beyond is nothing but "> limit_text"; 0: none
  std::string_view limit_text{};
  Place place = Place::everywhere;
  // Of files: the type of the cells, where the value's own does not tell; whether a cell may hold several levels; what the
  // column tells of a blinded study.
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

  // row: of the type that the field was made for.
  FieldValue of(const void* row) const { return getter->of(row); }

  std::string key;  // dots lead into objects of JSON; a column has "_" in their place
  std::string column, title, meaning, unit, levels, limit_text;
  bool number;
  Shown shown;
  Place place;
  double factor, limit;
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

template <typename Row>
using Fields = std::vector<Field<Row>>;

std::string csv_value(const FieldValue& value);

template <typename Row>
std::vector<CsvColumn<Row>> csv_columns(const Fields<Row>& fields) {
  std::vector<CsvColumn<Row>> columns;
  for (const Field<Row>& field : fields)
    if (field.place == Place::everywhere)
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
