// Figures: well formed, no participant dropped, nothing that is not a number.
#include "runner/figures/figure.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/numerics/special_values.h"
#include "data/fields/number_text.h"
#include "runner/drawing/figure_style.h"
#include "runner/figures/figure_conditions.h"
#include "runner/results/result_format.h"
#include "tests/catch.h"
#include "tests/runner/markup_check.h"
#include "tests/runner/report_fixture.h"

using namespace jnd;

namespace {

constexpr std::size_t kJnd = 1;  // among the outcomes of pairs

const Figure& figure_named(const std::vector<Figure>& figures, std::string_view id) {
  for (const Figure& figure : figures)
    if (figure.id == id) return figure;
  throw std::runtime_error("no figure " + std::string(id));
}

// Attribute values that a reader of SVG would take for numbers but are none.
bool has_odd_numbers(const std::string& svg) {
  for (const char* odd : {"\"nan", "\"inf", "\"-inf", "\"-nan", ",nan", ",inf", "(nan", "(inf"})
    if (svg.find(odd) != std::string::npos) return true;
  return false;
}

void check_figures(const std::vector<Figure>& figures) {
  std::set<std::string> ids;
  for (const Figure& figure : figures) {
    INFO(figure.id);
    CHECK(ids.insert(figure.id).second);
    CHECK(figure.id.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") == std::string::npos);
    CHECK(markup_problem(figure.svg.file()).empty());
    CHECK(markup_problem(figure.svg.element()).empty());
    CHECK_FALSE(has_odd_numbers(figure.svg.file()));
    CHECK(figure.svg.file().find("<desc") != std::string::npos);
    if (figure.narrow) {
      CHECK(markup_problem(figure.narrow->element()).empty());
      CHECK_FALSE(has_odd_numbers(figure.narrow->element()));
      CHECK(figure.narrow->width() <= 500);
    }
    CHECK_FALSE(figure.caption.empty());
  }
}

// Everyone's answers under every condition, the same in every series.
std::vector<CellCounts> same_answers(const Protocol& protocol, int participants, Counts counts) {
  std::vector<CellCounts> cells = invented_counts(protocol, participants, 1);
  for (CellCounts& cell : cells) cell.counts = counts;
  return cells;
}

}  // namespace

TEST_CASE("points of a swarm do not cover each other where there is room") {
  const std::vector<double> heights(9, 50.0);
  const std::vector<double> offsets = swarm_offsets(heights, 3, 40);
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    CHECK(std::abs(offsets[i]) <= 40);
    for (std::size_t j = 0; j < i; ++j) CHECK(std::abs(offsets[i] - offsets[j]) >= 6);
  }
  for (const double offset : swarm_offsets(std::vector<double>(500, 1.0), 3, 20)) CHECK(std::abs(offset) <= 20);
  CHECK(swarm_offsets({}, 3, 20).empty());
}

TEST_CASE("a usual study has every figure, with every participant in it") {
  const Protocol protocol = published_protocol();
  const StudyResults results = invented_study(protocol, 18);
  const std::vector<Figure> figures = study_figures(results, protocol);
  check_figures(figures);
  REQUIRE(figures.size() == 9);
  const std::string slopes = figure_named(figures, "slopes").svg.file();
  CHECK(count_of(slopes, "class=\"panel\"") == 18);
  CHECK(count_of(slopes, "class=\"point\"") == 18 * 9);
  const std::string jnds = figure_named(figures, "jnd").svg.file();
  CHECK(count_of(jnds, "class=\"published-value\"") == 3);
  CHECK(jnds.find("Weber fraction") != std::string::npos);
  CHECK(jnds.find("within-subject") != std::string::npos);
  CHECK(count_of(figure_named(figures, "time").svg.file(), "class=\"point\"") == 18 * 3);
  CHECK(count_of(figure_named(figures, "rating-1").svg.file(), "class=\"point\"") == 18 * 3);
  const std::string models = figure_named(figures, "sensitivity").svg.file();
  for (const SensitivityRow& row : results.sensitivity)
    CHECK(models.find(escape_markup(describe(row.method).substr(0, 20))) != std::string::npos);
}

