// The hierarchical model: each person's JND before and after it is drawn towards the group's, and ratios of conditions.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "data/methods/markdown_text.h"
#include "protocols/tasks/task.h"
#include "runner/drawing/figure_axis.h"
#include "runner/drawing/figure_forest.h"
#include "runner/drawing/figure_style.h"
#include "runner/figures/figure.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

constexpr double kGroupLeft = 74, kGroupRight = 74, kGroupHeight = 330, kGroupTop = 8, kGroupFoot = 48,
                 kNarrowWidth = 480, kNarrowRight = 14;
constexpr double kEdgeRoom = 12;  // of an arrow from the frame
// Of the width of a condition, from its middle.
constexpr double kSeparateAt = -0.28, kShrunkenAt = 0.06, kGroupAt = 0.32;

const StudyHierarchical* model_of(const StudyResults& results) {
  return results.hierarchical && results.hierarchical->fitted() ? &*results.hierarchical : nullptr;
}

bool is_drawn(const HierarchicalPerson& person) {
  return person.status != ShrunkenStatus::missing;
}

// The first of the people, at most kMostPeopleDrawn.
std::vector<const HierarchicalPerson*> people_drawn(const StudyHierarchical& model) {
  std::vector<const HierarchicalPerson*> drawn;
  std::size_t people = 0;
  for (const HierarchicalPerson& one : model.people) {
    if (!is_drawn(one)) continue;
    if ((drawn.empty() || drawn.back()->participant != one.participant) && ++people > kMostPeopleDrawn) break;
    drawn.push_back(&one);
  }
  return drawn;
}

// Everything of the model, and separate JNDs that do not lie far beyond it. Low > high: nothing has a JND.
Range jnd_range(const StudyHierarchical& model, const std::vector<const HierarchicalPerson*>& people) {
  constexpr double kFarBeyond = 3;
  Range range{kInf, 0};
  const auto add = [&range](double value) {
    if (!(value > 0) || !std::isfinite(value)) return;
    range.low = std::min(range.low, value);
    range.high = std::max(range.high, value);
  };
  for (const HierarchicalCondition& one : model.conditions) {
    add(one.jnd);
    if (one.status != SlopeStatus::ok) continue;
    add(std::max(one.ci_low, one.jnd / kFarBeyond));
    add(std::min(one.ci_high, one.jnd * kFarBeyond));
  }
  for (const HierarchicalPerson* one : people) add(one->jnd);
  const Range core = range;
  for (const HierarchicalPerson* one : people)
    if (!(core.low <= core.high) || (one->separate > core.low / kFarBeyond && one->separate < core.high * kFarBeyond))
      add(one->separate);
  return range;
}

// "S", or of several standards "S, 500".
template <typename Row>
std::string row_name(const Row& row, const Protocol& protocol) {
  const std::string& name = condition_text(protocol, row.condition);
  if (judged_standard_count(protocol) < 2) return name;
  return fmt::format("{}, {}", name, protocol.series[static_cast<std::size_t>(row.standard)].name);
}

std::string separate_text(const HierarchicalPerson& person) {
  return person.separate_status == JndStatus::ok ? size_text(person.separate)
                                                 : std::string(to_string(person.separate_status));
}

std::string person_words(const HierarchicalPerson& person, const Protocol& protocol) {
  std::string text =
      fmt::format("{}, {}: separate {}", person.participant, row_name(person, protocol), separate_text(person));
  if (person.status == ShrunkenStatus::ok)
    text += fmt::format(", shrunken {} {}", size_text(person.jnd), unit_of(protocol));
  return text;
}

std::string group_words(const HierarchicalCondition& row, const Protocol& protocol) {
  const std::string name = row_name(row, protocol);
  if (row.status != SlopeStatus::ok) return fmt::format("{}: {}", name, word_of(kSlopeStatusWords, row.status));
  return fmt::format("{}: group {} {}, 95 % interval {}", name, size_text(row.jnd), unit_of(protocol),
                     row.ci_status == EndsStatus::ok ? range_text(size_text(row.ci_low), size_text(row.ci_high))
                                                     : std::string(word_of(kEndsStatusWords, row.ci_status)));
}

class ShrinkageDrawing {
 public:
  ShrinkageDrawing(const StudyHierarchical& model, std::vector<const HierarchicalPerson*> people,
                   const Protocol& protocol, const Range& range, bool narrow)
      : model_(model), people_(std::move(people)), protocol_(protocol), narrow_(narrow) {
    const double columns = static_cast<double>(model.conditions.size());
    const double right = narrow ? kNarrowRight : kGroupRight;
    width_ = narrow ? kNarrowWidth
                    : std::max(kNarrowWidth, kGroupLeft + columns * std::clamp(600 / columns, 84.0, 190.0) + right);
    scale_ = {range.low, range.high, 1, 0, true};  // what is on it, before where
    const double top = kGroupTop + draw_legend(nullptr, legend(), 0, 0, width_ - kGroupLeft - 10) + 8;
    panel_ = {kGroupLeft, top, width_ - right, top + kGroupHeight};
    slot_ = panel_.width() / columns;
    scale_.low_pixel = panel_.bottom - kEdgeRoom;
    scale_.high_pixel = panel_.top + kEdgeRoom;
    radius_ = people_.size() <= 30 * model.conditions.size() && slot_ > 100 ? 3.8 : 2.6;
  }
  Svg drawn(const std::string& id, const std::string& title, const std::string& description);

