#include "data/session_log.h"

#include "data/event_body.h"

namespace jnd {

void MemoryLog::append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp) {
  Event event;
  event.seq = static_cast<std::int64_t>(events_.size()) + 1;
  event.kind = kind;
  event.stamp = stamp;
  event.body = body_text(body);
  events_.push_back(std::move(event));
}

}  // namespace jnd
