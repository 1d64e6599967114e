// The tables of an export that hold what was recorded: which columns each file has, what they mean, and where their
// cells come from.
#pragma once

#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "data/fields/csv_writer.h"
#include "data/study/study.h"
#include "data/study/study_admin.h"
#include "data/study/trial_rows.h"
#include "protocols/protocol.h"

namespace jnd {

// A device that the trials of a study report on: one a finger, or one on its pulp and one on its joint.
struct DevicePlace {
  int finger = 0;  // place in RigRequest::fingers
  Channel channel = Channel::cutaneous;
  bool operator==(const DevicePlace&) const = default;
  bool operator<(const DevicePlace& other) const noexcept {
    return std::tie(finger, channel) < std::tie(other.finger, other.channel);
  }
};

// As the first answered trial of each session has them, in the order of fingers, cutaneous first; where no trial was
// answered, one on every finger's pulp of a rig of ours, and none of another. Throws StorageError.
std::vector<DevicePlace> device_places(const Study& study, const Protocol& protocol,
                                       const std::vector<SessionInfo>& sessions);

// One answered trial, practice or main.
struct ExportTrial {
  SessionInfo session;
  std::int64_t seq = 0;
  std::string utc;
  TrialRecord record;
  std::string excluded_reason;  // empty where it counts
};

// One device in one interval of a trial; where the interval has no device, one row of the interval.
struct ExportInterval {
  const ExportTrial* trial = nullptr;
  int interval = 0;  // from 0
  const Presentation* presentation = nullptr;
  const FingerPresentation* finger = nullptr;  // null where the interval has no device
};

// An attempt at a trial that did not count.
struct ExportVoided {
  SessionInfo session;
  std::int64_t seq = 0;
  std::string utc;
  Trial trial;
  int attempt = 1;
  std::string series, condition, reason, words;
  bool answered = false;  // the answer was taken back
  bool uses_attempt = true;
};

struct ExportAnswer {
  SessionInfo session;
  std::string utc, question, text, asked, condition, answer;
  int after_trial = 0;
  bool answered = true;
};

// One participant of one kind of session.
struct ExportParticipant {
  SessionInfo first{};  // of their sessions
  int sessions = 0, closed = 0, trials_done = 0, trials_voided = 0;
  bool ended_early = false;
  std::string excluded_reason{};
};

std::vector<CsvColumn<ExportTrial>> trial_columns(const Protocol& protocol);
// places: where the devices are; empty where there is none to tell of.
std::vector<CsvColumn<ExportInterval>> interval_columns(const Protocol& protocol,
                                                        const std::vector<DevicePlace>& places);
// In the order of intervals and devices. `trial` must outlive them.
std::vector<ExportInterval> interval_rows(const ExportTrial& trial);
std::vector<CsvColumn<ExportVoided>> voided_columns(const Protocol& protocol);
std::vector<CsvColumn<ExportAnswer>> answer_columns();
// sessions: of one kind, those of a participant together.
std::vector<ExportParticipant> participant_rows(const std::vector<SessionInfo>& sessions,
                                                const std::vector<ExcludedParticipant>& excluded);
std::vector<CsvColumn<ExportParticipant>> participant_columns(const Protocol& protocol);
// seed: empty where it is sealed.
std::vector<CsvColumn<SessionInfo>> session_columns(const std::string& seed, const std::string& study_head,
                                                    const Protocol& protocol);
std::vector<CsvColumn<DictionaryRow>> dictionary_columns();

}  // namespace jnd
