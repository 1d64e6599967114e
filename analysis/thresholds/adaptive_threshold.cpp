#include "analysis/thresholds/adaptive_threshold.h"

#include <algorithm>
#include <cmath>

#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"

namespace jnd {
namespace {

AdaptiveThreshold without_threshold(AdaptiveStatus status) {
  return {status, kNaN, kNaN, 0};
}

// Without a track that is ok: pinned ones say more about the procedure than short ones, and those more than empty ones.
AdaptiveStatus worst_of(const std::vector<AdaptiveThreshold>& tracks) {
  for (const AdaptiveStatus status : {AdaptiveStatus::pinned_at_clamp, AdaptiveStatus::too_few_reversals})
    if (std::any_of(tracks.begin(), tracks.end(), [&](const auto& track) { return track.status == status; }))
      return status;
  return AdaptiveStatus::no_trials;
}

std::vector<AdaptiveThreshold> usable(const std::vector<AdaptiveThreshold>& tracks, UnfinishedTracks unfinished) {
  std::vector<AdaptiveThreshold> good;
  std::copy_if(tracks.begin(), tracks.end(), std::back_inserter(good), [&](const AdaptiveThreshold& track) {
    return track.status == AdaptiveStatus::ok ||
           (unfinished == UnfinishedTracks::use && track.n > 0 && track.status == AdaptiveStatus::too_few_reversals);
  });
  return good;
}

// Nothing averaged yet.
AdaptiveThreshold begun(const std::vector<AdaptiveThreshold>& tracks, const std::vector<AdaptiveThreshold>& good) {
  AdaptiveThreshold all = without_threshold(worst_of(tracks));
  all.tracks = {static_cast<int>(tracks.size()), static_cast<int>(good.size()),
                static_cast<int>(std::count_if(tracks.begin(), tracks.end(), [](const AdaptiveThreshold& track) {
                  return track.status == AdaptiveStatus::too_few_reversals;
                }))};
  if (good.empty()) return all;
  all.status = AdaptiveStatus::ok;
  all.threshold = all.sd = 0;
  return all;
}

constexpr auto kAdaptiveStatusWords = words<AdaptiveStatus>({{"ok", AdaptiveStatus::ok},
                                                             {"too_few_reversals", AdaptiveStatus::too_few_reversals},
                                                             {"no_trials", AdaptiveStatus::no_trials},
                                                             {"pinned_at_clamp", AdaptiveStatus::pinned_at_clamp},
                                                             {"too_few_answers", AdaptiveStatus::too_few_answers},
                                                             {"pinned_at_grid", AdaptiveStatus::pinned_at_grid}});

}  // namespace

ReversalMean mean_of_reversals(const std::vector<double>& reversals, int at_most) {
  const int n = std::min(static_cast<int>(reversals.size()), std::max(at_most, 0)) / 2 * 2;
  if (n < 2) return {0, kNaN, kNaN};
  double sum = 0, squares = 0;
  for (auto at = reversals.end() - n; at != reversals.end(); ++at) sum += *at;
  const double mean = sum / n;
  for (auto at = reversals.end() - n; at != reversals.end(); ++at) squares += (*at - mean) * (*at - mean);
  return {n, mean, std::sqrt(squares / (n - 1))};
}

AdaptiveThreshold staircase_threshold(const std::vector<double>& levels, const std::vector<double>& reversals,
                                      int averaged, const std::array<double, 2>& clamp) {
  if (levels.empty()) return without_threshold(AdaptiveStatus::no_trials);
  const ReversalMean mean = mean_of_reversals(reversals, averaged);
  const auto at_end = [&](double level) { return level <= clamp[0] || level >= clamp[1]; };
  const auto stuck = std::count_if(reversals.end() - mean.n, reversals.end(), at_end);
  const bool pinned = mean.n > 0 ? 2 * stuck > mean.n : at_end(levels.back());
  const AdaptiveStatus status = pinned                      ? AdaptiveStatus::pinned_at_clamp
                                : mean.n < averaged / 2 * 2 ? AdaptiveStatus::too_few_reversals
                                                            : AdaptiveStatus::ok;
  return {status, mean.mean, mean.sd, mean.n};
}

AdaptiveThreshold quest_threshold(double mean, double sd, int trials, const std::array<double, 2>& clamp) {
  if (trials == 0) return without_threshold(AdaptiveStatus::no_trials);
  const double threshold = std::pow(10, mean);
  const bool inside = threshold > clamp[0] && threshold < clamp[1];
  return {inside ? AdaptiveStatus::ok : AdaptiveStatus::pinned_at_clamp, threshold, sd, trials};
}

AdaptiveThreshold posterior_threshold(const LogPosterior& posterior) {
  if (posterior.trials == 0) return without_threshold(AdaptiveStatus::no_trials);
  AdaptiveThreshold threshold{AdaptiveStatus::ok, kNaN, posterior.sd, posterior.trials};
  threshold.prior_weight = posterior.sd * posterior.sd / (posterior.prior_sd * posterior.prior_sd);
  if (posterior.at_end)
    threshold.status = AdaptiveStatus::pinned_at_grid;
  else if (threshold.prior_weight > 0.5)
    threshold.status = AdaptiveStatus::too_few_answers;
  if (threshold.status != AdaptiveStatus::ok) return threshold;
  threshold.threshold = std::exp(posterior.mean);
  threshold.low = std::exp(posterior.low);
  threshold.high = std::exp(posterior.high);
  return threshold;
}

AdaptiveThreshold combined_staircases(const std::vector<AdaptiveThreshold>& tracks, UnfinishedTracks unfinished) {
  const std::vector<AdaptiveThreshold> good = usable(tracks, unfinished);
  AdaptiveThreshold all = begun(tracks, good);
  if (good.empty()) return all;
  double squares = 0;
  int freedom = 0;
  for (const AdaptiveThreshold& track : good) {
    all.threshold += track.threshold / static_cast<double>(good.size());
    all.n += track.n;
    squares += track.sd * track.sd * (track.n - 1);
    freedom += track.n - 1;
  }
  all.sd = std::sqrt(squares / freedom);
  return all;
}

AdaptiveThreshold combined_quests(const std::vector<AdaptiveThreshold>& tracks) {
  const std::vector<AdaptiveThreshold> good = usable(tracks, UnfinishedTracks::leave_out);
  AdaptiveThreshold all = begun(tracks, good);
  if (good.empty()) return all;
  const auto count = static_cast<double>(good.size());
  double logarithm = 0, variance = 0;
  for (const AdaptiveThreshold& track : good) {
    logarithm += std::log10(track.threshold) / count;
    variance += track.sd * track.sd / (count * count);
    all.prior_weight += track.prior_weight / count;
    all.n += track.n;
  }
  all.threshold = std::pow(10, logarithm);
  all.sd = std::sqrt(variance);
  return all;
}

std::string_view to_string(AdaptiveStatus status) noexcept {
  return word_of(kAdaptiveStatusWords, status);
}

}  // namespace jnd
