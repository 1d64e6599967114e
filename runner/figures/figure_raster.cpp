// The raw answers: a row for each participant, a column for each trial in the order in which it was answered.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runner/drawing/figure_axis.h"
#include "runner/drawing/figure_style.h"
#include "runner/figures/figure.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

constexpr double kRasterNames = 74, kRasterPlot = 720, kRasterRow = 32, kRasterHalf = 9, kRasterStrip = 3,
                 kRasterBelow = 44, kWidestCell = 16, kRasterMark = 4;
constexpr std::size_t kMostInLine = 240;  // answers: more take further lines of their participant

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

// Answers from..to-1 of a participant, side by side.
struct RasterLine {
  const AnswersOf* of;
  std::size_t from, to;
};

// Below the answers in which condition they were given.
void draw_conditions(Svg& svg, const RasterLine& line, double left, double cell, double top, const Protocol& protocol) {
  const AnswersOf& row = *line.of;
  for (std::size_t from = line.from; from < line.to;) {
    std::size_t to = from;
    while (to < line.to && row.answers[to].condition == row.answers[from].condition) ++to;
    const int condition = row.answers[from].condition;
    svg.begin(
        "", fmt::format("{}, trials {} to {}: {}", row.participant, from + 1, to, condition_text(protocol, condition)));
    const double begins = left + cell * static_cast<double>(from - line.from),
                 width = cell * static_cast<double>(to - from);
    svg.rectangle(begins, top, width, kRasterStrip, condition_fill(condition));
    if (width >= 2 * kRasterMark)
      draw_marker(svg, condition, begins + kRasterMark, top + kRasterStrip / 2, kRasterMark, condition_fill(condition));
    svg.end();
    from = to;
  }
}

