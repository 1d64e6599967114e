#include "devices/participants/simulated_participant.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "devices/participants/perceived_stiffness.h"
#include "devices/rig.h"
#include "protocols/input/input_error.h"
#include "protocols/input/json_reader.h"
#include "protocols/input/read_file.h"
#include "protocols/input/sha256.h"
#include "protocols/random_stream.h"

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
        protocol_(protocol),
        reference_(protocol.stimulus.reference),
        participant_(participant),
        seed_(seed),
        clock_(clock) {
    if (protocol.stimulus.unit != Unit::n_per_m && profile.criterion_n_per_m > 0)
      throw InputError(
          fmt::format("profile {} has its criterion in N/m, but this study's stiffnesses are in {}: use a profile with "
                      "criterion_sigmas, such as {}",
                      profile.name, to_string(protocol.stimulus.unit), kKinaesthetic));
    for (const Condition& condition : protocol.conditions) condition_names_.push_back(condition.name);
    spread_ = spread_factor(profile.spread_cv, seed, participant);
  }

  std::optional<Answer> judge(const TrialQuestion& question) override {
    const IntervalId id{.trial = question.trial.index, .attempt = question.attempt, .interval = 0};
    RandomStream random(seed_, static_cast<std::uint64_t>(participant_), "participant/judge",
                        interval_part(id, question.look));
    // Always the same draws in the same order, whatever is used of them.
    const bool lapse = random.uniform() < profile_.lapse_rate;
    const bool coin = random.coin();
    const double hesitation = random.normal();
    PerceptNoise noise;
    for (double& value : noise) value = random.normal();

    const double tired = 1 + profile_.drift_per_trial * static_cast<double>(std::max(question.trial.index - 1, 0));
    const double factor = spread_ * std::max(tired, 0.0);
    Answer answer = task_of(question.trial.task).compares_cues() ? pair_answer(question, factor, noise)
                                                                 : task_answer(question, factor, random);
    if (lapse) answer = lapsed(answer, coin, random);
    answer.entered_by = EnteredBy::participant;
    answer.response_time_s = profile_.response_time_median_s * std::exp(profile_.response_time_sigma * hesitation);
    const bool too_late = question.time_out_s > 0 && answer.response_time_s > question.time_out_s;
    const double waited_s = too_late ? question.time_out_s : answer.response_time_s;
    clock_.sleep_until_ns(clock_.now_ns() + std::llround(1e9 * waited_s));
    if (too_late) return std::nullopt;
    return answer;
  }

  // A time of their own, keyed by the interval: 30 to 90 % of the longest.
  bool enough(const IntervalId& id, double elapsed_s) override {
    RandomStream random(seed_, static_cast<std::uint64_t>(participant_), "participant/enough", interval_part(id, 0));
    return elapsed_s >= protocol_.timeline.explore_s * (0.3 + 0.6 * random.uniform());
  }

  Answer pair_answer(const TrialQuestion& question, double factor, const PerceptNoise& noise) const {
    const PairJudgement judged = judge_cues(profile_, cues_of(question.presentations[0]),
                                            cues_of(question.presentations[1]), factor, noise, reference_);
    Answer answer;
    answer.said = judged.said;
    answer.sureness = sureness_of(judged.beyond, judged.sigma, protocol_.task);
    return answer;
  }

  Answer task_answer(const TrialQuestion& question, double factor, RandomStream& random) const {
    std::vector<StiffnessCues> cues;
    for (const Presentation& presentation : question.presentations) cues.push_back(cues_of(presentation));
    const std::vector<Felt> felt =
        felt_of(profile_, cues, factor, noise_scale(question.trial), [&random] { return random.normal(); });
    return task_of(protocol_.task.kind).answer(felt, question.trial, protocol_, random);
  }

  // What a noise that is a fraction is a fraction of: the standard, or where that is 0 the largest level.
  double noise_scale(const Trial& trial) const {
    if (trial.standard != 0) return trial.standard;
    double largest = std::abs(reference_);
    for (const double value : protocol_.series[static_cast<std::size_t>(trial.series)].pair)
      largest = std::max(largest, std::abs(value));
    return largest;
  }

  // One of the answers at random. A number stays: who judges magnitudes has no answer that is wrong.
  Answer lapsed(Answer answer, bool coin, RandomStream& random) const {
    if (answer.number) return answer;
    const std::size_t classes = protocol_.task.classes.size();
    answer.said = classes == 2 ? (coin ? 1 : 0) : static_cast<int>(random.below(std::max<std::size_t>(classes, 1)));
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
  const Protocol& protocol_;
  double reference_;
  std::vector<std::string> condition_names_;
  int participant_;
  std::uint64_t seed_;
  Clock& clock_;
  double spread_ = 1;
};

}  // namespace

