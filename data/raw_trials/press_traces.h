// What was felt in a few trials, tick by tick: force against depth. Read from the ticks that a session kept.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "data/study/study.h"
#include "protocols/protocol.h"

namespace jnd {

struct PressTrace {
  struct Point {
    double depth = 0;       // in the study's unit of length: m or rad; 0 where the finger is out of the object
    double measured_n = 0;  // by the device
    double asked_n = 0;     // by the contact, before any limit
  };
  int interval = 0;                 // from 0
  double stimulus = 0;              // that was asked for
  std::optional<double> delivered;  // fitted; none without force, or without a contact
  bool limited = false;             // a limit took some of the force away
  std::vector<Point> points;        // every 5 ms, in the order of time
};

// An answered main trial; of the device that comes first.
struct PressedTrial {
  std::string participant;
  int trial = 0;      // Trial::index
  int condition = 0;  // place in the protocol
  std::vector<PressTrace> intervals;
};

// Of the first of these sessions that kept ticks: for each condition the first answered trial that no registered rule
// leaves out, of same-different with two different stimuli where there is one. Empty where no session kept ticks. Reads
// only the ticks of those trials. Throws StorageError where they cannot be read.
std::vector<PressedTrial> pressed_trials(const Study& study, const Protocol& protocol,
                                         const std::vector<SessionInfo>& sessions);

// The answered main trial of that number in the first of the participant's sessions that kept its ticks; none where no
// one did. trial: Trial::index.
std::optional<PressedTrial> pressed_trial(const Study& study, const Protocol& protocol,
                                          const std::vector<SessionInfo>& sessions, const std::string& participant,
                                          int trial);

// Trials whose presses are shown.
struct ShownPresses {
  std::vector<PressedTrial> trials;
  bool chosen = false;  // by the user, not as pressed_trials() does
};

}  // namespace jnd
