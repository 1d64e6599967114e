// A protocol as a question about its precision.
#include "protocols/planning/planned_precision.h"

#include "protocols/reading/protocol_json.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"

using namespace jnd;
using namespace jnd::test;

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