ParticipantProfile at_reference(ParticipantProfile profile, const StimulusSpec& stimulus) {
  if (!(profile.calibrated_at_n_per_m > 0) || stimulus.unit != Unit::n_per_m) return profile;
  const double scale = stimulus.reference / profile.calibrated_at_n_per_m;
  profile.sigma_force_n_per_m *= scale;
  profile.sigma_vibration_n_per_m *= scale;
  profile.criterion_n_per_m *= scale;
  profile.calibrated_at_n_per_m = stimulus.reference;
  return profile;
}

std::string default_profile(const Protocol& protocol) {
  if (!task_of(protocol.task.kind).has_trials()) return kExploring;
  if (!protocol.rig.built_in()) return kKinaesthetic;
  for (const Condition& condition : protocol.conditions)
    if (condition.cues.kinaesthetic) return kKinaesthetic;
  return "chinello2017";
}

std::unique_ptr<Responder> make_simulated_participant(const ParticipantProfile& profile, const Protocol& protocol,
                                                      int participant, std::uint64_t seed, Clock& clock) {
  return std::make_unique<SimulatedParticipant>(profile, protocol, participant, seed, clock);
}

// Reads a simulated participant's profile from its JSON form (devices/profiles/*.json).

namespace {

constexpr NumberLimits kNoise{.min = 0, .max = 1e5, .above = true, .unit = "N/m"};

void read_hand(const JsonNode& node, std::vector<Diagnostic>& diagnostics, const std::string& file,
               ParticipantProfile& profile) {
  JsonReader reader(node, diagnostics, file);
  profile.press_depth_m =
      reader.number_or("press_depth_m", profile.press_depth_m, {.min = 0.0005, .max = 0.02, .unit = "m"});
  profile.press_depth_sd_m =
      reader.number_or("press_depth_sd_m", profile.press_depth_sd_m, {.min = 0, .max = 0.01, .unit = "m"});
  profile.closing_speed_m_per_s = reader.number_or("closing_speed_m_per_s", profile.closing_speed_m_per_s,
                                                   {.min = 0.005, .max = 0.5, .unit = "m/s"});
  profile.press_period_s =
      reader.number_or("press_period_s", profile.press_period_s, {.min = 0.2, .max = 10, .unit = "s"});
  profile.lateral_sd_m = reader.number_or("lateral_sd_m", profile.lateral_sd_m, {.min = 0, .max = 0.01, .unit = "m"});
  profile.pulp_stiffness_n_per_m = reader.number_or("pulp_stiffness_n_per_m", profile.pulp_stiffness_n_per_m,
                                                    {.min = 300, .max = 20000, .unit = "N/m"});
  reader.finish();
}

RatingHabit rating_habit(const JsonNode& node, std::vector<Diagnostic>& diagnostics, const std::string& file) {
  JsonReader reader(node, diagnostics, file);
  RatingHabit habit;
  habit.mean = reader.number("mean", {.min = -1000, .max = 1000});
  habit.sd = reader.number("sd", {.min = 0, .max = 1000});
  reader.finish();
  return habit;
}

void read_ratings(const JsonNode& node, std::vector<Diagnostic>& diagnostics, const std::string& file,
                  ParticipantProfile& profile) {
  JsonReader conditions(node, diagnostics, file);
  for (const std::string& name : node.keys) {
    const JsonNode* rating = conditions.object(name);
    if (!rating) continue;
    const RatingHabit habit = rating_habit(*rating, diagnostics, file);
    profile.ratings[name] = {habit.mean, habit.sd};
  }
  conditions.finish();
}

AnswerHabit answer_habit(const JsonNode& node, std::vector<Diagnostic>& diagnostics, const std::string& file) {
  AnswerHabit habit;
  JsonReader reader(node, diagnostics, file);
  if (const JsonNode* rating = reader.object_or_null("rating")) habit.rating = rating_habit(*rating, diagnostics, file);
  if (const JsonNode* ratings = reader.object_or_null("ratings")) {
    JsonReader conditions(*ratings, diagnostics, file);
    for (const std::string& name : ratings->keys)
      if (const JsonNode* rating = conditions.object(name))
        habit.ratings[name] = rating_habit(*rating, diagnostics, file);
    conditions.finish();
  }
  if (const JsonNode* choices = reader.object_or_null("choices")) {
    JsonReader options(*choices, diagnostics, file);
    double total = 0;
    for (const std::string& option : choices->keys)
      total += habit.choices[option] = options.number(option, {.min = 0, .max = 1000});
    options.finish();
    if (!(total > 0) && is_sound(diagnostics, choices->path))
      reader.error(*choices, "no option has a weight above 0", "give at least one option a positive weight");
  }
  reader.finish();
  if (!habit.rating && habit.ratings.empty() && habit.choices.empty() && is_sound(diagnostics, node.path))
    reader.error(node, "says nothing of the answer", "give rating, ratings (by condition) or choices (by option)");
  return habit;
}

void read_answers(const JsonNode& node, std::vector<Diagnostic>& diagnostics, const std::string& file,
                  ParticipantProfile& profile) {
  JsonReader questions(node, diagnostics, file);
  for (const std::string& id : node.keys)
    if (const JsonNode* habit = questions.object(id)) profile.answers[id] = answer_habit(*habit, diagnostics, file);
  questions.finish();
}

}  // namespace

