#include "devices/participants/simulated_participant.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "devices/loop/interval_key.h"
#include "devices/participants/perceived_stiffness.h"
#include "protocols/input/input_error.h"
#include "protocols/planning/random_stream.h"

namespace jnd {

namespace {

// Shipped profiles.
constexpr const char* kKinaesthetic = "kinaesthetic";
constexpr const char* kExploring = "chinello2017-experiment2";

// Factor on a participant's noise: log-normal, mean 1, coefficient of variation cv.
double spread_factor(double cv, std::uint64_t seed, int participant) noexcept {
  if (!(cv > 0)) return 1;
  const double variance = std::log1p(cv * cv);
  RandomStream random(seed, static_cast<std::uint64_t>(participant), "participant/spread");
  return std::exp(std::sqrt(variance) * random.normal() - variance / 2);
}

class SimulatedParticipant final : public Responder {
 public:
  SimulatedParticipant(const ParticipantProfile& profile, const Protocol& protocol, int participant, std::uint64_t seed,
                       Clock& clock)
      : profile_(at_reference(profile, protocol.stimulus)),
        reference_(protocol.stimulus.reference),
        participant_(participant),
        seed_(seed),
        clock_(clock) {
    if (protocol.stimulus.unit != StiffnessUnit::n_per_m && profile.criterion_n_per_m > 0)
      throw InputError(
          fmt::format("profile {} has its criterion in N/m, but this study's stiffnesses are in {}: use a profile with "
                      "criterion_sigmas, such as {}",
                      profile.name, to_string(protocol.stimulus.unit), kKinaesthetic));
    for (const Condition& condition : protocol.conditions) condition_names_.push_back(condition.name);
    spread_ = spread_factor(profile.spread_cv, seed, participant);
  }

  std::optional<Answer> judge(const TrialQuestion& question) override {
    const IntervalId id{.trial = question.trial.index, .attempt = question.attempt, .interval = 0};
    RandomStream random(seed_, static_cast<std::uint64_t>(participant_), "participant/judge", interval_part(id, 0));
    // Always the same draws in the same order, whatever is used of them.
    const bool lapse = random.uniform() < profile_.lapse_rate;
    const Judgement coin = random.coin() ? Judgement::different : Judgement::same;
    const double hesitation = random.normal();
    PerceptNoise noise;
    for (double& value : noise) value = random.normal();

    const double tired = 1 + profile_.drift_per_trial * static_cast<double>(std::max(question.trial.index - 1, 0));
    const Judgement felt = judge_cues(profile_, cues_of(question.presentations[0]), cues_of(question.presentations[1]),
                                      spread_ * std::max(tired, 0.0), noise, reference_);

    Answer answer;
    answer.judgement = lapse ? coin : felt;
    answer.entered_by = EnteredBy::participant;
    answer.response_time_s = profile_.response_time_median_s * std::exp(profile_.response_time_sigma * hesitation);
    const bool too_late = question.time_out_s > 0 && answer.response_time_s > question.time_out_s;
    const double waited_s = too_late ? question.time_out_s : answer.response_time_s;
    clock_.sleep_until_ns(clock_.now_ns() + std::llround(1e9 * waited_s));
    if (too_late) return std::nullopt;
    return answer;
  }

  // The same question about the same condition gets the same reply, however often it is asked.
  std::optional<std::string> reply(const Question& question, int condition) override {
    RandomStream random(seed_, static_cast<std::uint64_t>(participant_), "participant/reply/" + question.id,
                        static_cast<std::uint64_t>(condition + 1));
    switch (question.kind) {
      case Question::Kind::rating:
        return fmt::format("{:.0f}", rating(question, condition, random));
      case Question::Kind::number: {
        const double low = std::ceil(question.min), high = std::floor(question.max);
        if (high < low) return fmt::format("{}", question.min);
        const double count = std::min(high - low + 1, 1e15);
        return fmt::format("{:.0f}", low + static_cast<double>(random.below(static_cast<std::uint64_t>(count))));
      }
      case Question::Kind::choice:
        if (question.options.empty()) return std::nullopt;
        if (const std::string* chosen = preferred(question, random)) return *chosen;
        return question.options[static_cast<std::size_t>(random.below(question.options.size()))];
      case Question::Kind::confirm:
        return "yes";
      case Question::Kind::text:
        break;
    }
    // Nothing to say; but a text that must be given must not be empty.
    if (question.required) return "(simulated participant)";
    return std::nullopt;
  }

 private:
  double rating(const Question& question, int condition, RandomStream& random) const {
    const RatingHabit habit = rating_habit(question, condition);
    return std::clamp(std::round(habit.mean + habit.sd * random.normal()), std::ceil(question.min),
                      std::max(std::ceil(question.min), std::floor(question.max)));
  }

  // What the profile says of this question in this condition, else of the condition, else the middle of the scale.
  RatingHabit rating_habit(const Question& question, int condition) const {
    const bool known = condition >= 0 && static_cast<std::size_t>(condition) < condition_names_.size();
    const std::string name = known ? condition_names_[static_cast<std::size_t>(condition)] : std::string();
    if (const auto answer = profile_.answers.find(question.id); answer != profile_.answers.end()) {
      const auto found = answer->second.ratings.find(name);
      if (found != answer->second.ratings.end()) return found->second;
      if (answer->second.rating) return *answer->second.rating;
    }
    if (const auto found = profile_.ratings.find(name); found != profile_.ratings.end())
      return {found->second.first, found->second.second};
    return {(question.min + question.max) / 2, (question.max - question.min) / 6};
  }

  // An option by the profile's weights; null where it names none of them.
  const std::string* preferred(const Question& question, RandomStream& random) const {
    const auto answer = profile_.answers.find(question.id);
    if (answer == profile_.answers.end()) return nullptr;
    const auto weight = [&](const std::string& option) {
      const auto found = answer->second.choices.find(option);
      return found == answer->second.choices.end() ? 0.0 : found->second;
    };
    double total = 0;
    for (const std::string& option : question.options) total += weight(option);
    if (!(total > 0)) return nullptr;
    double left = total * random.uniform();
    const std::string* last = nullptr;
    for (const std::string& option : question.options) {
      if (!(weight(option) > 0)) continue;
      last = &option;
      left -= weight(option);
      if (left < 0) break;
    }
    return last;
  }

  ParticipantProfile profile_;
  double reference_;
  std::vector<std::string> condition_names_;
  int participant_;
  std::uint64_t seed_;
  Clock& clock_;
  double spread_ = 1;
};

}  // namespace

ParticipantProfile at_reference(ParticipantProfile profile, const StimulusSpec& stimulus) {
  if (!(profile.calibrated_at_n_per_m > 0) || stimulus.unit != StiffnessUnit::n_per_m) return profile;
  const double scale = stimulus.reference / profile.calibrated_at_n_per_m;
  profile.sigma_force_n_per_m *= scale;
  profile.sigma_vibration_n_per_m *= scale;
  profile.criterion_n_per_m *= scale;
  profile.calibrated_at_n_per_m = stimulus.reference;
  return profile;
}

std::string default_profile(const Protocol& protocol) {
  if (protocol.paradigm == Paradigm::explore) return kExploring;
  for (const Condition& condition : protocol.conditions)
    if (condition.cues.kinaesthetic) return kKinaesthetic;
  return "chinello2017";
}

std::unique_ptr<Responder> make_simulated_participant(const ParticipantProfile& profile, const Protocol& protocol,
                                                      int participant, std::uint64_t seed, Clock& clock) {
  return std::make_unique<SimulatedParticipant>(profile, protocol, participant, seed, clock);
}

}  // namespace jnd