TEST_CASE("the hierarchical model has its figures where it was added: who is drawn towards the group, and ratios",
          "[long]") {
  const Protocol protocol = published_protocol();
  StudyResults results = invented_study(protocol, 18);
  results.hierarchical = study_hierarchical(results.task, protocol);
  StudyHierarchical& model = *results.hierarchical;
  const std::vector<Figure> figures = study_figures(results, protocol);
  check_figures(figures);
  CHECK(figures.size() == 9 + 3);
  const Figure& people = figure_named(figures, "people");
  REQUIRE(people.narrow);
  for (const Svg* svg : {&people.svg, &*people.narrow}) {
    CHECK(count_of(svg->file(), "class=\"point\"") == 18 * 3);
    CHECK(count_of(svg->file(), "class=\"mean\"") == 3);
  }
  CHECK(people.caption.find(hierarchical_assumptions(model)) != std::string::npos);
  const Figure& predictive = figure_named(figures, "predictive");
  REQUIRE(predictive.narrow);
  for (const Svg* svg : {&predictive.svg, &*predictive.narrow})
    CHECK(count_of(svg->file(), "class=\"point\"") == 3 * 4);
  CHECK(predictive.caption.find(predictive_verdict(*model.check)) != std::string::npos);
  const Figure& ratios = figure_named(figures, "ratios");
  CHECK(count_of(ratios.svg.file(), "class=\"mean\"") == 3);
  CHECK(ratios.svg.file().find(number_text(model.ratios.front().ratio, 2)) != std::string::npos);

  // What is open, undefined or far away stays on the page; who has no trials is not drawn.
  model.conditions[0].ci_high = kInf;
  model.conditions[1] = {.condition = 1, .participants = 18, .status = SlopeStatus::no_sensitivity, .ci_high = kInf};
  model.ratios[0] = {.a = 0, .b = 1, .participants = 18, .lr = 3, .p = 0.08};
  model.ratios[1].ci_low = 0;
  model.people[0].separate = 1e9;
  model.people[2].separate_status = JndStatus::no_information;
  model.people[2].separate = kNaN;
  for (HierarchicalPerson& one : model.people) {
    if (one.condition == 1) one.status = ShrunkenStatus::no_group_jnd;
    if (one.condition == 1) one.jnd = one.ln_sd = kNaN;
    if (one.participant == "P18") one = {.participant = one.participant, .group = {}, .condition = one.condition};
  }
  const std::vector<Figure> odd = study_figures(results, protocol);
  check_figures(odd);
  CHECK(count_of(figure_named(odd, "people").svg.file(), "class=\"point\"") == 17 * 3);
  CHECK(count_of(figure_named(odd, "ratios").svg.file(), "class=\"missing\"") == 1);
  CHECK(figure_named(odd, "people").svg.file().find("no information") != std::string::npos);

  model.status = HierarchicalStatus::too_many_people;
  CHECK(study_figures(results, protocol).size() == 9);
}

TEST_CASE("every registered contrast is drawn with its numbers, and every participant's rates once") {
  const Protocol protocol = published_protocol();
  const StudyResults results = invented_study(protocol, 18);
  const std::vector<Figure> figures = study_figures(results, protocol);
  const std::string contrasts = figure_named(figures, "contrasts").svg.file();
  CHECK(count_of(contrasts, "class=\"mean\"") == protocol.analysis.contrasts.size());
  for (const ContrastRow& row : results.contrasts)
    if (row.registered)
      CHECK(contrasts.find(escape_markup(p_text(row.p) + ", registered " + p_text(row.p_registered))) !=
            std::string::npos);
  // Of 18 people under 3 conditions in 3 series.
  const std::string roc = figure_named(figures, "roc").svg.file();
  int people = 0;
  for (std::size_t at = roc.find(" participant"); at != std::string::npos; at = roc.find(" participant", at + 1)) {
    const std::size_t from = roc.rfind(": ", at);
    if (from != std::string::npos && at - from < 6) people += std::stoi(roc.substr(from + 2, at - from - 2));
  }
  CHECK(people == 18 * 9);
}

