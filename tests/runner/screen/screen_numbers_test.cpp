// Blind by construction: 200 sessions are played, and a classifier learns from half of them what the numbers, bars and
// times on the operator's screen, and those of jnd status, go with. On the other half it does not tell the class, the
// stimulus or the condition of the trial that is under way.
//
// What a participant does may well go with what is felt, and is not for the screen to hide: here hand and voice are those
// of somebody whom nothing makes faster, and trials are drawn one by one, so that earlier answers say nothing of later
// ones.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "data/log/event_body.h"
#include "devices/clock.h"
#include "protocols/tasks/same_different_task.h"
#include "runner/console/session_console.h"
#include "runner/screen/screen_display.h"
#include "tests/catch.h"
#include "tests/runner/engine_fixture.h"
#include "tests/runner/screen/kept_frames.h"

namespace jnd {
namespace {

constexpr int kSessions = 200;
constexpr int kShuffles = 400;

using Numbers = std::map<std::string, double>;

// Every number by the words before it, how often such a number is there, and every bar by its full cells.
void add_numbers(const std::string& line, Numbers& numbers) {
  static const std::string kFull = "█";
  std::string words;
  for (std::size_t i = 0; i < line.size();) {
    if (line[i] >= '0' && line[i] <= '9') {
      std::size_t length = 0;
      const double value = std::stod(line.substr(i), &length);
      numbers[words] = value;
      numbers["count of " + words] += 1;
      words += '#';
      i += length;
    } else if (line.compare(i, kFull.size(), kFull) == 0) {
      numbers["bar " + words] += 1;
      i += kFull.size();
    } else {
      words += line[i++];
    }
    if (words.size() > 12) words.erase(0, words.size() - 12);
  }
}

struct Sample {
  Numbers numbers;
  std::array<int, 3> labels{};  // of the trial under way: different, the first stimulus is the reference, the condition
};
constexpr std::array kLabels = {"same or different", "which comes first", "the condition"};

// Delivers what is asked, with all that goes with it, and shows a hand whose touches do not depend on it.
class ShownRig final : public Rig {
 public:
  ShownRig(Clock& clock, std::mt19937& random) : clock_(clock), random_(random) {}
  const RigInfo& info() const noexcept override { return info_; }
  void neutral() noexcept override {}
  void watch(const std::function<void(const LoopSnapshot&)>& look) override { look_ = look; }
  Presentation present(const PresentRequest& request) override {
    std::uniform_real_distribution<double> share(0, 1);
    const double first_s = share(random_);
    const double length_s = first_s + request.explore_s;
    for (const double at_s : {first_s / 2, first_s + 0.3, length_s}) {
      clock_.sleep_until_ns(clock_.now_ns() + 300'000'000);
      if (look_)
        look_(
            {.ticks = std::llround(1000 * at_s), .elapsed_s = at_s, .lateness_max_us = 90, .contact = at_s > first_s});
    }
    Presentation given;
    given.duration_s = length_s;
    given.ticks = std::llround(1000 * length_s);
    if (share(random_) < 0.05) given.fault = Fault::no_contact;
    FingerPresentation finger;
    finger.stiffness = request.stimulus.stiffness;
    finger.peak_force_n = request.stimulus.stiffness / 200;
    if (request.id.interval == 0) peak_force_n = finger.peak_force_n;
    finger.saturated_share = request.stimulus.stiffness > 800 ? 0.2 : 0;
    given.fingers = {finger, finger};
    return given;
  }
  double peak_force_n = 0;  // of the latest first interval

 private:
  Clock& clock_;
  std::mt19937& random_;
  RigInfo info_{.name = "shown", .mode = "ideal", .tracker = "none", .sha256 = "", .simulated = true};
  std::function<void(const LoopSnapshot&)> look_;
};

Protocol protocol_of_study() {
  return test::small_protocol({{"series", {{{"name", "1"}, {"pair", {500, 900}}}}},
                               {"design",
                                {{"participants", 4},
                                 {"trials_per_cell", 2},
                                 {"sampling", "random"},
                                 {"conditions", "blocked"},
                                 {"order", {{"series", "permuted"}, {"conditions", "permuted"}}}}},
                               {"breaks", {{{"after", "block"}, {"duration_s", 20}}}},
                               {"questions",
                                {{{"id", "ease"},
                                  {"when", "after-session"},
                                  {"kind", "rating"},
                                  {"text", "How easy was it?"},
                                  {"min", 1},
                                  {"max", 9},
                                  {"low", "hard"},
                                  {"high", "easy"}}}}});
}

// One session on a screen that is kept; what it shows when each question is asked.
class PlayedSession {
 public:
  PlayedSession(const Protocol& protocol, std::uint32_t seed)
      : protocol_(protocol), random_(seed), plan_(make_plan(protocol, 1 + static_cast<int>(seed % 4), seed)) {}