void draw_raster_line(Svg& svg, const RasterLine& line, const Protocol& protocol, int classes, double cell,
                      double top) {
  const AnswersOf& row = *line.of;
  const auto across = [&](std::size_t answer) { return kRasterNames + cell * static_cast<double>(answer - line.from); };
  const double middle = top + kRasterHalf + 2;
  const bool first = line.from == 0;
  svg.text(kRasterNames - 10, middle + 4,
           first ? fitted(row.participant, kLabel.size, kRasterNames - 16) : fmt::format("from {}", line.from + 1),
           anchored(first ? kLabel : kMuted, "end"));
  svg.line(kRasterNames, middle, across(line.to), middle, kFaint);
  for (std::size_t i = line.from; i < line.to; ++i) draw_answer(svg, row.answers[i], classes, across(i), cell, middle);
  for (const std::size_t end : row.sessions_end)
    if (end < row.answers.size() && end > line.from && end <= line.to)
      svg.line(across(end), top, across(end), top + kRasterRow - 4, kFrame);
  draw_conditions(svg, line, kRasterNames, cell, middle + kRasterHalf + 4, protocol);
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

// What is in the rows of all pages.
struct RasterContent {
  bool judged = false, excluded = false;
  std::int64_t voided = 0;
};

RasterContent content_of(const std::vector<AnswersOf>& rows) {
  RasterContent content;
  for (const AnswersOf& row : rows) {
    content.voided += row.voided;
    for (const RasterAnswer& answer : row.answers) {
      content.judged = content.judged || answer.judged();
      content.excluded = content.excluded || answer.excluded;
    }
  }
  return content;
}

// "P01: 61 of 108 right, 2 attempts did not count. "
std::string row_words(const AnswersOf& row) {
  const auto right =
      std::count_if(row.answers.begin(), row.answers.end(), [](const RasterAnswer& one) { return one.correct(); });
  const auto of =
      std::count_if(row.answers.begin(), row.answers.end(), [](const RasterAnswer& one) { return one.judged(); });
  const std::string answers =
      of > 0 ? fmt::format("{} of {} right", right, of) : counted(std::ssize(row.answers), "answer");
  const std::string voided = row.voided > 0 ? fmt::format(", {} did not count", counted(row.voided, "attempt")) : "";
  return fmt::format("{}: {}{}. ", row.participant, answers, voided);
}

std::string raster_caption(const RasterContent& content, const Protocol& protocol, int classes) {
  std::string caption = classes == 2 ? fmt::format("Above the line \"{}\", below it \"{}\"", word_of_class(protocol, 1),
                                                   word_of_class(protocol, 0))
                                     : std::string("A mark for every answer");
  caption += content.judged ? "; wide dark marks are wrong. " : ". ";
  caption +=
      "The line below each row has the colour of the condition, and its shape where it begins. Practice is not there";
  caption += content.voided > 0 ? fmt::format(", nor {} that did not count.", counted(content.voided, "attempt"))
                                : std::string(".");
  if (content.excluded) caption += " Dotted: left out of the results by a registered rule.";
  return caption;
}

// lines: of the page; per_line: how many answers the longest has.
Svg draw_raster(const std::vector<RasterLine>& lines, std::size_t per_line, const FigurePage& page,
                const RasterContent& content, const Protocol& protocol, int classes) {
  const double cell = std::min(kWidestCell, kRasterPlot / static_cast<double>(per_line));
  std::vector<LegendEntry> legend;
  for (std::size_t i = 0; i < protocol.conditions.size(); ++i)
    legend.push_back({LegendEntry::Kind::condition, static_cast<int>(i), condition_title(protocol.conditions[i])});
  constexpr double kWidth = kRasterNames + kRasterPlot + 16, kLegendTop = 38;
  const double top = kLegendTop + draw_legend(nullptr, legend, 0, 0, kRasterPlot) + 10;
  const double bottom = top + kRasterRow * static_cast<double>(lines.size());
  std::string description;
  for (const RasterLine& line : lines)
    if (line.from == 0) description += row_words(*line.of);
  Svg svg("figure-" + page.id, kWidth, bottom + kRasterBelow, page.title, description);
  draw_raster_legend(svg, protocol, classes, content.judged);
  draw_legend(&svg, legend, kRasterNames, kLegendTop, kRasterPlot);
  const Panel panel{kRasterNames, top, kRasterNames + cell * static_cast<double>(per_line), bottom};
  const bool folded = std::any_of(lines.begin(), lines.end(), [](const RasterLine& line) { return line.from > 0; });
  draw_x_axis(svg, panel, {0, static_cast<double>(per_line), panel.left, panel.right},
              folded ? fmt::format("trials in the order in which they were answered, {} a line", per_line)
                     : "trials in the order in which they were answered",
              8);
  for (std::size_t i = 0; i < lines.size(); ++i)
    draw_raster_line(svg, lines[i], protocol, classes, cell, top + kRasterRow * static_cast<double>(i));
  return svg;
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
  rows.resize(std::min(everyone, kMostPeopleDrawn));
  const RasterContent content = content_of(rows);
  if (classes != 2 && !content.judged) return {};  // nothing to tell apart
  std::size_t most = 0;
  for (const AnswersOf& row : rows) most = std::max(most, row.answers.size());
  const std::size_t lines_each = (most + kMostInLine - 1) / kMostInLine,
                    per_line = (most + lines_each - 1) / lines_each;
  std::string caption = raster_caption(content, protocol, classes);
  caption += first_of(rows.size(), everyone);
  std::vector<Figure> figures;
  for (const FigurePage& page :
       figure_pages("raster", "Every answer", rows.size(), std::max<std::size_t>(1, kPeopleInFigure / lines_each))) {
    std::vector<RasterLine> lines;
    for (std::size_t i = page.from; i < page.to; ++i)
      for (std::size_t from = 0; from < rows[i].answers.size(); from += per_line)
        lines.push_back({&rows[i], from, std::min(rows[i].answers.size(), from + per_line)});
    figures.push_back({page.id, page.title, caption, draw_raster(lines, per_line, page, content, protocol, classes)});
  }
  return figures;
}

}  // namespace jnd
