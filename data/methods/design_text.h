// What was presented to whom, in which order, and how it was explored: the half of the methods that follows from the
// protocol.
#pragma once

#include <string>

#include "data/results/study_results.h"
#include "protocols/protocol.h"

namespace jnd {

// A paragraph of Markdown, with its line end; of a protocol with trials.
std::string design_paragraph(const Protocol& protocol, const StudyResults& results);
// The same of free interaction.
std::string exploration_design(const Protocol& protocol, const StudyResults& results);

// The response model and its prior, of the first series: those of others are in proportion. Of a protocol with a
// posterior, within a sentence.
std::string model_words(const Protocol& protocol);

}  // namespace jnd
