// The raw answers: a row for each participant, a column for each trial in the order in which it was answered.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runner/figures/figure.h"
#include "runner/figures/figure_axis.h"
#include "runner/figures/figure_style.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

constexpr double kRasterNames = 74, kRasterPlot = 720, kRasterRow = 32, kRasterHalf = 9, kRasterStrip = 3,
                 kRasterBelow = 44, kWidestCell = 16, kRasterMark = 4;
constexpr std::size_t kMostRasterRows = 24;

constexpr ShapeStyle kRight{.css_class = "within", .fill = {}, .stroke = "#5c5c5c", .stroke_width = 1.2, .dash = {}};
constexpr ShapeStyle kWrong{.css_class = "ink", .fill = "#1a1a1a", .stroke = {}, .stroke_width = 0, .dash = {}};
constexpr ShapeStyle kExcluded{
    .css_class = "faint", .fill = {}, .stroke = "#b5b5b5", .stroke_width = 1.2, .dash = "1 1.5"};

// The word of a class, without how sure somebody was.
std::string word_of_class(const Protocol& protocol, int said) {
  for (const AnswerChoice& answer : protocol.task.answers)
    if (answer.said == said) return answer.word;
  return fmt::format("{}", said + 1);
}

int classes_of(const Protocol& protocol) {
  int most = 0;
  for (const AnswerChoice& answer : protocol.task.answers) most = std::max(most, answer.said + 1);
  return most;
}

// Where a mark stands: above the line the second of two answers, below it the first; of more answers across it.
std::pair<double, double> ends_of(const RasterAnswer& answer, int classes, double middle) {
  if (classes != 2) return {middle - kRasterHalf, middle + kRasterHalf};
  return answer.said == 1 ? std::pair{middle - kRasterHalf, middle - 1} : std::pair{middle + 1, middle + kRasterHalf};
}

void draw_answer(Svg& svg, const RasterAnswer& answer, int classes, double left, double cell, double middle) {
  const auto [top, bottom] = ends_of(answer, classes, middle);
  const double x = left + cell / 2;
  if (answer.excluded) return svg.line(x, top, x, bottom, kExcluded);
  if (!answer.judged() || answer.correct()) return svg.line(x, top, x, bottom, kRight);
  const double width = std::clamp(0.7 * cell, 2.0, 6.0);
  svg.rectangle(x - width / 2, top, width, bottom - top, kWrong);
}

// Below the answers in which condition they were given.
void draw_conditions(Svg& svg, const AnswersOf& row, double left, double cell, double top, const Protocol& protocol) {
  for (std::size_t from = 0; from < row.answers.size();) {
    std::size_t to = from;
    while (to < row.answers.size() && row.answers[to].condition == row.answers[from].condition) ++to;
    const int condition = row.answers[from].condition;
    svg.begin(
        "", fmt::format("{}, trials {} to {}: {}", row.participant, from + 1, to, condition_text(protocol, condition)));
    const double begins = left + cell * static_cast<double>(from), width = cell * static_cast<double>(to - from);
    svg.rectangle(begins, top, width, kRasterStrip, condition_fill(condition));
    if (width >= 2 * kRasterMark)
      draw_marker(svg, condition, begins + kRasterMark, top + kRasterStrip / 2, kRasterMark, condition_fill(condition));
    svg.end();
    from = to;
  }
}

void draw_raster_row(Svg& svg, const AnswersOf& row, const Protocol& protocol, int classes, double cell, double top) {
  const double middle = top + kRasterHalf + 2, end = kRasterNames + cell * static_cast<double>(row.answers.size());
  svg.text(kRasterNames - 10, middle + 4, fitted(row.participant, kLabel.size, kRasterNames - 16),
           anchored(kLabel, "end"));
  svg.line(kRasterNames, middle, end, middle, kFaint);
  for (std::size_t i = 0; i < row.answers.size(); ++i)
    draw_answer(svg, row.answers[i], classes, kRasterNames + cell * static_cast<double>(i), cell, middle);
  for (std::size_t i = 0; i + 1 < row.sessions_end.size(); ++i) {
    const double x = kRasterNames + cell * static_cast<double>(row.sessions_end[i]);
    svg.line(x, top, x, top + kRasterRow - 4, kFrame);
  }
  draw_conditions(svg, row, kRasterNames, cell, middle + kRasterHalf + 4, protocol);
}

