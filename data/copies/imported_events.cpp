#include "data/copies/imported_events.h"

#include "data/log/event_body.h"

namespace jnd {

bool is_imported(std::string_view kind) noexcept {
  return kind != event_kind::kStudyCreated && kind != event_kind::kSessionClosed;
}

}  // namespace jnd