TEST_CASE("who has no JND stands at the edge, counted") {
  const Protocol protocol = published_protocol();
  std::vector<CellCounts> cells = invented_counts(protocol, 12, 5);
  for (CellCounts& cell : cells) {
    if (cell.participant == "P01") cell.counts = {6, 1, 6, 5};  // the wrong way round
    if (cell.participant == "P02") cell.counts = {6, 0, 6, 0};  // always "same"
  }
  const StudyResults results = invented_results(protocol, cells);
  const std::string svg = figure_named(jnd_figures(results, protocol), "jnd").svg.file();
  for (const TaskGroupRow& row : results.task.group) {
    if (row.outcome != kJnd) continue;
    const std::string name = protocol.conditions[static_cast<std::size_t>(row.condition)].name;
    int without = 0;
    for (const auto& [status, n] : row.without) without += n;
    for (const auto& [status, words] :
         {std::pair{"no_sensitivity", "no sensitivity"}, {"no_information", "no information"}})
      CHECK(svg.find(fmt::format("{}: {} {}", name, row.without.at(status), words)) != std::string::npos);
    CHECK(svg.find("n = " + std::to_string(row.mean.n) + " of 12") != std::string::npos);
    CHECK(row.mean.n + without == 12);
  }
  // Each participant is drawn exactly once: points, arrows of values off the scale, and the counted edges.
  std::size_t drawn = count_of(svg, "class=\"point\"");
  for (const TaskEstimateRow& row : results.task.estimates)
    if (row.estimates.values[kJnd].value)
      drawn -= svg.find("<title>" + row.participant + ", " +
                        protocol.conditions[static_cast<std::size_t>(row.condition)].name + ": ") != std::string::npos;
  CHECK(drawn == 0);
}

