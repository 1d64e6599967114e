// Bodies of events, as a damaged or forged study would have them: both readers of a trial and the replay accept them or
// say StorageError, and agree with each other.
#include <array>
#include <string>
#include <string_view>

#include "data/log/event_body.h"
#include "data/log/replay.h"
#include "data/log/storage_error.h"
#include "data/log/trial_body.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace jnd;

constexpr std::array kKinds = {event_kind::kSessionOpened,
                               event_kind::kTrialCompleted,
                               event_kind::kTrialVoided,
                               event_kind::kTrialsShort,
                               event_kind::kPracticeEnded,
                               event_kind::kBreakTaken,
                               event_kind::kQuestionAnswered,
                               event_kind::kDeviceFault,
                               event_kind::kTrialBegan,
                               event_kind::kBlockEnded,
                               event_kind::kPaused,
                               event_kind::kLeft,
                               event_kind::kNote,
                               event_kind::kChecklist,
                               event_kind::kSessionClosed,
                               event_kind::kSessionResumed,
                               event_kind::kExploration,
                               event_kind::kExplorationVoided,
                               event_kind::kInstructed,
                               event_kind::kConsent};

void replay_as(std::string_view kind, const std::string& body) {
  Event event;
  event.session = "s";
  event.seq = 1;
  event.kind = kind;
  event.body = body;
  try {
    replay({event});
  } catch (const StorageError&) {
  }
}

void read_trial(const std::string& body) {
  const auto json = nlohmann::ordered_json::parse(body, nullptr, false);
  if (json.is_discarded()) return;
  try {
    const TrialRecord record = trial_record_from(json);
    const std::string text = body_text(to_body(record));
    const TrialRecord again = trial_record_from(nlohmann::ordered_json::parse(text));
    fuzz::require(again.trial == record.trial && again.attempt == record.attempt, "a trial reads back as it was");
  } catch (const StorageError&) {
  } catch (const nlohmann::json::exception&) {
  }
}

}  // namespace

// The first byte chooses the kind of event.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string body(fuzz::text_of(data + 1, size - 1));
  replay_as(kKinds[data[0] % kKinds.size()], body);
  read_trial(body);
  TrialBodyReader reader(Unit::n_per_m);
  try {
    reader.read(body);
  } catch (const StorageError&) {
  }
  return 0;
}
