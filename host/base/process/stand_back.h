// Work that is for nobody's waiting, beside work that is.
#pragma once

namespace impactdic {

// From now on this thread, and those that it begins, take a tenth of the processor time of another
// one where there are not enough cores for both, and all of a core that would be idle. It cannot be
// taken back; where the system refuses, nothing changes.
void stand_back();

}  // namespace impactdic
