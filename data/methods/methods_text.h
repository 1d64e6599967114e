// A methods section in words: what was measured and computed, with versions, hashes, seed, model and citations, so that
// a reader can do it again.
#pragma once

#include <string>

#include "data/results/study_results.h"

namespace jnd {

// Markdown, UTF-8, ends with a newline. The same study gives the same text.
std::string methods_text(const Study& study, const Protocol& protocol, const StudyResults& results);

}  // namespace jnd
