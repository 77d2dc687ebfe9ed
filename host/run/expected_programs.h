// What a track will need of its device, for those who open it.
#pragma once

#include <impactdic/track.h>

#include <future>

#include "host/run/session.h"

namespace impactdic::run {

// For Session::Impl: what `request` will need of pictures of the depth that somebody is about to
// tell. Empty where nothing is measured on a device.
Session::Impl::Expects expected_programs(const TrackRequest& request,
                                         std::shared_future<PixelType> depth);
// The same of pictures of 8 bits, which most clips hold.
Session::Impl::Expects expected_programs(const TrackRequest& request);

}  // namespace impactdic::run
