// The posterior predictive check of the hierarchical model: what was answered, beside what the model draws.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runner/drawing/figure_axis.h"
#include "runner/drawing/figure_style.h"
#include "runner/figures/figure.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

constexpr double kCheckLeft = 64, kCheckTop = 8, kCheckHeight = 180, kCheckBetween = 18, kCheckName = 22,
                 kCheckFoot = 44, kCheckRight = 14, kCheckWide = 200, kCheckNarrow = 184, kCheckCap = 4,
                 kCheckBeside = 5;
constexpr std::size_t kCheckColumns = 4, kNarrowCheckColumns = 2;

std::string row_words(const PredictiveRow& row, const Protocol& protocol) {
  return fmt::format("{}, {} {}: {} \"different\", drawn {}", condition_text(protocol, static_cast<int>(row.condition)),
                     size_text(row.level), unit_of(protocol), percent_text(row.share.observed),
                     range_text(percent_text(row.share.low), percent_text(row.share.high)));
}

class PredictiveDrawing {
 public:
  PredictiveDrawing(const PredictiveCheck& check, const Protocol& protocol, bool narrow)
      : check_(check), protocol_(protocol), narrow_(narrow), side_(narrow ? kCheckNarrow : kCheckWide) {
    for (const PredictiveRow& row : check.rows) {
      if (conditions_.empty() || conditions_.back() != row.condition) conditions_.push_back(row.condition);
      least_ = std::min(least_, row.level);
      most_ = std::max(most_, row.level);
    }
    columns_ = std::min(conditions_.size(), narrow ? kNarrowCheckColumns : kCheckColumns);
    width_ = std::max(narrow ? 360.0 : 420.0,
                      kCheckLeft + static_cast<double>(columns_) * (side_ + kCheckBetween) + kCheckRight);
    top_ = kCheckTop + draw_legend(nullptr, legend(), 0, 0, width_ - kCheckLeft);
  }
  Svg drawn(const std::string& id, const std::string& title, const std::string& description) const;

 private:
  static std::vector<LegendEntry> legend() {
    using Kind = LegendEntry::Kind;
    return {{Kind::condition, 0, "answered"}, {Kind::interval, 0, "95 % of what the model draws"}};
  }
  void draw_panel(Svg& svg, std::size_t place) const;

  const PredictiveCheck& check_;
  const Protocol& protocol_;
  bool narrow_;
  double side_;                          // width of a panel
  std::vector<std::size_t> conditions_;  // with trials
  std::size_t columns_ = 1;
  double least_ = 0, most_ = 0;  // of the levels, and 0
  double width_ = 0, top_ = 0;
};

void PredictiveDrawing::draw_panel(Svg& svg, std::size_t place) const {
  const std::size_t condition = conditions_[place], column = place % columns_, row = place / columns_;
  const double left = kCheckLeft + static_cast<double>(column) * (side_ + kCheckBetween),
               top = top_ + kCheckName + static_cast<double>(row) * (kCheckName + kCheckHeight + kCheckFoot);
  const Panel panel{left, top, left + side_, top + kCheckHeight};
  const Scale y{0, 1, panel.bottom, panel.top};
  const double most = most_ > 0 ? most_ : 1, spare = 0.08 * (most - least_);
  const Scale x{least_ - spare, most + spare, panel.left, panel.right};
  svg.text(panel.left, panel.top - 7, fitted(condition_text(protocol_, static_cast<int>(condition)), 12, side_),
           strong(kLabel));
  draw_grid_rows(svg, panel, y, 5);
  if (column == 0) {
    const Scale percent{0, 100, panel.bottom, panel.top};
    draw_y_axis(svg, panel, percent, "answers \"different\" (%)", 5);
  }
  draw_x_axis(svg, panel, x, fmt::format("difference ({})", unit_of(protocol_)), least_ < 0 ? 6 : 4);
  svg.rectangle(panel.left, panel.top, panel.width(), panel.height(), kFrame);
  const int shape = static_cast<int>(condition);
  for (const PredictiveRow& row : check_.rows) {
    if (row.condition != condition) continue;
    const double middle = x.at(row.level), band = middle + kCheckBeside;
    svg.begin("point", row_words(row, protocol_));
    svg.line(band, y.at(row.share.low), band, y.at(row.share.high), kInk);
    for (const double end : {row.share.low, row.share.high})
      svg.line(band - kCheckCap, y.at(end), band + kCheckCap, y.at(end), kInk);
    draw_marker(svg, shape, middle - kCheckBeside, y.at(row.share.observed), 4, condition_fill(shape));
    svg.end();
  }
}

Svg PredictiveDrawing::drawn(const std::string& id, const std::string& title, const std::string& description) const {
  const double rows = std::ceil(static_cast<double>(conditions_.size()) / static_cast<double>(columns_));
  Svg svg(fmt::format("figure-{}{}", id, narrow_ ? "-narrow" : ""), width_,
          top_ + rows * (kCheckName + kCheckHeight + kCheckFoot), title, description);
  draw_legend(&svg, legend(), kCheckLeft, kCheckTop, width_ - kCheckLeft);
  for (std::size_t place = 0; place < conditions_.size(); ++place) draw_panel(svg, place);
  return svg;
}

}  // namespace

std::vector<Figure> predictive_figures(const StudyResults& results, const Protocol& protocol) {
  if (!results.hierarchical || results.hierarchical->status != HierarchicalStatus::ok) return {};
  if (!results.hierarchical->check) return {};
  const PredictiveCheck& check = *results.hierarchical->check;
  if (check.rows.empty()) return {};
  const std::string id = "predictive", title = "Answers beside those that the hierarchical model draws";
  std::string description;
  for (const PredictiveRow& row : check.rows) description += row_words(row, protocol) + ". ";
  const std::string caption = fmt::format(
      "Share of \"different\" of all participants, and beside it what 95 % of {} draws have: answers of the same "
      "people to the same questions, by the hierarchical model. {}{} {}",
      check.draws,
      results.hierarchical->response == ResponseModel::independent
          ? "Below 0: equal stimuli, of the series with that difference. "
          : "",
      predictive_verdict(check), kPredictiveMeaning);
  return {{id, title, caption, PredictiveDrawing(check, protocol, false).drawn(id, title, description),
           PredictiveDrawing(check, protocol, true).drawn(id, title, description)}};
}

}  // namespace jnd