 private:
  std::vector<LegendEntry> legend() const;
  // Whether the separate JND lies on the scale. Otherwise an arrow at the edge, or a cross, stands for it.
  bool has_place(const HierarchicalPerson& person) const {
    return person.separate_status == JndStatus::ok && scale_.inside(person.separate);
  }
  // Of the row's column.
  template <typename Row>
  double middle(const Row& row) const {
    const auto column = static_cast<double>(row_of(model_, protocol_, row.condition, row.standard));
    return panel_.left + slot_ * (column + 0.5);
  }
  void draw_person(Svg& svg, const HierarchicalPerson& person) const;
  void draw_group(Svg& svg, const HierarchicalCondition& row) const;

  const StudyHierarchical& model_;
  std::vector<const HierarchicalPerson*> people_;
  const Protocol& protocol_;
  bool narrow_;
  double width_ = 0, slot_ = 0, radius_ = 0;
  Panel panel_;
  Scale scale_;
};

std::vector<LegendEntry> ShrinkageDrawing::legend() const {
  using Kind = LegendEntry::Kind;
  const std::string jnd = jnd_title(protocol_);
  std::vector<LegendEntry> entries = {{Kind::hollow, 0, "separate " + jnd},
                                      {Kind::condition, 0, "shrunken " + jnd},
                                      {Kind::interval, 0, "group, 95 % interval"}};
  const auto any = [this](auto is) { return std::any_of(people_.begin(), people_.end(), is); };
  if (any([this](const HierarchicalPerson* one) {
        return !has_place(*one) && one->separate_status != JndStatus::no_information;
      }))
    entries.push_back({Kind::arrow, 0, "none, or beyond the scale"});
  if (any([](const HierarchicalPerson* one) { return one->separate_status == JndStatus::no_information; }))
    entries.push_back({Kind::cross, 0, "no information"});
  return entries;
}

void ShrinkageDrawing::draw_person(Svg& svg, const HierarchicalPerson& person) const {
  const double from_x = middle(person) + kSeparateAt * slot_, to_x = middle(person) + kShrunkenAt * slot_;
  const bool shrunken = person.status == ShrunkenStatus::ok;
  const double to_y = shrunken ? scale_.clipped(person.jnd) : panel_.bottom - kEdgeRoom;
  const bool inside = has_place(person);
  const bool up = person.separate_status == JndStatus::no_sensitivity ||
                  (person.separate_status == JndStatus::ok && person.separate > scale_.high);
  const bool placed = person.separate_status != JndStatus::no_information;
  const double from_y = inside ? scale_.at(person.separate) : up ? panel_.top + 8 : panel_.bottom - 8;
  svg.begin("point", person_words(person, protocol_));
  if (shrunken && placed) svg.line(from_x, from_y, to_x, to_y, kFaint);
  if (!placed)
    draw_cross(svg, from_x, shrunken ? to_y : from_y, radius_, condition_line(person.condition));
  else if (inside)
    draw_marker(svg, person.condition, from_x, from_y, radius_, condition_hollow(person.condition));
  else
    draw_arrow(svg, from_x, from_y, radius_, up, condition_hollow(person.condition));
  if (shrunken) draw_marker(svg, person.condition, to_x, to_y, radius_, condition_fill(person.condition));
  svg.end();
}

void ShrinkageDrawing::draw_group(Svg& svg, const HierarchicalCondition& row) const {
  const double x = middle(row) + kGroupAt * slot_;
  svg.begin("mean", group_words(row, protocol_));
  if (row.status == SlopeStatus::ok) {
    if (row.ci_status == EndsStatus::ok) svg.line(x, scale_.clipped(row.ci_low), x, scale_.clipped(row.ci_high), kInk);
    for (const double end : {row.ci_low, row.ci_high})  // an open end has no cap
      if (scale_.inside(end)) svg.line(x - 5, scale_.at(end), x + 5, scale_.at(end), kInk);
    svg.circle(x, scale_.clipped(row.jnd), 5, kInkFill);
  }
  svg.end();
  TextStyle name = strong(anchored(kLabel, "middle"));
  name.size = 13;
  svg.text(middle(row), panel_.bottom + 20, fitted(row_name(row, protocol_), name.size, slot_ - 8), name);
  const std::string below = row.status == SlopeStatus::ok ? fmt::format("n = {}", row.participants)
                                                          : std::string(word_of(kSlopeStatusWords, row.status));
  svg.text(middle(row), panel_.bottom + 36, fitted(below, kMuted.size, slot_ - 4), anchored(kMuted, "middle"));
}

