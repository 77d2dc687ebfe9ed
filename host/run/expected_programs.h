// What a track will need of its device, for those who open it.
#pragma once

#include <impactdic/track.h>

#include <future>

#include "host/run/session.h"

namespace impactdic::run {

// For Session::Impl: what `request` will need of the clip that somebody is about to tell. Empty
// where nothing is measured on a device.
Session::Impl::Expects expected_programs(const TrackRequest& request,
                                         std::shared_future<ClipInfo> clip);
// The same of a short clip of 8 bits, as most are.
Session::Impl::Expects expected_programs(const TrackRequest& request);

}  // namespace impactdic::run
