#include "host/cluster/watch.h"

#include <utility>

namespace impactdic::cluster {

Watch::Watch(double lost_after_s, Clock clock, std::function<bool(const std::string&)> gone)
    : lost_after_s_(lost_after_s), clock_(std::move(clock)), gone_(std::move(gone)) {}

bool Watch::is_lost(const std::string& member, const std::optional<std::string>& beat) {
  if (beat && gone_ && gone_(*beat)) return true;
  const double now_s = clock_();
  const auto [found, first] = seen_.try_emplace(member, Seen{beat, now_s});
  if (!first && found->second.beat != beat) found->second = {beat, now_s};
  return now_s - found->second.since_s >= lost_after_s_;
}

}  // namespace impactdic::cluster
