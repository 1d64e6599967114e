// How well a protocol or a task will measure.
#include <cmath>

#include "analysis/choice/choice_task.h"
#include "analysis/numerics/normal.h"
#include "protocols/planning/planned_precision.h"
#include "protocols/planning/track_threshold.h"
#include "protocols/reading/protocol_json.h"
#include "protocols/tasks/task.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"

using namespace jnd;
using namespace jnd::test;

// How well a task will measure, by simulation.

namespace {

const TaskPrecisionRow& row_of(const std::vector<TaskPrecisionRow>& rows, const Protocol& protocol,
                               std::string_view key) {
  const auto outcomes = measured_outcomes(protocol);
  for (const TaskPrecisionRow& row : rows)
    if (outcomes[row.outcome].key == key) return row;
  throw std::logic_error("no such outcome");
}

}  // namespace

TEST_CASE("simulated estimates lie about the truth, and scatter by half with four times the trials") {
  Protocol protocol = shipped_protocol("maereg2017");
  protocol.design.trials_per_cell = 40;
  TaskPrecisionQuestion question;
  question.noise = 80;
  const auto few = task_precision(protocol, question);
  const TaskPrecisionRow& jnd = row_of(few, protocol, "jnd");
  CHECK(jnd.median == Approx(0.67449 * 80).epsilon(0.03));
  CHECK(jnd.low < jnd.median);
  CHECK(jnd.high > jnd.median);
  CHECK(jnd.undefined == 0);
  CHECK(row_of(few, protocol, "pse").median == Approx(400).epsilon(0.01));
  CHECK(task_precision(protocol, question).front().median == few.front().median);
  protocol.design.trials_per_cell = 160;
  CHECK(row_of(task_precision(protocol, question), protocol, "jnd").cv == Approx(jnd.cv / 2).epsilon(0.15));
}

TEST_CASE("of a threshold by the posterior of all answers the noise is the true JND") {
  const Protocol protocol = shipped_protocol("adaptive-posterior");
  TaskPrecisionQuestion question;
  question.noise = 250;
  const auto rows = task_precision(protocol, question);
  const TaskPrecisionRow& threshold = row_of(rows, protocol, "threshold");
  CHECK(threshold.median == Approx(250).epsilon(0.06));
  CHECK(threshold.trials == 60);
  CHECK(threshold.undefined < 0.01);
  CHECK(row_of(rows, protocol, "weber").median == Approx(threshold.median / 900));
}

TEST_CASE("thresholds by reversals and by QUEST lie where the procedure settles") {
  TaskPrecisionQuestion question;
  question.noise = 250;
  // "different" is said with Phi(difference / JND - criterion), about 0.75 by the default prior.
  for (const char* name : {"adaptive-staircase", "adaptive-quest"}) {
    CAPTURE(name);
    const Protocol protocol = shipped_protocol(name);
    const AdaptiveProcedure& procedure = *protocol.design.procedure;
    const double target = procedure.kind == AdaptiveProcedure::Kind::quest ? procedure.quest.p_threshold
                                                                           : staircase_target(procedure.staircase);
    const auto rows = task_precision(protocol, question);
    const TaskPrecisionRow& threshold = row_of(rows, protocol, "threshold");
    CHECK(threshold.median == Approx(250 * (0.75 + normal_quantile(target))).epsilon(0.12));
    CHECK(threshold.cv < 0.5);
    CHECK(threshold.undefined < 0.1);
    CHECK(row_of(rows, protocol, "weber").median == Approx(threshold.median / 900));
  }
}

TEST_CASE("a staircase of three intervals settles where so many answers are correct") {
  for (const char* name : {"carpenter2018-oddity", "abx-stiffness"}) {
    CAPTURE(name);
    Protocol protocol = shipped_protocol(name);
    const Series& series = protocol.series.front();
    const double noise = 0.5 * std::abs(series.levels.front() - series.standard);
    AdaptiveProcedure& procedure = protocol.design.procedure.emplace();
    procedure.kind = AdaptiveProcedure::Kind::staircase;
    procedure.staircase = {.up = 1, .down = 3, .step_up = 1.2, .step_down = 1.2, .multiplicative = true};
    procedure.starts = {4 * noise};
    procedure.clamp = {0.01 * noise, 100 * noise};
    procedure.sides = {1};
    procedure.trials = 300;
    procedure.averaged_reversals = 20;
    TaskPrecisionQuestion question;
    question.noise = noise;
    question.participants = 60;
    const auto rows = task_precision(protocol, question);
    const std::vector<TaskOutcome> outcomes = measured_outcomes(protocol);
    const auto median_of = [&](std::string_view key) {
      for (const TaskPrecisionRow& row : rows)
        if (outcomes[row.outcome].key == key) return row.median;
      throw std::logic_error("no such outcome");
    };
    // Where the task's own curve, by the JND of the same answers, has the staircase's target.
    const ChoiceTask task = protocol.task.kind == TaskKind::oddity ? ChoiceTask::oddity : ChoiceTask::abx_differencing;
    const double at_threshold = choice_rate(task, median_of("track_threshold") / median_of("jnd")).correct;
    CHECK(at_threshold == Approx(adaptive_target(procedure).value()).margin(0.03));
  }
}

