// A protocol in the participant's language. Its identity (bytes, SHA-256) and everything that is drawn, planned or
// analysed stay as they are: only what people read and hear changes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "protocols/protocol.h"

namespace jnd {

// The protocol's own language first, then those of its translations in alphabetical order.
std::vector<std::string> languages_of(const Protocol& protocol);

// language: as BCP 47 names it, upper and lower case alike. The protocol's own gives the protocol unchanged; a
// translation replaces the texts that it has. Of a choice, Question::shown gets the translated options, and
// Question::options, what the log keeps, stay. Throws InputError that lists the languages where there is no such one.
Protocol in_language(const Protocol& protocol, std::string_view language);

// Texts of the participant's that a translation leaves out, by their paths. Empty for the protocol's own language, and
// for one that it does not have.
std::vector<std::string> left_out_of(const Protocol& protocol, std::string_view language);

// "leaves out 2 texts of the participant's: $.consent, $.breaks[0].say", naming a few; empty where it leaves out none.
std::string left_out_text(const Protocol& protocol, std::string_view language);

// "de" and "DE" name the same language.
bool same_language(std::string_view a, std::string_view b) noexcept;

}  // namespace jnd
