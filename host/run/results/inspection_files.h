// What `info` says of a clip, as files that `report` makes a page of.
#pragma once

#include <impactdic/advice.h>

#include <string>

namespace impactdic::run {

// summary.json, job.toml and the first, the middle and the last picture (key_frames/) into
// `folder`, which must be empty unless `force`; of candidates a picture each, and one of all.
// Throws InvalidArgument, FileError, FormatError.
void write_inspection(const InspectRequest& request, const Inspection& found, double error_px,
                      const std::string& folder, bool force);

}  // namespace impactdic::run