  std::vector<Sample> play() {
    const Interrupts interrupts;
    SessionConsole console(ConsoleOptions{}, protocol_, nullptr, clock_, interrupts,
                           make_screen_display([this] { return std::make_unique<test::KeptFrames>(lines_); },
                                               std::make_unique<test::SharedClock>(clock_)));
    test::RuleResponder responder(clock_);
    responder.rule = [this](const TrialQuestion& question) { return answer(question); };
    SessionCard card;
    card.participant = "P01";
    card.trials_total = main_trial_count(plan_);
    console.begin(card);
    const SessionParts parts{protocol_, plan_, rig_, responder, log_, clock_, console, interrupts, RecordPolicy::events,
                             true};
    SessionEngine(parts).run(replay(log_.events()));
    return samples_;
  }

 private:
  std::optional<int> answer(const TrialQuestion& question) {
    Sample sample;
    for (const std::string& line : lines_) add_numbers(line, sample.numbers);
    add_status(sample.numbers);
    sample.numbers["(planted) peak force"] = rig_.peak_force_n;
    const bool different = question.trial.target != kClassSame;
    sample.labels = {different ? 1 : 0, question.trial.stimuli[0] > 800 ? 1 : 0, question.trial.condition};
    samples_.push_back(std::move(sample));
    std::uniform_real_distribution<double> share(0, 1);
    clock_.sleep_until_ns(clock_.now_ns() + std::llround(2e9 * share(random_)));
    if (share(random_) < 0.05) return std::nullopt;
    const bool right = share(random_) < 0.8;
    return right == different ? kClassDifferent : kClassSame;
  }
  // What jnd status counts.
  void add_status(Numbers& numbers) const {
    for (const Event& event : log_.events()) {
      if (event.kind == event_kind::kTrialCompleted) numbers["status done"] += 1;
      if (event.kind == event_kind::kTrialVoided) numbers["status voided"] += 1;
    }
    numbers["status seconds"] = static_cast<double>(clock_.now_ns()) * 1e-9;
  }

  const Protocol& protocol_;
  std::mt19937 random_;
  Plan plan_;
  SimulatedClock clock_{1'700'000'000'000'000'000};
  ShownRig rig_{clock_, random_};
  MemoryLog log_;
  std::vector<std::string> lines_;
  std::vector<Sample> samples_;
};

// Logistic regression with a small ridge, by gradient descent on standardised features.
class Classifier {
 public:
  void learn(const std::vector<std::vector<double>>& rows, const std::vector<int>& labels) {
    weights_.assign(rows.front().size(), 0);
    constexpr int kSteps = 150;
    constexpr double kRate = 0.5, kRidge = 0.01;
    for (int step = 0; step < kSteps; ++step) {
      std::vector<double> gradient(weights_.size());
      double of_bias = 0;
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const double error = 1 / (1 + std::exp(-score(rows[i]))) - labels[i];
        of_bias += error;
        for (std::size_t k = 0; k < gradient.size(); ++k) gradient[k] += error * rows[i][k];
      }
      const double share = kRate / static_cast<double>(rows.size());
      bias_ -= share * of_bias;
      for (std::size_t k = 0; k < gradient.size(); ++k)
        weights_[k] -= share * gradient[k] + kRate * kRidge * weights_[k];
    }
  }
  double score(const std::vector<double>& row) const {
    return std::inner_product(row.begin(), row.end(), weights_.begin(), bias_);
  }

