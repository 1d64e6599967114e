#include "data/export/device_places.h"

#include <set>

#include "data/log/event_body.h"
#include "data/study/study_impl.h"
#include "protocols/input/json_text.h"

namespace jnd {

std::vector<DevicePlace> device_places(const Study& study, const Protocol& protocol,
                                       const std::vector<SessionInfo>& sessions) {
  const Study::Impl& impl = study.impl();
  const std::scoped_lock lock(impl.mutex);
  const int fingers = static_cast<int>(protocol.rig.fingers.size());
  std::set<DevicePlace> places;
  with_storage_errors(impl.path, [&] {
    SQLite::Statement query(
        impl.database(),
        "SELECT body FROM event WHERE kind = 'trial.completed' AND session = ? ORDER BY trial LIMIT "
        "1");
    for (const SessionInfo& session : sessions) {
      query.bind(1, session.id);
      if (query.executeStep()) {
        const auto body = json_if_valid(query.getColumn(0).getString());
        for (const Presentation& presentation : trial_record_from(body).presentations)
          for (const FingerPresentation& finger : presentation.fingers)
            if (finger.finger >= 0 && finger.finger < fingers) places.insert({finger.finger, finger.channel});
      }
      query.reset();
    }
  });
  if (places.empty() && protocol.rig.built_in())
    for (int finger = 0; finger < fingers; ++finger) places.insert({finger, Channel::cutaneous});
  return {places.begin(), places.end()};
}

}  // namespace jnd
