#include "data/raw_trials/answer_raster.h"

namespace jnd {

std::vector<AnswersOf> answer_raster(const Protocol& protocol, const std::vector<SessionInfo>& sessions,
                                     const std::vector<CountedTrial>& trials) {
  // Sessions that ran side by side are interleaved in the file.
  std::vector<std::vector<RasterAnswer>> by_session(sessions.size());
  for (const CountedTrial& trial : trials)
    by_session[static_cast<std::size_t>(trial.session)].push_back(
        {trial.condition, trial.said, trial.target, !exclusion_reason(protocol.analysis.exclude, trial).empty()});
  std::vector<AnswersOf> raster;
  for (std::size_t session = 0; session < sessions.size(); ++session) {
    if (raster.empty() || raster.back().participant != sessions[session].participant)
      raster.push_back({sessions[session].participant, {}, {}, 0});
    AnswersOf& one = raster.back();
    one.answers.insert(one.answers.end(), by_session[session].begin(), by_session[session].end());
    one.sessions_end.push_back(one.answers.size());
    one.voided += sessions[session].trials_voided;
  }
  return raster;
}

}  // namespace jnd