 private:
  std::vector<double> weights_;
  double bias_ = 0;
};

struct Table {
  std::vector<std::vector<double>> rows;
  std::vector<std::array<int, 3>> labels;
  std::vector<std::size_t> session;  // of each row
};

// Features with their names in one order, each with mean 0 and deviation 1 over all rows.
Table table_of(const std::vector<std::vector<Sample>>& sessions, bool planted) {
  std::map<std::string, std::size_t> places;
  for (const auto& samples : sessions)
    for (const Sample& sample : samples)
      for (const auto& [name, value] : sample.numbers)
        if (planted || name.find("(planted)") != 0) places.emplace(name, places.size());
  Table table;
  for (std::size_t session = 0; session < sessions.size(); ++session)
    for (const Sample& sample : sessions[session]) {
      std::vector<double> row(places.size());
      for (const auto& [name, value] : sample.numbers)
        if (const auto place = places.find(name); place != places.end()) row[place->second] = value;
      table.rows.push_back(std::move(row));
      table.labels.push_back(sample.labels);
      table.session.push_back(session);
    }
  for (std::size_t k = 0; k < places.size(); ++k) {
    double sum = 0, squares = 0;
    const auto n = static_cast<double>(table.rows.size());
    for (const auto& row : table.rows) sum += row[k];
    for (const auto& row : table.rows) squares += (row[k] - sum / n) * (row[k] - sum / n);
    const double deviation = std::sqrt(squares / n);
    for (auto& row : table.rows) row[k] = deviation > 1e-12 ? (row[k] - sum / n) / deviation : 0;
  }
  return table;
}

struct Told {
  double share = 0;   // of the other half, right
  double chance = 0;  // 95 of 100 shuffles of whole sessions do no better
};

Told told_by(const Table& table, std::size_t label, std::size_t half) {
  std::vector<std::vector<double>> learnt;
  std::vector<int> answers;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    if (table.session[i] >= half) break;
    learnt.push_back(table.rows[i]);
    answers.push_back(table.labels[i][label]);
  }
  Classifier classifier;
  classifier.learn(learnt, answers);
  // Guesses and answers by session; a shuffle gives a session the answers of another one.
  std::map<std::size_t, std::pair<std::vector<int>, std::vector<int>>> others;
  for (std::size_t i = learnt.size(); i < table.rows.size(); ++i) {
    auto& [guesses, right] = others[table.session[i]];
    guesses.push_back(classifier.score(table.rows[i]) > 0 ? 1 : 0);
    right.push_back(table.labels[i][label]);
  }
  std::vector<const std::vector<int>*> guesses, truths;
  for (const auto& [session, pair] : others) {
    guesses.push_back(&pair.first);
    truths.push_back(&pair.second);
  }
  const auto share_right = [&] {
    double right = 0, all = 0;
    for (std::size_t s = 0; s < guesses.size(); ++s)
      for (std::size_t i = 0; i < std::min(guesses[s]->size(), truths[s]->size()); ++i, ++all)
        right += (*guesses[s])[i] == (*truths[s])[i] ? 1 : 0;
    return right / all;
  };
  Told told{.share = share_right()};
  std::mt19937 random(1);
  std::vector<double> shuffled;
  for (int i = 0; i < kShuffles; ++i) {
    std::shuffle(truths.begin(), truths.end(), random);
    shuffled.push_back(share_right());
  }
  std::sort(shuffled.begin(), shuffled.end());
  told.chance = shuffled[kShuffles * 95 / 100];
  return told;
}

TEST_CASE("From the numbers, bars and times on the screen and in jnd status a classifier learns nothing of the trial",
          "[long]") {
  const Protocol protocol = protocol_of_study();
  std::vector<std::vector<Sample>> sessions;
  for (std::uint32_t seed = 1; seed <= kSessions; ++seed) sessions.push_back(PlayedSession(protocol, seed).play());
  const Table table = table_of(sessions, false), planted = table_of(sessions, true);
  fmt::print("{} sessions, {} trials, {} numbers\n", kSessions, table.rows.size(), table.rows.front().size());
  CHECK(table.rows.front().size() > 30);
  for (std::size_t label = 0; label < kLabels.size(); ++label) {
    const Told told = told_by(table, label, kSessions / 2);
    fmt::print("{}: {:.1f} % right (chance: up to {:.1f} %)\n", kLabels[label], 100 * told.share, 100 * told.chance);
    CHECK(told.share <= told.chance);
  }
  // It would find what goes with the stimulus, were it there.
  const Told found = told_by(planted, 1, kSessions / 2);
  fmt::print("with the peak force beside them: {:.1f} % right\n", 100 * found.share);
  CHECK(found.share > found.chance + 0.1);
}

}  // namespace
}  // namespace jnd
