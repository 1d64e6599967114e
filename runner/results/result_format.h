// Numbers of a study as people read them in tables.
#pragma once

#include <string>
#include <string_view>

#include "data/fields/result_fields.h"
#include "data/results/study_analysis.h"
#include "data/results/study_contrasts.h"
#include "protocols/protocol.h"
#include "runner/terminal/number_text.h"

namespace jnd {

// In the study's unit, with the digits that it deserves.
std::string stiffness_text(double value, const Protocol& protocol);
// Of a median of JNDs: the number, "inf" where no sensitivity stands in the middle, else the status in words.
std::string median_text(JndStatus status, double median, const Protocol& protocol);
std::string_view unit_of(const Protocol& protocol) noexcept;

const std::string& condition_text(const Protocol& protocol, int place);  // its name
// "S" and its label, as "S: servo motors"; the name alone where the label says no more.
std::string condition_title(const Condition& condition);
std::string tracks_words(const TrackCount& tracks);  // "1 of 2 tracks used", "2 of 2 tracks unfinished"; else empty
std::string joined(const std::string& a, const std::string& b);  // "a, b", or the one that is not empty
// Where the fit rests on another difference than the one asked for; empty where it does not.
std::string source_caution(DifferenceSource source, const StudyAnalysis& analysis);

// How people read the numbers of a contrast's scale.
struct ContrastScale {
  std::string name;   // "d' per 100 N/m"
  double factor = 1;  // of the row's numbers
  int decimals = 3;
};
// tested: the comparison of the registered outcome.
ContrastScale contrast_scale(const ContrastRow& row, const OutcomeComparison& tested, const Protocol& protocol);

}  // namespace jnd
