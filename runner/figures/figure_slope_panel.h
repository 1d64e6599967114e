// One panel of d' against the stiffness difference: what is in it, and how it is drawn. Used by figure_slopes.cpp.
#pragma once

#include <string>
#include <vector>

#include "data/results/study_analysis.h"
#include "protocols/protocol.h"
#include "runner/drawing/figure_axis.h"
#include "runner/drawing/figure_style.h"

namespace jnd {

struct SlopePoint {
  double difference = 0;  // > 0, in the study's unit
  double dprime = 0;      // of the registered model; infinite at a rate of 0 or 1, NaN where a class is missing
  std::string words;      // tooltip
};

// One participant under one condition.
struct SlopeCurve {
  int condition = 0;
  std::vector<SlopePoint> points;
  double slope = 0;  // NaN: no line; inf at the ceiling
  JndStatus status = JndStatus::ok;
};

struct SlopePanel {
  std::string title;  // the participant
  std::vector<SlopeCurve> curves;
  std::string undefined = {};  // who has no JND: "V no_sensitivity"
};

// One for each participant, in the analysis's order.
std::vector<SlopePanel> slope_panels(const StudyAnalysis& analysis, const Protocol& protocol);

struct SlopeScales {
  Range difference, dprime;
  int conditions = 1;  // among which points are moved sideways
};
SlopeScales slope_scales(const std::vector<SlopePanel>& panels);

struct PanelParts {
  bool y_labels = true, x_labels = true, points_named = true;
};
void draw_slope_panel(Svg& svg, const Panel& panel, const SlopePanel& content, const SlopeScales& scales,
                      const PanelParts& parts);

}  // namespace jnd