TEST_CASE("a value far beyond the others goes to the edge and leaves the scale alone") {
  const Protocol protocol = published_protocol();
  ConditionFigure figure;
  figure.id = "far";
  figure.title = figure.y_title = "far";
  ConditionColumn column;
  for (int i = 0; i < 10; ++i) column.points.push_back({200.0 + i, "P" + std::to_string(i)});
  column.points.push_back({50'000, "far"});
  column.participants = 11;
  column.mean = 4728;
  column.interval = PlottedInterval{4728, -5000, 14'000};
  figure.columns = {column};
  const std::string svg = draw_condition_figure(figure, protocol).file();
  CHECK(markup_problem(svg).empty());
  CHECK(svg.find("1 off the scale") != std::string::npos);
  CHECK(count_of(svg, "class=\"point\"") == 10);
  CHECK(svg.find(">20000<") == std::string::npos);  // no tick out there
}

TEST_CASE("every track is drawn in its participant's panel, and what it comes to beside it where there is that") {
  const Protocol protocol = load_protocol(JND_SOURCE_DIR "/protocols/adaptive-staircase.json");
  StudyResults results;
  const int participants = 26;
  for (int person = 1; person <= participants; ++person)
    for (int condition = 0; condition < 2; ++condition)
      for (int track = 0; track <= 2; ++track) {
        TrackRow row;
        row.participant = fmt::format("P{:02}", person);
        row.condition = condition;
        row.track = track;
        if (track > 0) row.levels = {400, 200, 300.0 + person};
        row.threshold.emplace();
        row.threshold->status = person == 1 ? AdaptiveStatus::too_few_reversals : AdaptiveStatus::ok;
        row.threshold->threshold = person == 1 ? kNaN : 250;
        results.task.tracks.push_back(row);
      }
  const std::vector<Figure> figures = track_figures(results, protocol);
  REQUIRE(figures.size() == 2);
  check_figures(figures);
  CHECK(figures.back().title.ends_with(" (2 of 2)"));
  CHECK(figures.back().svg.file().find("P26, ") != std::string::npos);
  const std::string svg = figures.front().svg.file();
  const int shown = 24;
  CHECK(count_of(svg, "<polyline") == shown * 4);
  CHECK(count_of(svg, ", track 2: 3 trials") == shown * 2);
  CHECK(count_of(svg, "<polygon") >= (shown - 1) * 2);  // and marks of conditions
  CHECK(svg.find("P24, ") != std::string::npos);
  CHECK(svg.find("P25, ") == std::string::npos);
  CHECK(figures.front().caption.find("The first ") == std::string::npos);
  CHECK(figures.front().caption.find("posterior") == std::string::npos);
  // Of the Bayesian procedure each track has its posterior's mean and band.
  for (TrackRow& row : results.task.tracks)
    if (row.track > 0) row.course = {{400, 150, 900}, {300, 180, 600}, {280, 190, 5000}};
  const std::vector<Figure> courses = track_figures(results, protocol);
  check_figures(courses);
  CHECK(count_of(courses.front().svg.file(), "<polyline") == shown * 4 * 2);
  CHECK(count_of(courses.front().svg.file(), "opacity=\"0.18\"") == shown * 4);
  CHECK(courses.front().caption.find("the JND by the posterior after each answer") != std::string::npos);
  CHECK(track_figures({}, protocol).empty());
}

TEST_CASE("every answer is a mark: what was said by its place, what was wrong by its width") {
  const Protocol protocol = published_protocol();
  StudyResults results;
  for (int person = 1; person <= 26; ++person) {
    AnswersOf one{fmt::format("P{:02}", person), {}, {4}, person == 1 ? 2 : 0};
    one.answers = {{.condition = 0, .said = 1, .target = 1},
                   {.condition = 0, .said = 0, .target = 1},
                   {.condition = 1, .said = 0, .target = 0},
                   {.condition = 1, .said = 1, .target = 0, .excluded = true}};
    results.answers.push_back(one);
  }
  const std::vector<Figure> figures = raster_figures(results, protocol);
  REQUIRE(figures.size() == 2);  // 24 people, and two more
  check_figures(figures);
  CHECK(figures[0].id == "raster-1");
  CHECK(figures[1].title == "Every answer (2 of 2)");
  CHECK(figures[1].svg.file().find("P26, trials 3 to 4: V") != std::string::npos);
  const std::string svg = figures.front().svg.file();
  const std::size_t rows = 24, in_legend = 2;  // "same" and "different", each right and wrong
  CHECK(count_of(svg, "height=\"8\" class=\"ink\"") == rows + in_legend);
  CHECK(count_of(svg, "class=\"within\"") == 2 * rows + in_legend);
  CHECK(count_of(svg, "stroke-dasharray=\"1 1.5\"") == rows);
  CHECK(svg.find("P24, trials 3 to 4: V") != std::string::npos);
  CHECK(svg.find("P25") == std::string::npos);
  CHECK(svg.find("P01: 2 of 4 right, 2 attempts did not count. P02: 2 of 4 right.") != std::string::npos);
  CHECK(figures.front().caption.find("Practice is not there, nor 2 attempts that did not count.") != std::string::npos);
  CHECK(figures.front().caption.find("left out of the results by a registered rule") != std::string::npos);
  // Answers that are numbers, and tasks without answers to tell apart, have none.
  for (AnswersOf& one : results.answers)
    for (RasterAnswer& answer : one.answers) answer.said = answer.target = -1;
  CHECK(raster_figures(results, protocol).empty());
}

TEST_CASE("many answers of a participant are folded into lines, so that no marks overlap") {
  const Protocol protocol = published_protocol();
  StudyResults results;
  const AnswersOf many{"P01", std::vector<RasterAnswer>(500, {.condition = 2, .said = 1, .target = 1}), {300, 500}, 0};
  results.answers.assign(10, many);
  const std::vector<Figure> figures = raster_figures(results, protocol);
  REQUIRE(figures.size() == 2);  // three lines each, so eight people a page
  check_figures(figures);
  const std::string svg = figures.front().svg.file();
  CHECK(count_of(svg, ">P01<") == 8);
  CHECK(count_of(svg, ">from 168<") == 8);
  CHECK(count_of(svg, ">from 335<") == 8);
  CHECK(count_of(svg, "P01, trials 335 to 500: SV") == 8);
  CHECK(svg.find("answered, 167 a line") != std::string::npos);
  CHECK(count_of(figures.back().svg.file(), "class=\"within\"") == 2 * 500 + 2);
}

TEST_CASE("figures go on where one cannot hold all") {
  const auto of = [](std::size_t count) { return figure_pages("tracks", "Levels", count, 24); };
  REQUIRE(of(24).size() == 1);
  CHECK(of(24).front().id == "tracks");
  CHECK(of(24).front().title == "Levels");
  REQUIRE(of(49).size() == 3);
  CHECK(of(49)[2].id == "tracks-3");
  CHECK(of(49)[2].title == "Levels (3 of 3)");
  CHECK(of(49)[2].from == 48);
  CHECK(of(49)[2].to == 49);
  CHECK(of(0).size() == 1);
}

TEST_CASE("a minus is as long as a plus, and hyphens stay what they are") {
  Svg svg("figure-x", 10, 10, "x", "y");
  svg.text(0, 0, "-3 (-1.5 to 2), P-01, m-5, x - 3, -", {});
  CHECK(svg.file().find(">\u22123 (\u22121.5 to 2), P-01, m-5, x - 3, -<") != std::string::npos);
}

TEST_CASE(
    "order, preference and change are columns of one figure, with a row for everyone, and say why there is no value") {
  const Protocol protocol = published_protocol();
  StudyResults results;
  for (int condition = 0; condition < 3; ++condition) {
    BehaviourRow row;
    row.condition = condition;
    row.order = order_effect(10, 20, 5, 20);
    row.bias = response_bias(Counts{20, 15, 20, 5}, 0.5);
    row.drift = drift(Counts{10, 5, 10, 4}, Counts{10, 8, 10, 2});
    row.holm = {.order = 0.4, .bias = kNaN, .drift = 0.03, .session = kNaN};
    results.behaviour.conditions.push_back(row);
    row.participant = fmt::format("P{:02}", condition + 1);
    row.condition = -1;
    if (condition == 1) {
      row.order = order_effect(0, 0, 5, 20);
      row.bias = response_bias(Counts{20, 20, 20, 20}, 0.5);
      row.drift = drift(Counts{10, 5, 0, 0}, Counts{10, 8, 10, 2});
    }
    results.behaviour.participants.push_back(row);
  }
  const std::vector<Figure> figures = behaviour_figures(results, protocol);
  check_figures(figures);
  REQUIRE(figures.size() == 1);
  const auto check_form = [](const std::string& svg, std::size_t named) {
    CHECK(count_of(svg, "class=\"mean\"") == 15);  // of each of three quantities all but one have a value
    CHECK(count_of(svg, "class=\"missing\"") == 3);
    CHECK(count_of(svg, ">S, everyone<") == named);
    CHECK(count_of(svg, ">P02<") == named);
    for (const char* words : {"S, everyone: 0.25 (", "p = .400", "P02: the stiffer never came first",
                              "P02: all answers were the same", "P02: no trial of one kind"})
      CHECK(svg.find(words) != std::string::npos);
  };
  check_form(figures[0].svg.file(), 1);  // the rows of the three columns are the same
  REQUIRE(figures[0].narrow);
  check_form(figures[0].narrow->file(), 3);
  CHECK(behaviour_figures({}, protocol).empty());
}

TEST_CASE("ratings part at the middle of their scale, every answer counted once") {
  const Protocol protocol = published_protocol();
  const StudyResults results = invented_study(protocol, 18);
  const std::vector<Figure> figures = rating_bar_figures(results, protocol);
  REQUIRE(figures.size() == 1);
  check_figures(figures);
  const std::string svg = figures.front().svg.file();
  int counted = 0;
  for (std::size_t at = svg.find(" of 18 gave "); at != std::string::npos; at = svg.find(" of 18 gave ", at + 1)) {
    const std::size_t from = svg.rfind(": ", at);
    counted += std::stoi(svg.substr(from + 2, at - from - 2));
  }
  CHECK(counted == 18 * 3);
  CHECK(svg.find("below the middle of the scale") != std::string::npos);
  StudyResults without = results;
  std::erase_if(without.comparisons, [](const OutcomeComparison& one) { return one.question; });
  CHECK(rating_bar_figures(without, protocol).empty());
}

TEST_CASE("two cues together stand against their optimal combination, who lacks a JND by name") {
  const Protocol protocol = published_protocol();
  std::vector<CellCounts> cells = invented_counts(protocol, 12, 5);
  for (CellCounts& cell : cells)
    if (cell.participant == "P07" && cell.condition == 1) cell.counts = {6, 0, 6, 6};  // the wrong way round
  const StudyResults results = invented_results(protocol, cells);
  const std::vector<Figure> figures = combination_figures(results, protocol);
  REQUIRE(figures.size() == 1);
  check_figures(figures);
  const std::string svg = figures.front().svg.file();
  CHECK(svg.find("JND predicted from S and V (N/m)") != std::string::npos);
  CHECK(svg.find("JND observed in SV (N/m)") != std::string::npos);
  CHECK(figures.front().caption.find("Without a JND in one of the three: P07.") != std::string::npos);
  CHECK(svg.find("P08: predicted ") != std::string::npos);
  CHECK(svg.find("P07: predicted ") == std::string::npos);
  CHECK(figures.front().caption.find("Off the scale") == std::string::npos);
  Protocol alone = protocol;
  alone.conditions[2].cues = alone.conditions[0].cues;
  CHECK(combination_figures(invented_results(alone, cells), alone).empty());
  // One who feels next to nothing does not squeeze the others together: at the edge, with the numbers.
  for (CellCounts& cell : cells)
    if (cell.participant == "P09") cell.counts = {500, 251, 500, 250};
  const std::vector<Figure> with_far = combination_figures(invented_results(protocol, cells), protocol);
  REQUIRE(with_far.size() == 1);
  check_figures(with_far);
  CHECK(with_far.front().caption.find("Off the scale, at its edge: P09.") != std::string::npos);
  CHECK(with_far.front().svg.file().find(">P09: predicted ") != std::string::npos);
}

TEST_CASE("where conditions differ in one number, the outcome stands against it") {
  Protocol protocol = published_protocol();
  StudyResults results = invented_study(protocol, 12);
  CHECK(parameter_figures(results, protocol).empty());  // they differ in their cues
  for (std::size_t i = 0; i < 3; ++i) {
    protocol.conditions[i].cues = {};
    protocol.conditions[i].parameters = {{"delay_ms", 60.0 - 30.0 * static_cast<double>(i)}, {"gain", 2.0}};
  }
  const std::vector<Figure> figures = parameter_figures(results, protocol);
  REQUIRE(figures.size() == 2);  // slopes are registered: JNDs stand beside them
  CHECK(figures.back().id == "parameter-jnd");
  check_figures(figures);
  const std::string svg = figures.front().svg.file();
  CHECK(count_of(svg, "class=\"point\"") == 12);
  CHECK(count_of(svg, "class=\"mean\"") == 3);
  CHECK(figures.front().title.find(" against delay (ms)") != std::string::npos);
  const OutcomeComparison& outcome = results.comparisons.front();
  double sum = 0;
  for (const ParticipantValues& one : outcome.everyone) sum += one.values[2];  // at a delay of 0
  CHECK(svg.find(fmt::format("delay (ms) 0: mean {} of 12", size_text(sum / 12))) != std::string::npos);
  protocol.conditions[1].parameters["gain"] = 3.0;  // and now in two
  CHECK(parameter_figures(results, protocol).empty());
  protocol.conditions[1].parameters["gain"] = 2.0;
  protocol.conditions[1].parameters["delay_ms"] = 60.0;  // as the first: everyone would count twice there
  CHECK(parameter_figures(results, protocol).empty());
  protocol.conditions[1].parameters["delay_ms"] = std::string("much");
  CHECK(parameter_figures(results, protocol).empty());
}

TEST_CASE("force against depth: a line for each press, the asked slope dotted, panels below one another on a phone") {
  const Protocol protocol = published_protocol();
  std::vector<PressedTrial> presses;
  for (int condition = 0; condition < 3; ++condition) {
    PressedTrial trial{"P03", 12, condition, {}};
    for (int interval = 0; interval < 2; ++interval) {
      PressTrace trace{.interval = interval,
                       .stimulus = 400 + 300.0 * interval,
                       .delivered = std::nullopt,
                       .limited = false,
                       .points = {}};
      if (condition == 0) trace.delivered = trace.stimulus - 1;
      for (int press = 0; press < 2; ++press) {
        for (int i = 1; i <= 10; ++i)
          trace.points.push_back({4e-4 * i, 0.1 * i, condition == 1 ? 0 : trace.stimulus * 4e-4 * i});
        trace.points.push_back({0, 0, 0});
      }
      trial.intervals.push_back(trace);
    }
    presses.push_back(trial);
  }
  std::vector<Figure> figures = press_figures({.trials = presses}, protocol);
  REQUIRE(figures.size() == 1);
  check_figures(figures);
  const std::string svg = figures.front().svg.file();
  CHECK(count_of(svg, "<polyline") == 3 * 2 * 2);
  CHECK(count_of(svg, "class=\"rule\"") == 2 * 2);  // nothing was asked for under vibration alone
  CHECK(svg.find("400, 700 N/m, felt as 399, 699") != std::string::npos);
  CHECK(svg.find("400, 700 N/m, no force") != std::string::npos);
  CHECK(figures.front().caption.find("a limit of the device was reached") == std::string::npos);
  REQUIRE(figures.front().narrow.has_value());
  CHECK(figures.front().narrow->width() < 360);
  CHECK(figures.front().narrow->height() > 2 * figures.front().svg.height());
  presses[0].intervals[0].limited = true;
  const Figure limited = press_figures({.trials = presses, .chosen = true}, protocol).front();
  CHECK(limited.caption.starts_with("Chosen trials"));
  CHECK(limited.caption.find("a limit of the device was reached") != std::string::npos);
  CHECK(count_of(limited.svg.file(), ">P03, S, trial 12, limited</text>") == 1);
  CHECK(count_of(limited.svg.file(), ">P03, V, trial 12</text>") == 1);
  CHECK(press_figures({}, protocol).empty());
}

TEST_CASE("studies at the limits still have figures") {
  const Protocol published = published_protocol();
  SECTION("nobody") {
    CHECK(study_figures(StudyResults{}, published).empty());
  }
  SECTION("one participant") {
    check_figures(study_figures(invented_study(published, 1), published));
  }
  SECTION("one condition") {
    Protocol protocol = published;
    protocol.conditions.resize(1);
    protocol.analysis.contrasts.clear();
    const std::vector<Figure> figures = study_figures(invented_study(protocol, 6), protocol);
    check_figures(figures);
    CHECK(figures.size() >= 4);
  }
  SECTION("twelve conditions") {
    Protocol protocol = published;
    for (int i = 3; i < 12; ++i) {
      protocol.conditions.push_back(protocol.conditions[0]);
      protocol.conditions.back().name = "condition number " + std::to_string(i);
      protocol.conditions.back().label = std::string(80, 'x');
    }
    check_figures(study_figures(invented_study(protocol, 5), protocol));
  }
  SECTION("everyone left out: always the same answer") {
    const StudyResults results = invented_results(published, same_answers(published, 6, {6, 6, 6, 6}));
    check_figures(study_figures(results, published));
    CHECK(jnd_figures(results, published)[0].svg.file().find("6 no information") != std::string::npos);
  }
  SECTION("everyone left out: the wrong way round") {
    const StudyResults results = invented_results(published, same_answers(published, 6, {6, 1, 6, 5}));
    check_figures(study_figures(results, published));
    CHECK(jnd_figures(results, published)[0].svg.file().find("6 no sensitivity") != std::string::npos);
  }
  SECTION("a class without trials") {
    const StudyResults results = invented_results(published, same_answers(published, 4, {6, 3, 0, 0}));
    check_figures(study_figures(results, published));
    CHECK(slope_figures(results, published)[0].svg.file().find("no d&#39;") != std::string::npos);
  }
  SECTION("raw rates of 0 and 1: infinite d' are arrows") {
    Protocol protocol = published;
    protocol.analysis.correction = "none";
    const StudyResults results = invented_results(protocol, same_answers(protocol, 4, {6, 6, 6, 0}));
    check_figures(study_figures(results, protocol));
    CHECK(slope_figures(results, protocol)[0].svg.file().find("infinite d&#39;") != std::string::npos);
    CHECK(jnd_figures(results, protocol)[0].svg.file().find("4 ceiling") != std::string::npos);
  }
  SECTION("the other models") {
    Protocol protocol = published;
    protocol.analysis.model = "differencing";
    protocol.analysis.jnd_method = "ml";
    check_figures(study_figures(invented_study(protocol, 3), protocol));
    protocol.analysis.model = "independent-observation";
    protocol.analysis.jnd_method = "least_squares";
    check_figures(study_figures(invented_study(protocol, 3), protocol));
  }
}

TEST_CASE("large studies: panels on pages, then one panel a condition, everyone drawn") {
  const Protocol protocol = published_protocol();
  const auto results_of_many = [&](int participants) {
    return results_of(results_of_counts(invented_counts(protocol, participants, 9), protocol, SessionKind::simulated),
                      participants, protocol);
  };
  StudyResults results = results_of_many(50);
  std::vector<Figure> figures = slope_figures(results, protocol);
  check_figures(figures);
  REQUIRE(figures.size() == 3);
  std::size_t panels = 0;
  for (const Figure& figure : figures) panels += count_of(figure.svg.file(), "class=\"panel\"");
  CHECK(panels == 50);
  results = results_of_many(200);
  figures = study_figures(results, protocol);
  check_figures(figures);
  const std::string slopes = figure_named(figures, "slopes").svg.file();
  CHECK(count_of(slopes, "class=\"panel\"") == 3);
  CHECK(count_of(slopes, "<circle") >= 200 * 3);  // condition S: every series of everyone
  std::size_t points = count_of(figure_named(figures, "jnd").svg.file(), "class=\"point\""), have = 0;
  for (const TaskGroupRow& row : results.task.group)
    if (row.outcome == kJnd) have += static_cast<std::size_t>(row.mean.n);
  CHECK(points <= have);
  CHECK(points + 30 > have);  // a few stand off the scale
}

TEST_CASE("names of users cannot leave their place in a figure") {
  Protocol protocol = published_protocol();
  protocol.conditions[0].name = "</text><script>alert(1)</script>";
  protocol.conditions[1].label = "\" onload=\"x";
  protocol.conditions[2].name = "\xe2\x80\xae evil";
  std::vector<CellCounts> cells = invented_counts(protocol, 3, 5);
  for (CellCounts& cell : cells) cell.participant = "<svg/onload=x>" + cell.participant;
  const std::vector<Figure> figures = study_figures(invented_results(protocol, cells), protocol);
  check_figures(figures);
  for (const Figure& figure : figures) {
    CHECK(figure.svg.file().find("<script") == std::string::npos);
    CHECK(figure.svg.file().find("\" onload=\"") == std::string::npos);
    CHECK(figure.svg.file().find("\xe2\x80\xae") == std::string::npos);
  }
}

TEST_CASE("equal stimuli that count as their series' stay in their panel", "[long]") {
  Protocol protocol = published_protocol();
  protocol.analysis.model = "independent-observation";
  const StudyResults results = results_of(
      results_of_counts(invented_counts(protocol, 8, 5), protocol, SessionKind::simulated), 8, protocol, true);
  REQUIRE(results.hierarchical->check);
  const Figure predictive = figure_named(study_figures(results, protocol), "predictive");
  CHECK(predictive.caption.find("Below 0: equal stimuli") != std::string::npos);
  // By condition, then level, from left to right.
  const std::string svg = predictive.svg.file(), group = "<g class=\"point\">", attribute = "x1=\"";
  std::vector<double> bands;
  for (std::size_t at = svg.find(group); at != std::string::npos; at = svg.find(group, at + 1))
    bands.push_back(std::stod(svg.substr(svg.find(attribute, at) + attribute.size())));
  CHECK(bands.size() == 3 * 6);
  CHECK(std::is_sorted(bands.begin(), bands.end()));
}