// What the marks are, in the words of the protocol's answers.
double draw_raster_legend(Svg& svg, const Protocol& protocol, int classes, bool judged) {
  constexpr double kBaseline = 24, kCell = 12;
  double x = kRasterNames;
  const auto entry = [&](const RasterAnswer& answer, const std::string& text) {
    draw_answer(svg, answer, classes, x, kCell, kBaseline - 4);
    svg.text(x + kCell + 6, kBaseline, text, kLabel);
    x += kCell + 30 + text_width(text, kLabel.size);
  };
  for (int said = classes == 2 ? 0 : classes; said < classes; ++said) {
    const std::string word = word_of_class(protocol, said);
    entry({.condition = 0, .said = said, .target = said}, judged ? word + ", right" : word);
    if (judged) entry({.condition = 0, .said = said, .target = 1 - said}, word + ", wrong");
  }
  if (classes != 2 && judged) {
    entry({.condition = 0, .said = 0, .target = 0}, "right");
    entry({.condition = 0, .said = 0, .target = 1}, "wrong");
  }
  return kBaseline + 14;
}

}  // namespace

std::vector<Figure> raster_figures(const StudyResults& results, const Protocol& protocol) {
  const int classes = classes_of(protocol);
  std::vector<AnswersOf> rows = results.answers;
  std::erase_if(rows, [](const AnswersOf& row) {
    return std::none_of(row.answers.begin(), row.answers.end(), [](const RasterAnswer& one) { return one.said >= 0; });
  });
  if (rows.empty() || classes < 2) return {};
  const std::size_t everyone = rows.size();
  rows.resize(std::min(everyone, kMostRasterRows));
  std::size_t most = 0;
  bool judged = false, excluded = false;
  std::string description;
  for (const AnswersOf& row : rows) {
    most = std::max(most, row.answers.size());
    const auto right =
        std::count_if(row.answers.begin(), row.answers.end(), [](const RasterAnswer& one) { return one.correct(); });
    const auto of =
        std::count_if(row.answers.begin(), row.answers.end(), [](const RasterAnswer& one) { return one.judged(); });
    judged = judged || of > 0;
    excluded = excluded || std::any_of(row.answers.begin(), row.answers.end(),
                                       [](const RasterAnswer& one) { return one.excluded; });
    description += of > 0 ? fmt::format("{}: {} of {} right. ", row.participant, right, of)
                          : fmt::format("{}: {}. ", row.participant,
                                        counted(static_cast<std::int64_t>(row.answers.size()), "answer"));
  }
  if (classes != 2 && !judged) return {};  // nothing to tell apart
  const double cell = std::min(kWidestCell, kRasterPlot / static_cast<double>(most));
  std::vector<LegendEntry> legend;
  for (std::size_t i = 0; i < protocol.conditions.size(); ++i)
    legend.push_back({LegendEntry::Kind::condition, static_cast<int>(i), condition_title(protocol.conditions[i])});
  constexpr double kWidth = kRasterNames + kRasterPlot + 16, kLegendTop = 38;
  const double top = kLegendTop + draw_legend(nullptr, legend, 0, 0, kRasterPlot) + 10;
  const double bottom = top + kRasterRow * static_cast<double>(rows.size());
  const std::string title = "Every answer";
  Svg svg("figure-raster", kWidth, bottom + kRasterBelow, title, description);
  draw_raster_legend(svg, protocol, classes, judged);
  draw_legend(&svg, legend, kRasterNames, kLegendTop, kRasterPlot);
  const Panel panel{kRasterNames, top, kRasterNames + cell * static_cast<double>(most), bottom};
  draw_x_axis(svg, panel, {0, static_cast<double>(most), panel.left, panel.right},
              "trials in the order in which they were answered", 8);
  for (std::size_t i = 0; i < rows.size(); ++i)
    draw_raster_row(svg, rows[i], protocol, classes, cell, top + kRasterRow * static_cast<double>(i));
  std::string caption = classes == 2 ? fmt::format("Above the line \"{}\", below it \"{}\"", word_of_class(protocol, 1),
                                                   word_of_class(protocol, 0))
                                     : std::string("A mark for every answer");
  caption += judged ? "; wide dark marks are wrong. " : ". ";
  caption +=
      "The line below each row has the colour of the condition, and its shape where it begins; practice and attempts that did not count are not there.";
  if (excluded) caption += " Dotted: left out of the results by a registered rule.";
  if (everyone > rows.size()) caption += fmt::format(" The first {} of {} participants.", rows.size(), everyone);
  return {{"raster", title, caption, std::move(svg)}};
}

}  // namespace jnd