Svg ShrinkageDrawing::drawn(const std::string& id, const std::string& title, const std::string& description) {
  Svg svg(fmt::format("figure-{}{}", id, narrow_ ? "-narrow" : ""), width_, panel_.bottom + kGroupFoot, title,
          description);
  draw_legend(&svg, legend(), panel_.left, kGroupTop, width_ - kGroupLeft - 10);
  draw_grid_rows(svg, panel_, scale_, 6);
  draw_y_axis(svg, panel_, scale_, fmt::format("{} ({})", jnd_title(protocol_), unit_of(protocol_)), 6);
  const std::vector<JudgedStandard> standards = judged_standards(protocol_);
  const double standard = standards.size() == 1 ? standards.front().value : 0;
  if (!narrow_ && standard > 0) draw_right_axis(svg, panel_, scale_, 100 / standard, " %", "Weber fraction", 6);
  svg.rectangle(panel_.left, panel_.top, panel_.width(), panel_.height(), kFrame);
  for (const HierarchicalPerson* one : people_) draw_person(svg, *one);
  for (const HierarchicalCondition& row : model_.conditions) draw_group(svg, row);
  return svg;
}

std::string ratio_numbers(const HierarchicalRatio& row) {
  const std::string p = p_text(row.p);
  if (!row.defined) return "no ratio, " + p;
  const std::string interval = row.ci_status == EndsStatus::ok
                                   ? range_text(row.ci_low, row.ci_high, 2)
                                   : "interval " + std::string(word_of(kEndsStatusWords, row.ci_status));
  return fmt::format("{} ({}), {}", number_text(row.ratio, 2), interval, p);
}

}  // namespace

std::vector<Figure> hierarchical_figures(const StudyResults& results, const Protocol& protocol) {
  const StudyHierarchical* model = model_of(results);
  if (model == nullptr) return {};
  const std::vector<const HierarchicalPerson*> people = people_drawn(*model);
  Range range = jnd_range(*model, people);
  if (!(range.low <= range.high)) return {};  // nobody has a JND
  range = ratio_range(range.low, range.high);
  const std::string id = "people", title = "People and group";
  std::string description;
  for (const HierarchicalCondition& row : model->conditions) description += group_words(row, protocol) + ". ";
  const bool alike = model->alike() && model->participants > 1 &&
                     std::any_of(people.begin(), people.end(),
                                 [](const HierarchicalPerson* one) { return one->status == ShrunkenStatus::ok; });
  const std::string caption = fmt::format(
      "Each participant's separate {} ({}), joined to the one given everybody's answers, which is drawn towards the "
      "group as far as the participant's answers are few; beside them that of the median person with its 95 % "
      "profile interval, by the hierarchical model of {} participants{}. The axis is logarithmic. An arrow at the edge "
      "is a separate estimate without a JND, or beyond the scale; a cross one without information. {}{}{}",
      jnd_title(protocol), model->separate, model->participants,
      model->status == HierarchicalStatus::ok ? "" : " (" + model->reason + ")",
      alike ? std::string(kPeopleAlike) + " " : "", hierarchical_assumptions(*model),
      first_of(std::min(kMostPeopleDrawn, static_cast<std::size_t>(model->participants)),
               static_cast<std::size_t>(model->participants)));
  return {{id, title, caption, ShrinkageDrawing(*model, people, protocol, range, false).drawn(id, title, description),
           ShrinkageDrawing(*model, people, protocol, range, true).drawn(id, title, description)}};
}

std::vector<Figure> ratio_figures(const StudyResults& results, const Protocol& protocol) {
  const StudyHierarchical* model = model_of(results);
  if (model == nullptr || model->ratios.empty()) return {};
  Forest forest;
  forest.id = "figure-ratios";
  forest.title = "Ratios of conditions";
  forest.ratios = true;
  ForestColumn& column = forest.columns.emplace_back();
  const std::string jnd = jnd_title(protocol);
  column.x_title = jnd == "JND" ? "ratio of JNDs" : "ratio, " + jnd;
  for (const HierarchicalRatio& row : model->ratios) {
    const bool several = judged_standard_count(protocol) > 1;
    const std::string name =
        fmt::format("{} : {}{}", condition_text(protocol, row.a), condition_text(protocol, row.b),
                    several ? ", " + protocol.series[static_cast<std::size_t>(row.standard)].name : "");
    const std::string numbers = ratio_numbers(row), words = fmt::format("{}: {}", name, numbers);
    forest.description += words + ". ";
    column.rows.push_back(
        {name, row.ratio, row.ci_low, row.ci_high, numbers, fmt::format("{}; n = {}", words, row.participants)});
  }
  Forest narrow = forest;
  narrow.names = 90;
  narrow.plot = 200;
  narrow.numbers = 184;
  return {{"ratios", forest.title,
           fmt::format(
               "{} of the first condition over that of the second, of the median person, with its 95 % profile "
               "interval, by the hierarchical model; p: likelihood ratio, each alone. The axis is logarithmic, and the "
               "dotted line is no difference. An interval without an end goes on to the edge; a cross: one of the two "
               "has none.",
               capitalised(jnd)),
           draw_forest(forest), draw_forest(narrow, false)}};
}

}  // namespace jnd
