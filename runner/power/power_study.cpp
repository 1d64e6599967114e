#include "runner/power/power_study.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

#include "analysis/numerics/stop_request.h"

namespace jnd {

namespace {

// Designs that differ in their participants alone: the larger ones hold the people of the smaller.
struct SharedPeople {
  Protocol protocol;
  std::unique_ptr<PeopleSource> source;
  std::unique_ptr<StudyAnalyst> analyst;
  std::vector<std::pair<int, std::size_t>> designs;  // participants; place among the question's designs
  int most = 0;                                      // participants
};

std::vector<std::unique_ptr<SharedPeople>> shared_people(const Protocol& protocol, const PowerQuestion& question) {
  std::vector<std::unique_ptr<SharedPeople>> all;
  const std::vector<PowerDesign> designs = question.designs();
  std::vector<std::pair<int, double>> keys;
  for (std::size_t i = 0; i < designs.size(); ++i) {
    const std::pair<int, double> key{designs[i].trials, designs[i].effect};
    auto found = std::find(keys.begin(), keys.end(), key);
    if (found == keys.end()) {
      keys.push_back(key);
      found = std::prev(keys.end());
      auto one = std::make_unique<SharedPeople>();
      one->protocol = protocol;
      if (designs[i].trials > 0) one->protocol.design.trials_per_cell = designs[i].trials;
      one->source = people_source(one->protocol, question, designs[i].effect);
      one->analyst = std::make_unique<StudyAnalyst>(one->protocol, question, designs[i].effect);
      all.push_back(std::move(one));
    }
    SharedPeople& one = *all[static_cast<std::size_t>(found - keys.begin())];
    one.designs.emplace_back(designs[i].participants, i);
    one.most = std::max(one.most, designs[i].participants);
  }
  return all;
}

}  // namespace

PowerTally power_study(const Protocol& protocol, const PowerQuestion& question, StudyRange range, int threads,
                       const std::function<void(std::int64_t)>& progress) {
  const std::vector<std::unique_ptr<SharedPeople>> shared = shared_people(protocol, question);
  const double alpha = protocol.analysis.tests.alpha;
  PowerTally tally = PowerTally::of(question);
  std::atomic<std::int64_t> next{range.first};
  std::int64_t done = 0;
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    PowerTally own = PowerTally::of(question);
    try {
      for (std::int64_t study = next++; study < range.last; study = next++) {
        for (const std::unique_ptr<SharedPeople>& one : shared) {
          stop_if_requested();
          const std::vector<DrawnPerson> people = one->source->people(static_cast<std::uint64_t>(study), one->most);
          for (const auto& [participants, design] : one->designs)
            for (std::size_t a = 0; a < question.analyses.size(); ++a)
              own.by_design[design][a].add(
                  one->analyst->analyse(question.analyses[a],
                                        std::span(people).first(static_cast<std::size_t>(participants))),
                  question.analyses[a], *one->analyst, alpha);
        }
        ++own.studies;
        const std::lock_guard lock(mutex);
        ++done;
        if (progress) progress(done);
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
      next = range.last;
    }
    const std::lock_guard lock(mutex);
    tally += own;
  };
  {
    std::vector<std::jthread> workers;
    const std::int64_t most = std::max<std::int64_t>(1, range.last - range.first);
    for (std::int64_t i = 0; i < std::clamp<std::int64_t>(threads, 1, most); ++i) workers.emplace_back(work);
  }
  if (failure) std::rethrow_exception(failure);
  return tally;
}

}  // namespace jnd