TEST_CASE("every task's precision can be foretold, of procedures too") {
  for (const char* name : {"leib2015", "pang1991", "identify-stiffness2025", "carpenter2018-oddity", "abx-stiffness",
                           "dhong2019-magnitude", "jones-hunter1990", "singhala2020", "adaptive-posterior",
                           "adaptive-staircase-90", "adaptive-staircase", "adaptive-quest"}) {
    CAPTURE(name);
    const Protocol protocol = shipped_protocol(name);
    TaskPrecisionQuestion question;
    question.participants = 20;
    const auto rows = task_precision(protocol, question);
    CHECK(rows.size() == protocol.series.size() * measured_outcomes(protocol).size());
    const bool own = task_of(protocol.task.kind).has_pairs();
    const TaskPrecisionRow& registered = row_of(rows, protocol, own ? "threshold" : protocol.analysis.outcome);
    CHECK(registered.trials > 0);
    CHECK(registered.undefined < 0.5);
    CHECK(std::isfinite(registered.median));
  }
}

TEST_CASE("signals that a procedure sets are told from noise of every size, on either side of it") {
  for (const double standard : {0.0, 500.0, -500.0}) {
    for (const int side : {-1, 1}) {
      CAPTURE(standard, side);
      Protocol protocol = shipped_protocol("lee2007-delay");
      protocol.series.front() = {"all", {standard - 400, standard + 400}, standard};
      AdaptiveProcedure& procedure = protocol.design.procedure.emplace();
      procedure.staircase = {.up = 1, .down = 2, .step_up = 1.2, .step_down = 1.2, .multiplicative = true};
      procedure.starts = {200};
      procedure.clamp = {1, 400};
      procedure.sides = {side};
      procedure.trials = 200;
      TaskPrecisionQuestion question;
      question.noise = 100;
      question.participants = 30;
      const auto rows = task_precision(protocol, question);
      CHECK(row_of(rows, protocol, "threshold").median == Approx(100 / std::sqrt(2.0)).epsilon(0.15));
      CHECK(row_of(rows, protocol, "correct").median > 0.7);
    }
  }
}

// A protocol as a question about its precision.

TEST_CASE("the question about the published design") {
  const Protocol protocol = load_protocol(protocols_folder() / "chinello2017.json");
  const PrecisionQuestion question = precision_question(protocol);
  CHECK(question.jnds == std::vector<double>{283.5, 351, 208.5});
  CHECK(question.design.differences == std::vector<double>{400, 300, 200});
  CHECK(question.design.trials == 12);
  CHECK(question.design.class_sizes == ClassSizes::random);
  CHECK(question.design.correction == Correction::loglinear);
  CHECK(question.participants == 18);
  CHECK(question.contrasts == std::vector<std::array<int, 2>>{{0, 1}, {0, 2}, {1, 2}});
  CHECK(planned_jnd(protocol, "V").source == JndSource::published);
  CHECK(precision_note(protocol).empty());
}

TEST_CASE("a study of very many people is drawn less often, but never too seldom") {
  Protocol protocol = small_protocol(2, 3, 8, Sampling::balanced);  // six cells a participant
  protocol.design.participants = 18;
  CHECK(precision_question(protocol).experiments == 20'000);
  protocol.design.participants = 200;
  CHECK(precision_question(protocol).experiments == 8'333);
  protocol.design.participants = 100'000;
  CHECK(precision_question(protocol).experiments == 1'000);
}

TEST_CASE("without published values the Weber fraction of the cues, without contrasts every pair") {
  Protocol protocol = small_protocol(2, 3, 8, Sampling::balanced);
  const PrecisionQuestion question = precision_question(protocol);
  const PlannedJnd planned = planned_jnd(protocol, "c1");
  CHECK(planned.source == JndSource::assumed);
  // Force, force and vibration, force.
  const double alone = planned_jnd(protocol, "c0").value;
  CHECK(alone == Approx(0.315 * protocol.stimulus.reference));
  CHECK(planned.value == Approx(0.24505 * protocol.stimulus.reference).epsilon(1e-5));
  CHECK(question.jnds == std::vector<double>{alone, planned.value, alone});
  CHECK(question.design.class_sizes == ClassSizes::balanced);
  CHECK(question.contrasts == std::vector<std::array<int, 2>>{{0, 1}, {0, 2}, {1, 2}});
  protocol.published = {{"c1", "rating", 3, {}, ""}, {"c1", "jnd", 120, {}, ""}};
  CHECK(planned_jnd(protocol, "c1").value == 120);
  CHECK(planned_jnd(protocol, "c0").source == JndSource::assumed);
}

TEST_CASE("what the figures do not cover is said") {
  Protocol protocol = small_protocol(2, 2, 8, Sampling::random);
  CHECK(precision_note(protocol).empty());
  protocol.analysis.jnd_method = "ml";
  CHECK(precision_note(protocol).find("registers ml with the yes-no model") != std::string::npos);
  protocol.analysis.by_delivered = true;
  CHECK(precision_note(protocol).find("nominal differences") != std::string::npos);
  protocol.analysis.jnd_method = "least_squares";
  CHECK(precision_note(protocol).find("the figures are for the nominal differences") == 0);
  protocol.analysis.model = "differencing";
  CHECK(precision_note(protocol).find("the differencing model") != std::string::npos);
}