ParticipantProfile load_profile(const std::filesystem::path& path) {
  return parse_profile(read_input_file(path), path.string());
}

ParticipantProfile parse_profile(const std::string& bytes, const std::string& file) {
  const JsonNode root = parse_json(bytes, file);
  std::vector<Diagnostic> diagnostics;
  ParticipantProfile profile;
  profile.sha256 = sha256_hex(bytes);

  JsonReader reader(root, diagnostics, file);
  reader.ignore("$schema");
  reader.integer("format", {.min = 1, .max = 1});
  profile.name = reader.text("name", {.max_length = 64});
  profile.title = reader.text("title", {.max_length = 200});
  profile.notes = reader.text_or("notes", "", {.max_length = 2000});
  using Strategy = ParticipantProfile::Strategy;
  profile.strategy = reader.one_of<Strategy>(
      "strategy", {{"magnitude", Strategy::magnitude}, {"differencing", Strategy::differencing}});
  profile.calibrated_at_n_per_m = reader.optional_number("calibrated_at_n_per_m", kNoise).value_or(0);
  profile.sigma_force_n_per_m = reader.number("sigma_force_n_per_m", kNoise);
  profile.sigma_vibration_n_per_m = reader.number("sigma_vibration_n_per_m", kNoise);
  profile.kinaesthetic_weber =
      reader.number_or("kinaesthetic_weber", profile.kinaesthetic_weber, {.min = 0, .max = 10, .above = true});
  const std::optional<double> fixed = reader.optional_number("criterion_n_per_m", kNoise);
  const std::optional<double> sigmas =
      reader.optional_number("criterion_sigmas", {.min = 0, .max = 100, .above = true, .unit = "sigma"});
  if (fixed.has_value() == sigmas.has_value() && is_sound(diagnostics, root.path))
    reader.error(
        root, fixed ? "has both criterion_n_per_m and criterion_sigmas" : "has no criterion",
        "give criterion_n_per_m (a fixed difference) or criterion_sigmas (a multiple of the condition's noise)");
  profile.criterion_n_per_m = fixed.value_or(0);
  profile.criterion_sigmas = sigmas.value_or(0);
  profile.lapse_rate = reader.number_or("lapse_rate", 0, {.min = 0, .max = 1});
  profile.drift_per_trial = reader.number_or("drift_per_trial", 0, {.min = -0.1, .max = 0.1});
  profile.spread_cv = reader.number_or("spread_cv", 0, {.min = 0, .max = 2});
  if (const JsonNode* node = reader.object_or_null("response_time")) {
    JsonReader part(*node, diagnostics, file);
    profile.response_time_median_s = part.number("median_s", {.min = 0.05, .max = 60, .unit = "s"});
    profile.response_time_sigma = part.number("sigma", {.min = 0, .max = 2});
    part.finish();
  }
  if (const JsonNode* node = reader.object_or_null("hand")) read_hand(*node, diagnostics, file, profile);
  if (const JsonNode* node = reader.object_or_null("ratings")) read_ratings(*node, diagnostics, file, profile);
  if (const JsonNode* node = reader.object_or_null("answers")) read_answers(*node, diagnostics, file, profile);
  reader.finish();
  if (!diagnostics.empty()) throw InputError(std::move(diagnostics));
  return profile;
}

}  // namespace jnd
