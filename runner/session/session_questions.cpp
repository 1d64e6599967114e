// What a session asks and tells people around its trials: checklist, instructions, consent, pages of questions.
#include <optional>

#include "runner/session/session_engine.h"

namespace jnd {

// A page is answered as a whole. Ctrl-C: a pause, then the page again.
Replies SessionEngine::replies_to(const std::vector<AskedQuestion>& page) {
  for (;;) {
    heed_interrupts(parts_, recorder_, after_trial());
    const std::optional<Replies> replies = parts_.responder.reply_all(page);
    if (replies && !parts_.interrupts.end) return *replies;
    heed_interrupts(parts_, recorder_, after_trial());
    const OperatorWish wish = parts_.view.meanwhile();
    if (!parts_.person || wish.wish != Wish::go_on)
      throw SessionEnds{wish.wish == Wish::end_for_good, "operator", wish.text};
  }
}

// Asked each time: a mask may have slipped since.
void SessionEngine::check_list() {
  if (!parts_.person || protocol_.checklist.empty()) return;
  std::vector<AskedQuestion> page;
  for (const Question& item : protocol_.checklist) page.push_back({item, -1});
  const Replies replies = replies_to(page);
  for (std::size_t i = 0; i < page.size(); ++i) {
    const std::optional<std::string>& answer = replies[i];
    recorder_.append(event_kind::kChecklist,
                     {{"question", page[i].question.id},
                      {"text", page[i].question.text},
                      {"answer", answer ? nlohmann::ordered_json(*answer) : nlohmann::ordered_json(nullptr)}});
  }
}

void SessionEngine::instruct(Instruction::When when) {
  if (!parts_.person) return;
  for (const Instruction& instruction : protocol_.instructions) {
    if (instruction.when != when || progress_.state().instructed.contains(instruction.id)) continue;
    settle(parts_, recorder_, after_trial(), [&] { return parts_.view.instruct(instruction); });
    recorder_.append(event_kind::kInstructed, {{"id", instruction.id}, {"language", protocol_.language}});
    progress_.state().instructed.insert(instruction.id);
  }
}

void SessionEngine::consent() {
  if (!parts_.person || protocol_.consent.empty() || progress_.state().consented) return;
  std::optional<bool> given;
  while (!given) {
    heed_interrupts(parts_, recorder_, after_trial());
    given = parts_.view.consent(protocol_.consent);
  }
  nlohmann::ordered_json body = {{"language", protocol_.language}, {"text", protocol_.consent}, {"by", "operator"}};
  if (!*given) body["refused"] = true;
  recorder_.append(event_kind::kConsent, body);
  if (!*given) throw SessionEnds{true, "no consent", {}};
  progress_.state().consented = true;
}

// One page: it is answered as a whole, and saved when it is done.
void SessionEngine::ask(Question::When when, int condition, int after_trial) {
  const auto name_of = [&](int place) {
    return place < 0 ? std::string() : protocol_.conditions[static_cast<std::size_t>(place)].name;
  };
  std::vector<AskedQuestion> page;
  const auto add = [&](const Question& question, int place) {
    if (!progress_.state().answered.contains(question_key(question.id, name_of(place), after_trial)))
      page.push_back({question, place});
  };
  for (const Question& question : protocol_.questions) {
    if (question.when != when) continue;
    if (question.per_condition) {
      for (int i = 0; i < static_cast<int>(protocol_.conditions.size()); ++i) add(question, i);
    } else {
      add(question, condition);
    }
  }
  if (page.empty()) return;
  const Replies replies = replies_to(page);
  for (std::size_t i = 0; i < page.size(); ++i) {
    const std::string name = name_of(page[i].condition);
    recorder_.append(event_kind::kQuestionAnswered, question_body(page[i].question, name, replies[i], after_trial));
    progress_.state().answered.insert(question_key(page[i].question.id, name, after_trial));
  }
}

}  // namespace jnd
