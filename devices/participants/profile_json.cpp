// Reads a simulated participant's profile from its JSON form (devices/profiles/*.json).
#include "devices/participants/simulated_participant.h"
#include "protocols/input/input_error.h"
#include "protocols/input/json_reader.h"
#include "protocols/input/read_file.h"
#include "protocols/input/sha256.h"

namespace jnd {

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
