#include "data/verify/verify_fields.h"

#include <array>

#include <fmt/format.h>

#include "analysis/numerics/words.h"
#include "data/log/body_numbers.h"
#include "data/log/event_body.h"
#include "data/log/storage_error.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

enum class Type { text, whole, number, flag };

struct Field {
  std::string_view event, key;
  Type type;
  bool needed = false;  // otherwise it may be absent, or null
};

constexpr std::array kFields = {Field{event_kind::kNote, "text", Type::text, true},
                                Field{event_kind::kNote, "by", Type::text},
                                Field{event_kind::kNote, "participant", Type::text},
                                Field{event_kind::kNote, "after_trial", Type::whole},
                                Field{event_kind::kPaused, "cause", Type::text},
                                Field{event_kind::kPaused, "reason", Type::text},
                                Field{event_kind::kPaused, "after_trial", Type::whole},
                                Field{event_kind::kSessionOpened, "group", Type::text},
                                Field{event_kind::kContinued, "paused_s", Type::number},
                                Field{event_kind::kLeft, "cause", Type::text},
                                Field{event_kind::kLeft, "reason", Type::text},
                                Field{event_kind::kLeft, "for_good", Type::flag},
                                Field{event_kind::kSessionUnblinded, "shown", Type::text, true},
                                Field{event_kind::kSessionResumed, "cause", Type::text},
                                Field{event_kind::kSessionResumed, "reason", Type::text},
                                Field{event_kind::kSessionResumed, "gap_s", Type::number},
                                Field{event_kind::kSessionResumed, "practice_again", Type::flag},
                                Field{event_kind::kSessionResumed, "boot_id", Type::text},
                                Field{event_kind::kBlockEnded, "reason", Type::text},
                                Field{event_kind::kBlockEnded, "practice", Type::flag},
                                Field{event_kind::kStopCleared, "reason", Type::text},
                                Field{event_kind::kChecklist, "question", Type::text},
                                Field{event_kind::kChecklist, "text", Type::text},
                                Field{event_kind::kChecklist, "answer", Type::text},
                                Field{event_kind::kConsent, "language", Type::text},
                                Field{event_kind::kConsent, "by", Type::text},
                                Field{event_kind::kConsent, "refused", Type::flag},
                                Field{event_kind::kInstructed, "id", Type::text, true},
                                Field{event_kind::kQuestionAnswered, "question", Type::text, true},
                                Field{event_kind::kQuestionAnswered, "after_trial", Type::whole, true},
                                Field{event_kind::kQuestionAnswered, "text", Type::text},
                                Field{event_kind::kQuestionAnswered, "when", Type::text},
                                Field{event_kind::kQuestionAnswered, "condition", Type::text},
                                Field{event_kind::kQuestionAnswered, "answer", Type::text},
                                Field{event_kind::kBreakTaken, "after_trial", Type::whole, true},
                                Field{event_kind::kBreakTaken, "duration_s", Type::number},
                                Field{event_kind::kExcluded, "reason", Type::text, true},
                                Field{event_kind::kExcluded, "replace", Type::flag, true},
                                Field{event_kind::kUnblinded, "reason", Type::text, true}};

bool is_whole(const Json& value) {
  try {
    whole(value);
    return true;
  } catch (const Json::exception&) {
    return false;
  }
}

bool fits(Type type, const Json& value) {
  switch (type) {
    case Type::text:
      return value.is_string();
    case Type::whole:
      return is_whole(value);
    case Type::number:
      return value.is_number();
    case Type::flag:
      return value.is_boolean();
  }
  return false;
}

constexpr std::string_view name_of(Type type) noexcept {
  constexpr auto kWords = words<Type>({{"text", Type::text},
                                       {"a whole number", Type::whole},
                                       {"a number", Type::number},
                                       {"true or false", Type::flag}});
  return word_of(kWords, type);
}

}  // namespace

void check_fields(std::string_view kind, const Json& body) {
  if (!body.is_object()) throw StorageError("the body is no object");
  for (const Field& field : kFields) {
    if (field.event != kind) continue;
    const auto found = body.find(field.key);
    const bool absent = found == body.end() || (found->is_null() && !field.needed);
    if (absent && field.needed) throw StorageError(fmt::format("has no \"{}\"", field.key));
    if (!absent && !fits(field.type, *found))
      throw StorageError(fmt::format("\"{}\" is not {}", field.key, name_of(field.type)));
  }
}

}  // namespace jnd
