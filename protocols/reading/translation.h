// The texts of a protocol that participants or operators read or hear, each with its place in the file: what a
// translation may replace.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "protocols/input/json_reader.h"
#include "protocols/protocol.h"

namespace jnd {

// Bounds that the texts and their translations share.
inline constexpr TextLimits kTitleLimits{.max_length = 200};
inline constexpr TextLimits kSayLimits{.max_length = 200};
inline constexpr TextLimits kQuestionLimits{.max_length = 500};
inline constexpr TextLimits kLabelLimits{.max_length = 100};  // of conditions, groups, options, ends of a scale
inline constexpr TextLimits kPageLimits{.max_length = 4000, .page = true};

// Whom a text is for. A translation that leaves out one of the participant's is incomplete.
enum class Audience { participant, operator_ };

// Whether a question names the condition that it is about by its label. One right after a condition does not where
// letters are coded: the label would say which condition the letter stands for.
inline bool shows_condition_labels(const Protocol& protocol) {
  return std::any_of(protocol.questions.begin(), protocol.questions.end(), [&](const Question& question) {
    return question.per_condition || (question.when == Question::When::after_condition && !protocol.blinded);
  });
}

// Calls visit(path, text, limits, audience) for every text that is not empty, in the order of the tables of README.md.
// Options are visited as they are shown: Question::shown, where it is filled, in place of Question::options.
template <typename AnyProtocol, typename Visit>
void visit_participant_texts(AnyProtocol& protocol, Visit&& visit) {
  const auto look = [&visit](const std::string& path, auto& text, const TextLimits& limits, Audience audience) {
    if (!text.empty()) visit(path, text, limits, audience);
  };
  const auto look_at_question = [&look](const std::string& path, auto& question, Audience audience) {
    look(path + ".text", question.text, kQuestionLimits, audience);
    look(path + ".low", question.low_label, kLabelLimits, audience);
    look(path + ".high", question.high_label, kLabelLimits, audience);
    auto& options = question.shown.empty() ? question.options : question.shown;
    for (std::size_t i = 0; i < options.size(); ++i)
      look(fmt::format("{}.options[{}]", path, i), options[i], kLabelLimits, audience);
  };
  look("$.title", protocol.title, kTitleLimits, Audience::operator_);
  look("$.consent", protocol.consent, kPageLimits, Audience::participant);
  for (std::size_t i = 0; i < protocol.instructions.size(); ++i)
    look(fmt::format("$.instructions[{}].text", i), protocol.instructions[i].text, kPageLimits, Audience::participant);
  if (protocol.timeline.prescription)
    look("$.trial.prescription.say", protocol.timeline.prescription->say, kSayLimits, Audience::participant);
  look("$.trial.cues.first.say", protocol.timeline.interval_cues[0].say, kSayLimits, Audience::participant);
  look("$.trial.cues.second.say", protocol.timeline.interval_cues[1].say, kSayLimits, Audience::participant);
  look("$.trial.cues.third.say", protocol.timeline.interval_cues[2].say, kSayLimits, Audience::participant);
  look("$.trial.cues.question.say", protocol.timeline.question_cue.say, kSayLimits, Audience::participant);
  const Audience of_labels = shows_condition_labels(protocol) ? Audience::participant : Audience::operator_;
  for (std::size_t i = 0; i < protocol.conditions.size(); ++i) {
    look(fmt::format("$.conditions[{}].label", i), protocol.conditions[i].label, kLabelLimits, of_labels);
    if (auto& prescription = protocol.conditions[i].prescription)
      look(fmt::format("$.conditions[{}].prescription.say", i), prescription->say, kSayLimits, Audience::participant);
  }
  for (std::size_t i = 0; i < protocol.groups.size(); ++i)
    look(fmt::format("$.groups[{}].label", i), protocol.groups[i].label, kLabelLimits, Audience::operator_);
  for (std::size_t i = 0; i < protocol.breaks.size(); ++i)
    look(fmt::format("$.breaks[{}].say", i), protocol.breaks[i].say, kSayLimits, Audience::participant);
  for (std::size_t i = 0; i < protocol.questions.size(); ++i)
    look_at_question(fmt::format("$.questions[{}]", i), protocol.questions[i], Audience::participant);
  for (std::size_t i = 0; i < protocol.checklist.size(); ++i)
    look_at_question(fmt::format("$.checklist[{}]", i), protocol.checklist[i], Audience::operator_);
}

// A protocol in the participant's language. Its identity (bytes, SHA-256) and everything that is drawn, planned or
// analysed stay as they are: only what people read and hear changes.

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
